//! Catmull-Clark subdivision with creases and its limits against OpenSubdiv.
//!
//! What differs, and how far, is measured here too:
//!
//! - OpenSubdiv holds sharpness, and what it blends masks by, in single precision. Where tags make it
//!   divide by three, refined points agree to that precision; elsewhere in double precision.
//! - Under Chaikin's rule a sharpness above one may become zero in one step, if the other edges are
//!   much less sharp. The point of the edge is then the midpoint here; OpenSubdiv extrapolates beyond
//!   it, although its comments say that the weight is clamped to one.
//! - At darts OpenSubdiv has the limit mask of smooth vertices, which is not the limit.
//! - In creased sectors of more than two faces, OpenSubdiv's tangents belong to rules of
//!   refinement that it does not have.

use std::collections::BTreeMap;

use msplines_common::mesh::polygon::{
    BoundaryCorners, CreaseRule, PolygonMesh, PolygonTopology, Refined, Rules, Sharpness,
    catmull_clark, limit_stencils, limit_tangent_stencils,
};
use msplines_reference::polygon::{Limits, opensubdiv};
use msplines_reference::record::Comparison;
use msplines_reference::{Library, meshes};
use nalgebra::{Point3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Sums of products in another order, over three refinements and a limit.
const ROUNDING: f64 = 1e-12;
/// Single precision of the weights that masks are blended by.
const SINGLE: f64 = 1e-6;
/// Refinements that are compared.
const LEVELS: u32 = 3;

/// Which edges and vertices are tagged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Tags {
    /// None.
    None,
    /// Edges of which no vertex has more than two, and vertices that have none: OpenSubdiv's means of
    /// two eighths are exact.
    Chains,
    /// Any.
    Free,
}

fn all_rules() -> Vec<Rules> {
    let mut all = Vec::new();
    for creases in [CreaseRule::Uniform, CreaseRule::Chaikin] {
        for corners in [BoundaryCorners::Sharp, BoundaryCorners::Smooth] {
            all.push(Rules { creases, corners });
        }
    }
    all
}

/// Returns a sharpness of some eighths up to 3.5, or infinity for a share of all.
fn draw(random: &mut Pcg64Mcg, infinite: f64) -> f64 {
    if random.random_range(0.0..1.0) < infinite {
        f64::INFINITY
    } else {
        f64::from(random.random_range(1..29)) / 8.0
    }
}

fn tagged(
    topology: &PolygonTopology,
    rules: Rules,
    tags: Tags,
    infinite: f64,
    seed: u64,
) -> Sharpness {
    let mut sharpness = Sharpness::smooth(topology, rules);
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let boundary = |v: u32| u32::from(topology.is_boundary_vertex(v));
    let vertices = 0..topology.vertex_count() as u32;
    let mut tagged: Vec<u32> = vertices.clone().map(boundary).collect();
    if tags == Tags::None {
        return sharpness;
    }
    for edge in 0..topology.edge_count() as u32 {
        let ends = topology.edge_vertices(edge).map(|v| v as usize);
        let fits = tags == Tags::Free || ends.iter().all(|&v| tagged[v] < 2);
        if fits && !topology.is_boundary_edge(edge) && random.random_range(0.0..1.0) < 0.35 {
            ends.iter().for_each(|&v| tagged[v] += 1);
            sharpness.set_edge(edge, draw(&mut random, infinite));
        }
    }
    for vertex in vertices {
        let corner = sharpness.vertex(vertex).is_infinite();
        let fits = !corner && (tags == Tags::Free || tagged[vertex as usize] <= boundary(vertex));
        if fits && random.random_range(0.0..1.0) < 0.12 {
            sharpness.set_vertex(vertex, draw(&mut random, infinite));
        }
    }
    sharpness
}

/// Returns the edges above a sharpness of one of which a piece is smooth after the next step.
fn extrapolated(before: &Refined, after: &Refined) -> Vec<u32> {
    let topology = &before.topology;
    let piece = |edge: u32, end: u32| {
        let middle = topology.vertex_count() as u32 + edge;
        let piece = after.topology.edge_between(end, middle).expect("a piece");
        after.sharpness.edge(piece)
    };
    (0..topology.edge_count() as u32)
        .filter(|&edge| {
            let ends = topology.edge_vertices(edge);
            before.sharpness.edge(edge) > 1.0 && ends.iter().any(|&v| piece(edge, v) == 0.0)
        })
        .collect()
}

/// One mesh, refined here and by OpenSubdiv.
struct Case {
    name: String,
    mesh: PolygonMesh,
    sharpness: Sharpness,
    rules: Rules,
    /// Our levels from the first one on, as they follow from the one before.
    levels: Vec<Refined>,
    /// Our points.
    ours: Vec<Vec<Point3<f64>>>,
    /// Points of OpenSubdiv.
    theirs: Vec<Vec<Point3<f64>>>,
    limits: Limits,
    /// Whether a point hangs on an edge point that OpenSubdiv extrapolates.
    apart: Vec<Vec<bool>>,
}

impl Case {
    fn build(name: &str, mesh: &PolygonMesh, sharpness: Sharpness, rules: Rules) -> Self {
        let (theirs, limits) = opensubdiv(mesh, &sharpness, rules, LEVELS);
        let mut before = Refined::none(mesh.topology(), &sharpness);
        let mut case = Self {
            name: name.to_owned(),
            mesh: mesh.clone(),
            sharpness,
            rules,
            levels: Vec::new(),
            ours: vec![mesh.positions().to_vec()],
            theirs,
            limits,
            apart: vec![vec![false; mesh.vertex_count()]],
        };
        for _ in 0..LEVELS {
            let after = catmull_clark(&before.topology, &before.sharpness, rules);
            let positions = after.stencils.apply(case.ours.last().expect("a level"));
            let behind = case.apart.last().expect("a level");
            let mut apart = apart(&after, behind);
            for edge in extrapolated(&before, &after) {
                apart[before.topology.vertex_count() + edge as usize] = true;
            }
            case.ours.push(positions);
            case.apart.push(apart);
            case.levels.push(after.clone());
            before = after;
        }
        case.ours.remove(0);
        case.apart.remove(0);
        case
    }

    fn last(&self) -> Refined {
        let last = self.levels.last().expect("a level");
        Refined::none(&last.topology, &last.sharpness)
    }

    /// Returns the deviations of all points of all levels, in diagonals.
    fn deviations(&self) -> Vec<f64> {
        let diagonal = self.mesh.diagonal();
        let mut all = Vec::new();
        for ((ours, theirs), apart) in self.ours.iter().zip(&self.theirs).zip(&self.apart) {
            assert_eq!(ours.len(), theirs.len());
            let pairs = ours.iter().zip(theirs).zip(apart);
            let kept = pairs.filter(|(_, apart)| !**apart);
            all.extend(kept.map(|((a, b), _)| (a - b).norm() / diagonal));
        }
        all
    }
}

/// Returns which rows of stencils hang on a column that does.
fn apart(refined: &Refined, behind: &[bool]) -> Vec<bool> {
    let rows = 0..refined.stencils.len();
    rows.map(|row| {
        refined
            .stencils
            .row(row)
            .0
            .iter()
            .any(|&c| behind[c as usize])
    })
    .collect()
}

fn cases(tags: Tags) -> Vec<Case> {
    let mut all = Vec::new();
    for (seed, (name, mesh)) in meshes::control().iter().enumerate() {
        for rules in all_rules() {
            for (round, infinite) in [0.0, 0.4, 1.0].into_iter().enumerate() {
                let seed = (10 * seed + round) as u64;
                let sharpness = tagged(mesh.topology(), rules, tags, infinite, seed);
                let name = format!("{name}, {rules:?}, {tags:?}, {infinite} infinite");
                all.push(Case::build(&name, mesh, sharpness, rules));
                if tags == Tags::None {
                    break;
                }
            }
        }
    }
    all
}

#[test]
fn refined_points_agree() {
    for (tags, quantity, bound, why) in [
        (Tags::None, "smooth", ROUNDING, "another order of sums"),
        (Tags::Chains, "creased", ROUNDING, "another order of sums"),
        (Tags::Free, "freely tagged", SINGLE, "its blends are floats"),
    ] {
        let quantity = format!("refined points of {quantity} meshes");
        let why = format!("in diagonals: {why}");
        let mut comparison = Comparison::new(&quantity, Library::OpenSubdiv, bound, &why);
        let (mut points, mut apart) = (0, 0);
        for case in cases(tags) {
            comparison.add(&case.name, case.deviations());
            points += case.apart.iter().flatten().count();
            apart += case.apart.iter().flatten().filter(|&&apart| apart).count();
        }
        println!("{quantity}: {points} points, {apart} of which OpenSubdiv extrapolates");
        assert!(10 * apart < points, "most points are compared");
        comparison.finish();
    }
}

#[test]
fn opensubdiv_extrapolates_where_a_sharpness_above_one_ends() {
    let mut comparison = Comparison::new(
        "edge points beyond their middle",
        Library::OpenSubdiv,
        ROUNDING,
        "in diagonals: its points are the middle, times a weight above one",
    );
    let (mut count, mut farthest) = (0, 0.0_f64);
    for case in cases(Tags::Chains) {
        let topology = case.mesh.topology();
        let before = Refined::none(topology, &case.sharpness);
        let points = case.mesh.positions();
        let smooth = Sharpness::smooth(topology, case.rules);
        let smooth = catmull_clark(topology, &smooth, case.rules);
        for edge in extrapolated(&before, &case.levels[0]) {
            let row = topology.vertex_count() + edge as usize;
            let [a, b] = topology
                .edge_vertices(edge)
                .map(|v| points[v as usize].coords);
            let middle = 0.5 * (a + b);
            let s = case.sharpness.edge(edge);
            let beyond = s * middle + (1.0 - s) * smooth.stencils.point(row, points).coords;
            let theirs = case.theirs[0][row].coords;
            let diagonal = case.mesh.diagonal();
            comparison.add(&case.name, [(theirs - beyond).norm() / diagonal]);
            assert!((case.ours[0][row].coords - middle).norm() < ROUNDING * diagonal);
            count += 1;
            farthest = farthest.max((theirs - middle).norm() / diagonal);
        }
    }
    println!("{count} edge points up to {farthest:.1e} diagonals beyond their middle");
    comparison.finish();
}

/// What a vertex is in the limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Smooth,
    Dart,
    Crease,
    Corner,
    /// Sharpness is still falling.
    Unsettled,
}

fn kind(mesh: &Refined, vertex: u32) -> Kind {
    let topology = &mesh.topology;
    let edges = topology.spokes(vertex).map(|h| topology.edge(h));
    let edges: Vec<f64> = edges.map(|e| mesh.sharpness.edge(e)).collect();
    let own = mesh.sharpness.vertex(vertex);
    let falls = |s: f64| s > 0.0 && s.is_finite();
    let sharp = edges.iter().filter(|&&s| s > 0.0).count();
    match sharp {
        _ if falls(own) || edges.iter().any(|&s| falls(s)) => Kind::Unsettled,
        _ if own > 0.0 => Kind::Corner,
        0 => Kind::Smooth,
        1 => Kind::Dart,
        2 => Kind::Crease,
        _ => Kind::Corner,
    }
}

#[test]
fn limit_positions_agree() {
    let mut comparison = Comparison::new(
        "limits of smooth vertices creases and corners",
        Library::OpenSubdiv,
        ROUNDING,
        "in diagonals: another order of sums",
    );
    let mut counts: BTreeMap<Kind, usize> = BTreeMap::new();
    for case in [Tags::None, Tags::Chains].into_iter().flat_map(cases) {
        let last = case.last();
        let limits = limit_stencils(&last, case.rules);
        let points = case.ours.last().expect("a level");
        let behind = case.apart.last().expect("a level");
        for vertex in 0..last.topology.vertex_count() as u32 {
            let row = vertex as usize;
            let kind = kind(&last, vertex);
            let apart = limits.row(row).0.iter().any(|&c| behind[c as usize]);
            if apart || matches!(kind, Kind::Dart | Kind::Unsettled) {
                continue;
            }
            let gap = limits.point(row, points) - case.limits.positions[row];
            comparison.add(&case.name, [gap.norm() / case.mesh.diagonal()]);
            *counts.entry(kind).or_default() += 1;
        }
    }
    println!("{counts:?}");
    assert_eq!(counts.len(), 3, "all kinds are compared");
    comparison.finish();
}

/// Returns the number of faces from the edge of an outgoing half-edge to the next sharp one.
fn sector(mesh: &Refined, half_edge: u32) -> usize {
    let topology = &mesh.topology;
    let vertex = topology.origin(half_edge);
    let spokes: Vec<u32> = topology.spokes(vertex).collect();
    let first = spokes.iter().position(|&h| h == half_edge);
    let first = first.expect("it leaves");
    let sharp = |i: usize| {
        mesh.sharpness
            .edge(topology.edge(spokes[(first + i) % spokes.len()]))
    };
    let next = (1..=spokes.len()).find(|&i| sharp(i) > 0.0);
    next.unwrap_or(1)
}

/// Returns OpenSubdiv's normal at a vertex, and the half-edge from which on its faces have it.
fn their_normal(mesh: &Refined, limits: &Limits, vertex: u32) -> (u32, Vector3<f64>) {
    let [first, second] = limits.tangents[vertex as usize];
    let lead = match kind(mesh, vertex) {
        Kind::Crease => limits.sharp_neighbours[vertex as usize],
        _ => limits.first_neighbours[vertex as usize],
    };
    let mut outgoing = mesh.topology.outgoing(vertex);
    let half_edge = outgoing.find(|&h| mesh.topology.target(h) == lead);
    let half_edge = half_edge.expect("its first edge has a face on its left");
    (half_edge, first.cross(&second).normalize())
}

fn our_normals(
    mesh: &Refined,
    half_edges: &[u32],
    rules: Rules,
    points: &[Point3<f64>],
) -> Vec<Vector3<f64>> {
    let tangents = limit_tangent_stencils(mesh, half_edges, rules).apply(points);
    let (pairs, _) = tangents.as_chunks::<2>();
    let normal = |[a, b]: &[Point3<f64>; 2]| a.coords.cross(&b.coords).normalize();
    pairs.iter().map(normal).collect()
}

#[test]
fn normals_agree_where_both_masks_are_exact() {
    let mut comparison = Comparison::new(
        "normals of smooth vertices regular creases and corners",
        Library::OpenSubdiv,
        1e-11,
        "of unit vectors: differences of points close to each other",
    );
    let mut counts: BTreeMap<Kind, usize> = BTreeMap::new();
    for case in [Tags::None, Tags::Chains].into_iter().flat_map(cases) {
        let last = case.last();
        let points = case.ours.last().expect("a level");
        let behind = case.apart.last().expect("a level");
        let mut theirs = Vec::new();
        for vertex in 0..last.topology.vertex_count() as u32 {
            let kind = kind(&last, vertex);
            let apart = last.topology.outgoing(vertex).any(|h| {
                let face = last.topology.face_vertices(last.topology.face(h));
                face.iter().any(|&v| behind[v as usize])
            });
            if apart || matches!(kind, Kind::Dart | Kind::Unsettled) {
                continue;
            }
            let (half_edge, normal) = their_normal(&last, &case.limits, vertex);
            let edge = last.topology.edge(half_edge);
            let faces = sector(&last, half_edge);
            let smooth = kind == Kind::Smooth;
            // A corner without sharp edges has a normal in each of its faces.
            let lone = kind == Kind::Corner
                && last
                    .topology
                    .spokes(vertex)
                    .all(|h| last.sharpness.edge(last.topology.edge(h)) == 0.0);
            let regular = faces == 1 || (faces == 2 && kind == Kind::Crease);
            let fits = regular && last.sharpness.edge(edge) > 0.0;
            if smooth || lone || fits {
                theirs.push((half_edge, normal));
                *counts.entry(kind).or_default() += 1;
            }
        }
        let half_edges: Vec<u32> = theirs.iter().map(|n| n.0).collect();
        let ours = our_normals(&last, &half_edges, case.rules, points);
        let pairs = ours.iter().zip(&theirs);
        comparison.add(&case.name, pairs.map(|(a, (_, b))| (a - b).norm()));
    }
    println!("{counts:?}");
    assert_eq!(counts.len(), 3, "all kinds are compared");
    comparison.finish();
}

/// A vertex and its faces, which OpenSubdiv refines again and again: only the ring stays.
struct Ring {
    mesh: PolygonMesh,
    sharpness: Sharpness,
}

impl Ring {
    /// Returns the closed ring of quads of random points, with some spokes sharp for ever.
    fn random(valence: u32, sharp: &[u32], seed: u64) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut jitter = || random.random_range(-0.2..0.2);
        let turn = std::f64::consts::TAU / f64::from(valence);
        let mut place = |radius: f64, angle: f64| {
            let (x, y) = (radius * angle.cos(), radius * angle.sin());
            Point3::new(x + jitter(), y + jitter(), jitter())
        };
        let mut points = vec![place(0.0, 0.0)];
        for (radius, shift) in [(1.0, 0.0), (1.4, 0.5)] {
            points.extend((0..valence).map(|j| place(radius, turn * (f64::from(j) + shift))));
        }
        let faces: Vec<[u32; 4]> = (0..valence)
            .map(|j| [0, 1 + j, 1 + valence + j, 1 + (j + 1) % valence])
            .collect();
        let mesh = PolygonMesh::from_quads(points, &faces).expect("a disk");
        let mut sharpness = Sharpness::smooth(mesh.topology(), Rules::default());
        for &j in sharp {
            let edge = mesh.topology().edge_between(0, 1 + j).expect("a spoke");
            sharpness.set_edge(edge, f64::INFINITY);
        }
        Self { mesh, sharpness }
    }

    fn valence(&self) -> u32 {
        self.mesh.face_count() as u32
    }

    /// Returns the ring after one refinement by OpenSubdiv.
    fn refined(&self) -> Self {
        let topology = self.mesh.topology();
        let (levels, _) = opensubdiv(&self.mesh, &self.sharpness, Rules::default(), 1);
        let (vertices, edges) = (topology.vertex_count(), topology.edge_count());
        let spoke = |j: u32| topology.edge_between(0, 1 + j).expect("a spoke") as usize;
        let mut points = vec![levels[0][0]];
        points.extend((0..self.valence()).map(|j| levels[0][vertices + spoke(j)]));
        points.extend((0..self.valence() as usize).map(|j| levels[0][vertices + edges + j]));
        Self {
            mesh: self.mesh.with_positions(points),
            sharpness: self.sharpness.clone(),
        }
    }

    /// Returns the ring with its vertex at the origin and the farthest neighbour at distance one.
    fn scaled(&self) -> Self {
        let points = self.mesh.positions();
        let here = points[0].coords;
        let size = points.iter().map(|p| (p.coords - here).norm());
        let size = size.fold(0.0, f64::max);
        let scaled = points
            .iter()
            .map(|p| Point3::from((p.coords - here) / size));
        Self {
            mesh: self.mesh.with_positions(scaled.collect()),
            sharpness: self.sharpness.clone(),
        }
    }

    fn as_refined(&self) -> Refined {
        Refined::none(self.mesh.topology(), &self.sharpness)
    }

    /// Returns the limit and the normal that OpenSubdiv's masks give after one refinement.
    fn their_limit(&self) -> (Point3<f64>, Vector3<f64>) {
        let (_, limits) = opensubdiv(&self.mesh, &self.sharpness, Rules::default(), 1);
        let [a, b] = limits.tangents[0];
        (limits.positions[0], a.cross(&b).normalize())
    }
}

/// Valences of darts that are looked at.
const DARTS: [u32; 6] = [3, 4, 5, 6, 8, 12];
/// Refinements after which a dart is where it goes: the slowest eigenvalue is below 0.8.
const MANY: usize = 200;

#[test]
fn darts_tend_to_our_limit_and_not_to_opensubdivs() {
    let mut comparison = Comparison::new(
        "limits of darts refined many times",
        Library::OpenSubdiv,
        ROUNDING,
        "in lengths of an edge: refined until nothing moves any more",
    );
    for valence in DARTS {
        let (mut mask, mut few) = (0.0_f64, 0.0_f64);
        for seed in 0..5 {
            let start = Ring::random(valence, &[1], seed);
            let ours = limit_stencils(&start.as_refined(), Rules::default());
            let ours = ours.point(0, start.mesh.positions());
            let mut ring = start.refined();
            (1..8).for_each(|_| ring = ring.refined());
            few = few.max((ours - ring.mesh.positions()[0]).norm());
            (8..MANY).for_each(|_| ring = ring.refined());
            let limit = ring.mesh.positions()[0];
            comparison.add(&format!("valence {valence}"), [(ours - limit).norm()]);
            mask = mask.max((start.their_limit().0 - limit).norm());
        }
        println!("dart of valence {valence}: 8 levels {few:.1e}, OpenSubdiv's mask {mask:.1e} off");
        assert!(mask > 1e-4, "its mask at darts has become the limit");
    }
    comparison.finish();
}

/// Returns the largest sine between a plane and the directions of a sector's first edges.
fn sine(normal: &Vector3<f64>, ring: &Ring, edges: std::ops::RangeInclusive<u32>) -> f64 {
    let points = ring.mesh.positions();
    let direction = |j: u32| {
        let place = 1 + j % ring.valence();
        (points[place as usize] - points[0]).normalize()
    };
    edges
        .map(|j| direction(j).dot(normal).abs())
        .fold(0.0, f64::max)
}

#[test]
fn tangent_planes_of_darts_and_irregular_sectors_are_ours_and_not_opensubdivs() {
    /// Where the next eigenvalue comes near, the steps leave this much of its vector.
    const REST: f64 = 1e-5;
    let mut comparison = Comparison::new(
        "tangent planes of darts and creased sectors",
        Library::OpenSubdiv,
        REST,
        "sine of the angle to the edges of a ring after 60 refinements",
    );
    // Sharp spokes, and the first and last edge of the sector that is looked at: a crease has a
    // tangent plane up to three faces.
    let cases: [(&str, u32, &[u32], u32); 7] = [
        ("dart", 3, &[0], 3),
        ("dart", 4, &[0], 4),
        ("dart", 5, &[0], 5),
        ("dart", 7, &[0], 7),
        ("crease, 2 faces", 4, &[0, 2], 2),
        ("crease, 2 faces", 5, &[0, 2], 2),
        ("crease, 3 faces", 5, &[0, 3], 3),
    ];
    for (name, valence, sharp, last) in cases {
        let name = format!("{name}, valence {valence}");
        let (mut ours_off, mut theirs_off) = (0.0_f64, 0.0_f64);
        for seed in 0..5 {
            let start = Ring::random(valence, sharp, seed);
            let mesh = start.as_refined();
            let mut outgoing = mesh.topology.outgoing(0);
            let half_edge = outgoing.find(|&h| mesh.topology.target(h) == 1);
            let half_edge = half_edge.expect("the first spoke");
            let points = start.mesh.positions();
            let ours = our_normals(&mesh, &[half_edge], Rules::default(), points)[0];
            let mut ring = start.refined();
            (1..60).for_each(|_| ring = ring.scaled().refined());
            let (_, theirs) = start.their_limit();
            let off = sine(&ours, &ring, 0..=last);
            comparison.add(&name, [off]);
            ours_off = ours_off.max(off);
            theirs_off = theirs_off.max(sine(&theirs, &ring, 0..=last));
        }
        println!("{name}: ours {ours_off:.1e}, OpenSubdiv's {theirs_off:.1e} off");
    }
    comparison.finish();
}
