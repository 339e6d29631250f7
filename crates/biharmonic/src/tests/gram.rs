//! What preconditions the normal equations against the dense equations themselves.

use msplines_common::linalg::Mat;
use msplines_common::mesh::{shapes, zoo};

use super::{dense_solve, farthest_knots, gram, space, spread_knots, weighted};
use crate::gram::{Gram, Sight};
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
    let found = gram(&space, &system, &target).solve(b.as_ref());
    let difference = super::largest(&(&found - &expected));
    assert!(
        difference < 1e-6 * super::largest(&expected),
        "{difference}"
    );
}

/// The fits take 8 and 12 iterations where a ring is seen, 5 and 7 where two are.
#[test]
fn who_sees_further_needs_fewer_iterations() {
    for mesh in [shapes::bumpy_sphere(3000), zoo::with_boundary()] {
        let space = space(&mesh);
        let knots = spread_knots(mesh.vertex_count(), mesh.vertex_count() / 20);
        let system = KnotValues::factor(&space, knots).unwrap();
        let target = weighted(&mesh);
        let [near, far] = [Sight::Ring, Sight::TwoRings].map(|sight| {
            let gram = Gram::on(&space, &system, &target, sight).unwrap();
            system
                .least_squares(&target, &target.data, &gram, 1e-10, 100)
                .1
        });
        assert!(near.converged && far.converged);
        assert!(far.iterations < near.iterations && near.iterations <= 16);
    }
}

/// What is compared between knots is right up to a factor that they share: the ratios to the exact
/// costs spread by 9 %, the costs themselves by 41 %.
#[test]
fn costs_of_removals_rank_as_the_exact_ones() {
    let mesh = shapes::bumpy_sphere(3000);
    let space = space(&mesh);
    let system = KnotValues::factor(&space, farthest_knots(&mesh, 150)).unwrap();
    let target = weighted(&mesh);
    let (_, exact) = dense_equations(&system, &target);
    let found = gram(&space, &system, &target).removal;
    let logs: Vec<f64> = found
        .iter()
        .zip(&exact)
        .map(|(a, b)| (a / b).ln())
        .collect();
    let mean = logs.iter().sum::<f64>() / logs.len() as f64;
    let spread = logs.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / logs.len() as f64;
    assert!(spread.sqrt() < 0.2, "{}", spread.sqrt());
}
