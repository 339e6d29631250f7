//! Components, boundaries and defects of meshes and of random triangles against CGAL.

use std::collections::{BTreeMap, BTreeSet};

use msplines_common::mesh::{Defect, PolygonSoup, Topology, TriangleMesh, preflight};
use msplines_reference::record::Comparison;
use msplines_reference::{Library, cgal_pieces, cgal_soup, meshes};
use nalgebra::{Point3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Sums of lengths in another order.
const ROUNDING: f64 = 1e-13;
/// Random sets of triangles for each number of vertices.
const SOUPS: u64 = 2_000;

/// All meshes, two of them side by side, and with random holes: many components and loops.
fn pieces() -> Vec<(String, TriangleMesh)> {
    let mut all = meshes::all();
    for (seed, (name, mesh)) in meshes::generated().into_iter().enumerate() {
        let shift = Vector3::repeat(2.0 * mesh.diagonal());
        all.push((format!("two of {name}"), meshes::beside(&mesh, shift)));
        // Where the rest is no manifold, fewer holes are made.
        let share = |parts: usize| mesh.vertex_count() / parts;
        let holed = [12, 25, 50, 100, 200, 400]
            .into_iter()
            .find_map(|parts| meshes::holed(&mesh, share(parts), seed as u64));
        let holed = holed.expect("few holes leave a manifold");
        all.push((format!("{name} with random holes"), holed));
    }
    all
}

/// Faces that two ways to name components put together in one only.
fn differing(ours: &[u32], theirs: &[u32]) -> usize {
    let (mut there, mut here) = (BTreeMap::new(), BTreeMap::new());
    let pairs = ours.iter().zip(theirs);
    let apart = pairs.filter(|(a, b)| {
        *there.entry(**a).or_insert(**b) != **b || *here.entry(**b).or_insert(**a) != **a
    });
    apart.count()
}

#[test]
fn components_and_boundary_loops_agree() {
    let exact = "faces put together by one alone, and difference of counts";
    let library = Library::Cgal;
    let mut counts = Comparison::new("components and boundary loops", library, 0.0, exact);
    let why = "relative: sums in another order";
    let mut lengths = Comparison::new("length of boundary loops", library, ROUNDING, why);
    for (name, mesh) in pieces() {
        let theirs = cgal_pieces(&mesh);
        let topology = mesh.topology();
        let (own, count) = topology.components();
        // Ours are of vertices, and theirs of faces.
        let ours: Vec<u32> = mesh.faces().iter().map(|f| own[f[0] as usize]).collect();
        let distinct: BTreeSet<u32> = theirs.components.iter().copied().collect();
        let loops = topology.boundary_loops();
        let apart = [
            differing(&ours, &theirs.components),
            distinct.len().abs_diff(count as usize),
            loops.len().abs_diff(theirs.border_lengths.len()),
        ];
        counts.add(&name, apart.map(|apart| apart as f64));
        let side = |&half_edge: &u32| {
            let ends = [topology.origin(half_edge), topology.target(half_edge)];
            let [a, b] = ends.map(|v| mesh.positions()[v as usize]);
            (b - a).norm()
        };
        let length = |around: &Vec<u32>| around.iter().map(side).sum::<f64>();
        let mut ours: Vec<f64> = loops.iter().map(length).collect();
        let mut theirs = theirs.border_lengths;
        ours.sort_by(f64::total_cmp);
        theirs.sort_by(f64::total_cmp);
        let pairs = ours.iter().zip(&theirs);
        lengths.add(&name, pairs.map(|(a, b)| (a / b - 1.0).abs()));
    }
    counts.finish();
    lengths.finish();
}

/// Returns random triangles of which no two run along an edge in the same direction, or have the same
/// corners: most are no manifold because of their vertices alone.
fn random_fans(vertices: u32, random: &mut Pcg64Mcg) -> Vec<[u32; 3]> {
    let (mut taken, mut sets) = (BTreeSet::new(), BTreeSet::new());
    let mut kept = Vec::new();
    for face in meshes::random_triangles(vertices, random) {
        let [a, b, c] = face;
        let mut set = face;
        set.sort_unstable();
        let sides = [[a, b], [b, c], [c, a]];
        if sides.iter().all(|side| !taken.contains(side)) && sets.insert(set) {
            taken.extend(sides);
            kept.push(face);
        }
    }
    kept
}

#[test]
fn random_triangles_are_judged_manifold_or_not_alike() {
    let why = "both answer yes or no";
    let quantity = "random triangles manifold or not";
    let mut comparison = Comparison::new(quantity, Library::Cgal, 0.0, why);
    let mut answers = [0; 2];
    for vertices in 4..10 {
        for seed in 0..SOUPS {
            let mut random = Pcg64Mcg::seed_from_u64(seed);
            let draw = [meshes::random_triangles, random_fans][seed as usize % 2];
            let (used, faces) = meshes::compact(&draw(vertices, &mut random));
            let theirs = cgal_soup(used.len(), &faces).is_manifold;
            let ours = Topology::build(used.len(), faces).is_ok();
            answers[usize::from(ours)] += 1;
            let apart = f64::from(u8::from(ours != theirs));
            comparison.add(&format!("soups of {vertices} vertices"), [apart]);
        }
    }
    println!("{answers:?}");
    assert!(answers.iter().all(|&count| count > 1_000), "{answers:?}");
    comparison.finish();
}

#[test]
fn the_same_vertices_are_bow_ties() {
    let why = "vertices that one alone finds";
    let mut comparison = Comparison::new("vertices that are bow ties", Library::Cgal, 0.0, why);
    let (mut ties, mut soups) = (0, 0);
    for vertices in 5..11 {
        for seed in 0..SOUPS {
            let mut random = Pcg64Mcg::seed_from_u64(seed);
            let (used, faces) = meshes::compact(&random_fans(vertices, &mut random));
            let theirs = cgal_soup(used.len(), &faces);
            // Its mesh has no place for a fan beside a closed one.
            if !theirs.takes_all {
                continue;
            }
            let place = |_| Point3::from([0; 3].map(|_| random.random_range(-1.0..1.0)));
            let positions = (0..used.len()).map(place).collect();
            let found = preflight(&PolygonSoup::from_triangles(positions, &faces));
            let ours = found.defects.iter().filter_map(|defect| match defect {
                Defect::BowTieVertex { vertex, .. } => Some(*vertex),
                _ => None,
            });
            let ours: BTreeSet<u32> = ours.collect();
            let theirs: BTreeSet<u32> = theirs.non_manifold_vertices.into_iter().collect();
            ties += theirs.len();
            soups += 1;
            let apart = ours.symmetric_difference(&theirs).count();
            comparison.add(&format!("soups of {vertices} vertices"), [apart as f64]);
        }
    }
    println!("{ties} bow ties in {soups} soups");
    assert!(ties > 1_000, "{ties}");
    comparison.finish();
}
