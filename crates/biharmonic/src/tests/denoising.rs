//! The number of knots that cross-validation chooses for noisy data.

use msplines_common::mesh::{TriangleMesh, shapes};
use nalgebra::Point3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::{fit_positions, positions};
use crate::{Fit, KnotChoice, Options};

/// Returns the mesh with noise of standard deviation `sigma` in every coordinate.
fn noisy(mesh: &TriangleMesh, sigma: f64) -> TriangleMesh {
    let mut random = Pcg64Mcg::seed_from_u64(4);
    // Twelve uniform numbers have variance 1.
    let mut normal = || (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
    let moved = |p: &Point3<f64>| p.map(|x| x + sigma * normal());
    mesh.with_positions(mesh.positions().iter().map(moved).collect())
}

fn run(mesh: &TriangleMesh, knots: KnotChoice) -> Fit {
    let options = Options {
        knots,
        ..Options::default()
    };
    fit_positions(mesh, &options)
}

fn rms(values: &[f64], truth: &[f64]) -> f64 {
    let sum: f64 = values.iter().zip(truth).map(|(a, b)| (a - b).powi(2)).sum();
    (sum / values.len() as f64).sqrt()
}

#[test]
fn the_chosen_number_of_knots_is_near_the_best_one() {
    let clean = shapes::bumpy_sphere(2000);
    let truth = positions(&clean);
    let mesh = noisy(&clean, 0.005 * clean.diagonal());
    let error = |fit: &Fit| rms(&fit.spline.vertex_values().unwrap(), &truth);
    let chosen = run(&mesh, KnotChoice::CrossValidated);
    let best = [40, 80, 130, 200, 300]
        .map(|count| error(&run(&mesh, KnotChoice::Optimised { count })))
        .into_iter()
        .fold(f64::INFINITY, f64::min);
    assert!(error(&chosen) < 1.1 * best, "{} {best}", error(&chosen));
    // The noise of the domain mesh stays in its Laplacian.
    assert!(error(&chosen) < 0.9 * rms(&positions(&mesh), &truth));
    let trials = &chosen.report.cross_validation;
    assert!(trials.windows(2).all(|pair| pair[1].knots < pair[0].knots));
    assert!(
        trials
            .iter()
            .any(|t| t.knots == chosen.spline.knots().len())
    );
}

#[test]
fn more_noise_bears_fewer_knots() {
    let clean = shapes::bumpy_sphere(1500);
    let knots = |level: f64| {
        let mesh = noisy(&clean, level * clean.diagonal());
        run(&mesh, KnotChoice::CrossValidated).spline.knots().len()
    };
    let (little, much) = (knots(0.002), knots(0.02));
    assert!(much < little, "{much} {little}");
}
