//! Limited-memory quasi-Newton minimisation of a smooth function of few variables.
//!
//! # Reference
//! [Liu1989] Algorithm 2.1.

use std::collections::VecDeque;

use nalgebra::DVector;

/// Pairs of steps and changes of the gradient that are kept.
const MEMORY: usize = 12;

/// Iterations after which a search ends: the variance of a form changes in its fourth digit then.
const ITERATIONS: usize = 80;

/// Relative decrease below which a search ends.
const DECREASE: f64 = 1e-7;

/// Part of the decrease that the gradient predicts which a step has to reach.
const SUFFICIENT: f64 = 1e-4;

/// Halvings of one step before a search ends.
const HALVINGS: usize = 30;

/// A smooth function.
pub(crate) trait Objective {
    /// Its value and gradient.
    fn evaluate(&self, x: &DVector<f64>) -> (f64, DVector<f64>);
}

/// Returns a local minimum and where it is.
pub(crate) fn minimise(objective: &impl Objective, start: DVector<f64>) -> (f64, DVector<f64>) {
    let mut x = start;
    let (mut value, mut gradient) = objective.evaluate(&x);
    let mut history: VecDeque<(DVector<f64>, DVector<f64>)> = VecDeque::new();
    for _ in 0..ITERATIONS {
        let mut direction = -two_loops(&gradient, &history);
        let mut slope = direction.dot(&gradient);
        if slope >= 0.0 {
            history.clear();
            direction = -&gradient;
            slope = -gradient.norm_squared();
        }
        // Without curvature known, the first step is a tenth of the unit sphere.
        let first = if history.is_empty() {
            0.1 / direction.norm().max(f64::MIN_POSITIVE)
        } else {
            1.0
        };
        let found = (0..HALVINGS).find_map(|halving| {
            let step = &direction * (first * 0.5f64.powi(halving as i32));
            let (trial, its_gradient) = objective.evaluate(&(&x + &step));
            let enough = value + SUFFICIENT * slope * first * 0.5f64.powi(halving as i32);
            (trial <= enough).then_some((step, trial, its_gradient))
        });
        let Some((step, trial, its_gradient)) = found else {
            break;
        };
        let change = &its_gradient - &gradient;
        let decrease = value - trial;
        x += &step;
        (value, gradient) = (trial, its_gradient);
        if step.dot(&change) > 0.0 {
            history.push_back((step, change));
            if history.len() > MEMORY {
                history.pop_front();
            }
        }
        if decrease <= DECREASE * value.abs() {
            break;
        }
    }
    (value, x)
}

fn two_loops(
    gradient: &DVector<f64>,
    history: &VecDeque<(DVector<f64>, DVector<f64>)>,
) -> DVector<f64> {
    let mut q = gradient.clone();
    let mut factors = Vec::with_capacity(history.len());
    for (step, change) in history.iter().rev() {
        let factor = step.dot(&q) / step.dot(change);
        q.axpy(-factor, change, 1.0);
        factors.push(factor);
    }
    if let Some((step, change)) = history.back() {
        q *= step.dot(change) / change.norm_squared();
    }
    for ((step, change), factor) in history.iter().zip(factors.into_iter().rev()) {
        let correction = factor - change.dot(&q) / step.dot(change);
        q.axpy(correction, step, 1.0);
    }
    q
}
