//! Delaunay triangulations by flips of edges against CGAL's: in the plane, and of surfaces.

use std::collections::BTreeSet;

use msplines_common::mesh::{FlipComplex, NONE, Topology, TriangleMesh};
use msplines_common::operators::intrinsic::{IntrinsicTriangulation, intrinsic_delaunay};
use msplines_reference::record::Comparison;
use msplines_reference::{Library, cgal_intrinsic, cgal_plane_delaunay, meshes};
use nalgebra::{Point3, Vector2};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

type Failure = Box<dyn std::error::Error>;
/// Moves points of the plane.
type Map = fn([f64; 2]) -> [f64; 2];

/// Each flip finds a length from five others; those of slivers lose digits.
const FLIPS: f64 = 1e-12;
/// CGAL finds lengths by half angles, and gives them through an arc cosine.
const HALF_ANGLES: f64 = 1e-12;

/// Returns the ends, the smaller first, and the length of each edge.
fn edges(found: &IntrinsicTriangulation) -> Vec<([u32; 2], f64)> {
    let mut edges = Vec::new();
    for (half_edge, &twin) in found.twins.iter().enumerate() {
        let (face, side) = (half_edge / 3, half_edge % 3);
        // An edge is seen from one of its sides.
        if twin == NONE || half_edge < twin as usize {
            let [a, b] = [side, (side + 1) % 3].map(|corner| found.faces[face][corner]);
            edges.push(([a.min(b), a.max(b)], found.lengths[face][side]));
        }
    }
    edges
}

/// Random points with their names: a circle around others, so that no triangle at the hull is flat.
fn point_sets() -> Vec<(String, Vec<[f64; 2]>)> {
    /// Points on the circle.
    const AROUND: usize = 60;
    let mut sets = Vec::new();
    let bend = |[x, y]: [f64; 2]| [x + 0.3 * y * y, y];
    let shapes: [(&str, Map); 6] = [
        ("even points", |p| p),
        ("dense middle", |[x, y]| [x, y].map(|c| c * (x * x + y * y))),
        ("ellipse", |[x, y]| [x, 0.2 * y]),
        ("two clusters", |[x, y]| {
            [0.4 * x + 0.5 * x.signum(), 0.5 * y]
        }),
        ("sparse half", |[x, y]| [if x > 0.0 { x * x } else { x }, y]),
        ("even points, another seed", |p| p),
    ];
    for (seed, (name, shape)) in shapes.into_iter().enumerate() {
        let mut random = Pcg64Mcg::seed_from_u64(seed as u64);
        let mut points: Vec<[f64; 2]> = (0..AROUND)
            .map(|i| {
                let turn = i as f64 + random.random_range(-0.3..0.3);
                let angle = std::f64::consts::TAU * turn / AROUND as f64;
                bend([
                    angle.cos(),
                    if name == "ellipse" { 0.3 } else { 1.0 } * angle.sin(),
                ])
            })
            .collect();
        while points.len() < 1_500 {
            let p = [0; 2].map(|_| random.random_range(-0.9..0.9));
            if p[0] * p[0] + p[1] * p[1] < 0.8 {
                points.push(bend(shape(p)));
            }
        }
        sets.push((name.to_owned(), points));
    }
    sets
}

/// Returns the faces after random flips of edges of convex quadrilaterals.
fn shuffled(points: &[[f64; 2]], faces: Vec<[u32; 3]>, seed: u64) -> Result<TriangleMesh, Failure> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let topology = Topology::build(points.len(), faces)?;
    let mut complex = FlipComplex::of(&topology);
    let count = complex.twins().len() as u32;
    for _ in 0..2 * count {
        let half_edge = random.random_range(0..count);
        let twin = complex.twin(half_edge);
        if twin == NONE {
            continue;
        }
        let place = |h: u32| Vector2::from(points[complex.origin(h) as usize]);
        let [a, b] = [place(half_edge), place(twin)];
        let [left, right] = [half_edge, twin].map(|h| place(Topology::previous(h)));
        // Far from flat: of lengths alone a needle has no area.
        let turns = |end: Vector2<f64>, from: Vector2<f64>, to: Vector2<f64>| {
            let (u, v) = (end - from, to - end);
            u.perp(&v) > 0.05 * u.norm() * v.norm()
        };
        let is_fat = |end: Vector2<f64>| {
            let sides = [right - left, end - left, end - right].map(|e| e.norm_squared());
            let longest = sides.into_iter().fold(0.0, f64::max);
            (right - left).perp(&(end - left)).abs() > 0.02 * longest
        };
        let is_convex = turns(b, right, left) && turns(a, left, right);
        if is_convex && is_fat(a) && is_fat(b) {
            complex.flip(half_edge);
        }
    }
    let places = points.iter().map(|&[x, y]| Point3::new(x, y, 0.0));
    Ok(TriangleMesh::build(
        places.collect(),
        complex.faces().to_vec(),
    )?)
}

#[test]
fn flips_in_the_plane_end_in_the_delaunay_triangulation() -> Result<(), Failure> {
    let why = "edges of one alone: both decide by the circle of three points";
    let mut apart = Comparison::new("Delaunay edges in the plane", Library::Cgal, 0.0, why);
    let why = "relative to the distance of the ends: lengths follow from lengths, flip after flip";
    let mut lengths = Comparison::new("length of flipped edges", Library::Cgal, FLIPS, why);
    for (seed, (name, points)) in point_sets().into_iter().enumerate() {
        let theirs = cgal_plane_delaunay(&points);
        let mesh = shuffled(&points, theirs.clone(), seed as u64)?;
        let found = intrinsic_delaunay(&mesh)?;
        println!("{name}: {} flips", found.flips.len());
        assert!(found.flips.len() > 500, "{name}: {}", found.flips.len());
        let ours = edges(&found);
        let sides = theirs
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let theirs: BTreeSet<[u32; 2]> = sides.map(|[a, b]| [a.min(b), a.max(b)]).collect();
        let own: BTreeSet<[u32; 2]> = ours.iter().map(|edge| edge.0).collect();
        apart.add(&name, [own.symmetric_difference(&theirs).count() as f64]);
        let relative = ours.iter().map(|&([a, b], length)| {
            let [a, b] = [a, b].map(|v| mesh.positions()[v as usize]);
            (length / (b - a).norm() - 1.0).abs()
        });
        lengths.add(&name, relative);
    }
    apart.finish();
    lengths.finish();
    Ok(())
}

/// Surfaces with many edges that are not Delaunay, with their names.
fn stretched() -> Vec<(String, TriangleMesh)> {
    let jitter = |(seed, (name, mesh)): (usize, (String, TriangleMesh))| {
        let mesh = meshes::jittered(&mesh, 0.3, seed as u64);
        let stretch = |p: &Point3<f64>| Point3::new(p.x, 0.7 * p.y + 0.5 * p.x, 2.0 * p.z);
        let places = mesh.positions().iter().map(stretch).collect();
        (format!("{name}, sheared"), mesh.with_positions(places))
    };
    let generated = meshes::generated().into_iter().enumerate().map(jitter);
    generated.chain(meshes::models()).collect()
}

/// Returns the number of edges at each vertex and all lengths, both ascending: CGAL numbers vertices in a
/// way of its own.
fn ascending(edges: &[([u32; 2], f64)], vertices: usize) -> (Vec<u32>, Vec<f64>) {
    let mut valences = vec![0; vertices];
    for &end in edges.iter().flat_map(|(ends, _)| ends) {
        valences[end as usize] += 1;
    }
    let mut lengths: Vec<f64> = edges.iter().map(|edge| edge.1).collect();
    valences.sort_unstable();
    lengths.sort_by(f64::total_cmp);
    (valences, lengths)
}

#[test]
fn flips_on_surfaces_end_in_the_intrinsic_delaunay_triangulation() -> Result<(), Failure> {
    let library = Library::Cgal;
    let why = "differing ones, ascending";
    let quantity = "valences of intrinsic Delaunay triangulations";
    let mut valences = Comparison::new(quantity, library, 0.0, why);
    let why =
        "ascending, relative to the mean: unfolded here, by half angles and an arc cosine there";
    let quantity = "length of intrinsic Delaunay edges";
    let mut lengths = Comparison::new(quantity, library, HALF_ANGLES, why);
    for (name, mesh) in stretched() {
        let found = intrinsic_delaunay(&mesh)?;
        assert!(found.flips.len() > 100, "{name}: {}", found.flips.len());
        let ours = ascending(&edges(&found), mesh.vertex_count());
        let theirs = ascending(&cgal_intrinsic(&mesh), mesh.vertex_count());
        assert_eq!(ours.1.len(), theirs.1.len(), "{name}");
        let pairs = ours.0.iter().zip(&theirs.0);
        valences.add(&name, [pairs.filter(|(a, b)| a != b).count() as f64]);
        let mean = ours.1.iter().sum::<f64>() / ours.1.len() as f64;
        let pairs = ours.1.iter().zip(&theirs.1);
        lengths.add(&name, pairs.map(|(a, b)| (a - b).abs() / mean));
    }
    valences.finish();
    lengths.finish();
    Ok(())
}
