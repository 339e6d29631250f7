//! The gradient of the energy, and the descent.

use nalgebra::Point3;

use super::Options;
use super::descent::{Descent, Limits, descend};
use super::energy::Energy;
use super::hinges::{Hinges, Parts};
use super::local::Local;
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

/// What `check` says of the energy of a folded solid of `spans` spans, around its least squares.
fn with_energy(spans: usize, check: impl FnOnce(Energy<'_>, &Options, Vec<f64>)) {
    let (samples, squares) = (samples(), least_squares::Options::default());
    let mut problem = Problem::start(&samples, &squares);
    let (system, _) = problem.solve(spans);
    let options = Options {
        samplings: vec![3, 5],
        margin: 0.1,
        element_weight: 1e-3,
        coefficient_weight: 1e-3,
        ..Options::default()
    };
    let energy = Energy {
        system: &system,
        scale: 512.0,
        constant: 0.0,
        hinges: Hinges::build(spans, 0.1, &options, 1.0),
    };
    check(energy, &options, problem.values().to_vec());
}

/// Asserts that a gradient is that of the values.
fn check_gradient(function: &impl Descent, x: &[f64]) {
    let (_, gradient) = function.evaluate(x);
    assert!(gradient.iter().any(|slope| slope.abs() > 1e-3));
    let h = 1e-6;
    for at in (0..x.len()).step_by(37) {
        let moved = |by: f64| {
            let mut x = x.to_vec();
            x[at] += by;
            function.evaluate(&x).0
        };
        let slope = (moved(h) - moved(-h)) / (2.0 * h);
        assert!(
            (slope - gradient[at]).abs() < 1e-5 * (1.0 + slope.abs()),
            "{at}"
        );
    }
}

#[test]
fn gradients_are_differences() {
    with_energy(4, |mut energy, options, x| {
        let all = energy.hinges.all();
        energy.hinges.watch(&x, &all);
        assert!(energy.hinges.bad(&x, options).spans.len() >= 32);
        check_gradient(&energy, &x);
    });
}

#[test]
fn a_part_of_the_energy_changes_as_the_whole_does() {
    with_energy(8, |mut energy, _, x| {
        let all = energy.hinges.all();
        energy.hinges.watch(&x, &all);
        let one = Parts {
            spans: vec![0],
            cells: vec![vec![], vec![]],
        };
        let moved = |values: &[f64]| -> Vec<f64> {
            let step = |(at, x): (usize, &f64)| x + 0.01 * (at as f64).sin();
            values.iter().enumerate().map(step).collect()
        };
        let (whole, part) = {
            let Ok(local) = Local::around(&one, (1, 0), &mut energy, x.clone()) else {
                panic!("one span is a small part");
            };
            let start = local.values();
            check_gradient(&local, &moved(&start));
            let part = local.evaluate(&moved(&start)).0 - local.evaluate(&start).0;
            (local.whole(&moved(&start)), part)
        };
        let change = energy.evaluate(&whole).0 - energy.evaluate(&x).0;
        assert!(
            (change - part).abs() < 1e-12 * (1.0 + change.abs()),
            "{change} {part}"
        );
        let still = whole.iter().zip(&x).filter(|(a, b)| a == b).count();
        assert!(still > x.len() / 2, "{still} of {}", x.len());
    });
}

#[test]
fn what_is_far_is_not_a_small_part() {
    with_energy(4, |mut energy, _, x| {
        let all = energy.hinges.all();
        assert!(Local::around(&all, (2, 0), &mut energy, x).is_err());
    });
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
