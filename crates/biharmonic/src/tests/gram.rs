//! What preconditions the normal equations against the dense equations themselves.

use msplines_common::linalg::Mat;
use msplines_common::mesh::{TriangleMesh, shapes, zoo};

use super::{dense_solve, farthest_knots, gram, space, spread_knots, target};
use crate::knot_values::KnotValues;
use crate::target::Centred;

/// Returns `Hᵀ C² H` and `diag(S_T (Hᵀ C² H)⁻¹ S_T)`.
fn dense_equations(system: &KnotValues<'_>, target: &Centred) -> (Mat<f64>, Vec<f64>) {
    let count = system.knots().len();
    let mut basis = system.extend(Mat::identity(count, count).as_ref());
    let schur = system.coefficients(&basis);
    target.weigh(&mut basis);
    let normal = basis.transpose() * &basis;
    let solved = dense_solve(&normal, &schur);
    let diagonal = (0..count).map(|k| schur.col(k).transpose() * solved.col(k));
    (normal, diagonal.collect())
}

fn weighted(mesh: &TriangleMesh) -> Centred {
    let weights = (0..mesh.vertex_count()).map(|v| [0.2, 1.0, 3.0][v % 3]);
    Centred {
        weights: Some(weights.collect()),
        ..target(mesh)
    }
}

#[test]
fn few_knots_are_all_seen_and_solved_exactly() {
    let mesh = zoo::closed();
    let space = space(&mesh);
    // Four knots are neighbours of each other on a closed surface: each has a colour of its own.
    let system = KnotValues::factor(&space, farthest_knots(&mesh, 4)).unwrap();
    let target = weighted(&mesh);
    let (normal, _) = dense_equations(&system, &target);
    let b = Mat::from_fn(4, 2, |k, side| (1 + k + 7 * side) as f64);
    let expected = dense_solve(&normal, &b);
    let found = gram(&system, &target, &mesh).solve(b.as_ref());
    let difference = super::largest(&(&found - &expected));
    assert!(
        difference < 1e-6 * super::largest(&expected),
        "{difference}"
    );
}

#[test]
fn many_knots_are_preconditioned_well() {
    for mesh in [shapes::bumpy_sphere(3000), zoo::with_boundary()] {
        let space = space(&mesh);
        let knots = spread_knots(mesh.vertex_count(), mesh.vertex_count() / 20);
        let system = KnotValues::factor(&space, knots).unwrap();
        let target = weighted(&mesh);
        let gram = gram(&system, &target, &mesh);
        let (_, report) = system.least_squares(&target, &target.data, &gram, 1e-10, 100);
        assert!(report.converged && report.iterations <= 16, "{report:?}");
    }
}

/// What is compared between knots is right up to a factor that they share.
#[test]
fn costs_of_removals_rank_as_the_exact_ones() {
    let mesh = shapes::bumpy_sphere(3000);
    let space = space(&mesh);
    let system = KnotValues::factor(&space, farthest_knots(&mesh, 150)).unwrap();
    let target = weighted(&mesh);
    let (_, exact) = dense_equations(&system, &target);
    let found = gram(&system, &target, &mesh).removal;
    let logs: Vec<f64> = found
        .iter()
        .zip(&exact)
        .map(|(a, b)| (a / b).ln())
        .collect();
    let mean = logs.iter().sum::<f64>() / logs.len() as f64;
    let spread = logs.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / logs.len() as f64;
    assert!(spread.sqrt() < 0.25, "{}", spread.sqrt());
}
