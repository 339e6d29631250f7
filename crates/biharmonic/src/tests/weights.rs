//! Weights of vertices: in the normal equations, in the scores, in the selection.

use msplines_common::evaluate::VertexData;
use msplines_common::linalg::Mat;
use msplines_common::mesh::{TriangleMesh, shapes, zoo};
use msplines_common::progress::unobserved;
use std::sync::Arc;

use super::{centred, dense_solve, gram, positions, space, spread_knots, weighted};
use crate::knot_values::KnotValues;
use crate::select::insertion_denominators;
use crate::{FitError, KnotChoice, Options, Target, fit_in};

#[test]
fn a_weighted_fit_solves_the_weighted_normal_equations() {
    const TOLERANCE: f64 = 1e-9;
    let mesh = zoo::with_boundary();
    let (space, data) = (space(&mesh), centred(&mesh));
    let system = KnotValues::factor(&space, spread_knots(mesh.vertex_count(), 40)).unwrap();
    let target = weighted(&mesh);
    let identity = Mat::from_fn(40, 40, |i, j| f64::from(u8::from(i == j)));
    let mut basis = system.extend(identity.as_ref());
    let mut scaled = data.clone();
    target.weigh(&mut basis);
    target.weigh(&mut scaled);
    let values = dense_solve(
        &(basis.transpose() * &basis),
        &(basis.transpose() * &scaled),
    );
    let gram = gram(&space, &system, &target);
    let (f, report) = system.least_squares(&target, &data, &gram, 1e-22, 300);
    assert!(report.converged);
    let difference = system.gather(&f) - values;
    assert!(super::largest(&difference) < TOLERANCE);
}

/// The mean over many seeds of what is estimated with random signs is what is meant.
#[test]
fn probes_estimate_the_weighted_diagonal() {
    const TOLERANCE: f64 = 0.25; // 16 signs times 40 seeds
    let mesh = zoo::with_boundary();
    let space = space(&mesh);
    let knots = spread_knots(mesh.vertex_count(), 30);
    let system = KnotValues::factor(&space, knots.clone()).unwrap();
    let target = weighted(&mesh);
    let free = 7usize;
    assert!(!knots.contains(&(free as u32)));
    let delta = Mat::from_fn(mesh.vertex_count(), 1, |v, _| {
        f64::from(u8::from(v == free))
    });
    let mut green = system.solve_free(delta);
    target.weigh(&mut green);
    let seeds = 40;
    let estimate = |seed| insertion_denominators(&system, &target, seed)[free];
    let insertion: f64 = (0..seeds).map(estimate).sum::<f64>() / seeds as f64;
    assert!((insertion / green.squared_norm_l2() - 1.0).abs() < TOLERANCE);
}

fn region_error(mesh: &TriangleMesh, weights: Option<&[f64]>, region: &[bool]) -> (f64, usize) {
    let values = positions(mesh);
    let target = Target {
        data: VertexData {
            dimension: 3,
            values: &values,
        },
        weights,
    };
    let options = Options {
        knots: KnotChoice::Optimised { count: 120 },
        ..Options::default()
    };
    let space = Arc::new(space(mesh));
    let spline = fit_in(&space, target, &options, &mut unobserved())
        .unwrap()
        .spline;
    let found = spline.vertex_values().unwrap();
    let sum: f64 = (0..values.len())
        .filter(|i| region[i / 3])
        .map(|i| (found[i] - values[i]).powi(2))
        .sum();
    let inside = spline.knots().iter().filter(|&&k| region[k as usize]);
    (sum, inside.count())
}

/// Weights that enter the fit alone gain 2 % on a quarter of a scan; knots have to move there.
#[test]
fn knots_gather_where_weights_are_large() {
    let mesh = shapes::bumpy_sphere(4000);
    let region: Vec<bool> = mesh.positions().iter().map(|p| p.x > 0.5).collect();
    let weights: Vec<f64> = region.iter().map(|&r| if r { 5.0 } else { 1.0 }).collect();
    let (plain, before) = region_error(&mesh, None, &region);
    let (weighted, after) = region_error(&mesh, Some(&weights), &region);
    assert!(after > before, "{after} {before}");
    assert!(weighted < 0.5 * plain, "{weighted} {plain}");
}

#[test]
fn bad_weights_are_refused_with_their_place() {
    let mesh = zoo::closed();
    let values = positions(&mesh);
    let space = Arc::new(space(&mesh));
    let run = |weights: &[f64]| {
        let target = Target {
            data: VertexData {
                dimension: 3,
                values: &values,
            },
            weights: Some(weights),
        };
        let options = Options {
            knots: KnotChoice::Optimised { count: 20 },
            ..Options::default()
        };
        fit_in(&space, target, &options, &mut unobserved()).unwrap_err()
    };
    let n = mesh.vertex_count();
    assert!(matches!(
        run(&vec![1.0; n - 1]),
        FitError::WeightCount { .. }
    ));
    for bad in [-1.0, f64::NAN, 1e308] {
        let mut weights = vec![1.0; n];
        weights[9] = bad;
        assert!(matches!(run(&weights), FitError::Weight { vertex: 9, .. }));
    }
    let mut few = vec![0.0; n];
    few[..10].fill(1.0);
    let error = run(&few).to_string();
    assert!(
        error.starts_with("only 10 vertices have a positive weight"),
        "{error}"
    );
}
