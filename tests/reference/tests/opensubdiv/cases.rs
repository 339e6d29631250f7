//! Control meshes with tags, refined here and by OpenSubdiv.

use msplines_common::mesh::polygon::{
    BoundaryCorners, CreaseRule, PolygonMesh, PolygonTopology, Refined, Rules, Sharpness,
    catmull_clark,
};
use msplines_reference::meshes;
use msplines_reference::polygon::{Limits, opensubdiv};
use nalgebra::Point3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Sums of products in another order, over three refinements and a limit.
pub(super) const ROUNDING: f64 = 1e-12;
/// Refinements that are compared.
const LEVELS: u32 = 3;

/// Which edges and vertices are tagged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Tags {
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
pub(super) fn extrapolated(before: &Refined, after: &Refined) -> Vec<u32> {
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
pub(super) struct Case {
    pub(super) name: String,
    pub(super) mesh: PolygonMesh,
    pub(super) sharpness: Sharpness,
    pub(super) rules: Rules,
    /// Our levels from the first one on, as they follow from the one before.
    pub(super) levels: Vec<Refined>,
    /// Our points.
    pub(super) ours: Vec<Vec<Point3<f64>>>,
    /// Points of OpenSubdiv.
    pub(super) theirs: Vec<Vec<Point3<f64>>>,
    pub(super) limits: Limits,
    /// Whether a point hangs on an edge point that OpenSubdiv extrapolates.
    pub(super) apart: Vec<Vec<bool>>,
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

    pub(super) fn last(&self) -> Refined {
        let last = self.levels.last().expect("a level");
        Refined::none(&last.topology, &last.sharpness)
    }

    /// Returns the deviations of all points of all levels, in diagonals.
    pub(super) fn deviations(&self) -> Vec<f64> {
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

pub(super) fn cases(tags: Tags) -> Vec<Case> {
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
