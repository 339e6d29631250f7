//! The gradient of the energy, and the descent.

use nalgebra::Point3;

use super::descent::{Descent, Limits, descend};
use super::energy::{Energy, Grid, Weights};
use crate::VolumeSamples;
use crate::fit::least_squares::{self, Problem};

/// Folds beyond the middle of its first parameter.
fn folded(at: [f64; 3]) -> Point3<f64> {
    Point3::new(
        at[0] - at[0] * at[0],
        at[1] + 0.2 * at[0],
        at[2] - 0.1 * at[1],
    )
}

fn samples() -> VolumeSamples {
    let step = |i: usize| (i as f64 + 0.5) / 8.0;
    let parameters: Vec<[f64; 3]> = (0..512)
        .map(|at| [step(at % 8), step(at / 8 % 8), step(at / 64)])
        .collect();
    let points = parameters.iter().map(|&at| folded(at)).collect();
    VolumeSamples::build(parameters, points).expect("samples")
}

#[test]
fn gradients_are_differences() {
    let (samples, options) = (samples(), least_squares::Options::default());
    let mut problem = Problem::start(&samples, &options);
    let (system, _) = problem.solve(4);
    let mut energy = Energy {
        spans: 4,
        system: &system,
        scale: 512.0,
        constant: 0.0,
        volume: 0.1,
        delta: 0.1,
        grids: vec![Grid::build(4, 3), Grid::build(4, 5)],
        active: Vec::new(),
        weights: Weights {
            elements: 1e-3,
            coefficients: 1e-3,
        },
    };
    let x = problem.values().to_vec();
    energy.find_active(&x);
    assert!(energy.active.len() >= 32);
    let (_, gradient) = energy.evaluate(&x);
    let h = 1e-6;
    for at in (0..x.len()).step_by(37) {
        let moved = |by: f64| {
            let mut x = x.clone();
            x[at] += by;
            energy.evaluate(&x).0
        };
        let slope = (moved(h) - moved(-h)) / (2.0 * h);
        assert!(
            (slope - gradient[at]).abs() < 1e-5 * (1.0 + slope.abs()),
            "{at}"
        );
    }
}

/// A narrow bent valley with its end at (1, 1).
struct Rosenbrock;

impl Descent for Rosenbrock {
    fn evaluate(&self, x: &[f64]) -> (f64, Vec<f64>) {
        let (a, b) = (1.0 - x[0], x[1] - x[0] * x[0]);
        let gradient = vec![-2.0 * a - 400.0 * b * x[0], 200.0 * b];
        (a * a + 100.0 * b * b, gradient)
    }

    fn precondition(&self, gradient: &[f64]) -> Vec<f64> {
        gradient.iter().map(|g| 1e-3 * g).collect()
    }
}

#[test]
fn descent_reaches_the_end_of_a_valley() {
    let mut x = vec![-1.2, 1.0];
    let limits = Limits {
        evaluations: 200,
        tolerance: 0.0,
    };
    let (_, evaluations) = descend(&Rosenbrock, &mut x, limits);
    assert!(
        (x[0] - 1.0).abs() < 1e-6 && (x[1] - 1.0).abs() < 1e-6,
        "{x:?}"
    );
    assert!(evaluations < 120, "{evaluations}");
}
