//! Points of refined meshes.

use msplines_common::mesh::polygon::{Refined, Sharpness, catmull_clark};
use msplines_reference::Library;
use msplines_reference::record::Comparison;

use crate::cases::{ROUNDING, Tags, cases, extrapolated};

/// Single precision of the weights that masks are blended by.
const SINGLE: f64 = 1e-6;

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
