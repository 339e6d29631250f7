//! Minimisation by limited-memory quasi-Newton steps.
//!
//! # Notation
//! `x` unknowns, `g` gradient, `s` and `y` differences of both between steps, `H0` the inverse of an
//! approximate Hessian.

use std::collections::VecDeque;

use rayon::prelude::*;

/// Numbers that one task adds up: fixed, so that sums do not depend on the number of threads.
const CHUNK: usize = 4096;

/// Pairs of differences that are kept.
const MEMORY: usize = 12;

/// Armijo's and Wolfe's constants.
const DECREASE: f64 = 1e-4;
const CURVATURE: f64 = 0.9;

/// Longest way of an unknown in a first step; those of maps to the cube are between 0 and 1.
const FIRST_STEP: f64 = 0.1;

/// What is left of a step that was not allowed.
const SHRINK: f64 = 0.2;

/// Most evaluations of one line search.
const TRIALS: usize = 30;

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Most evaluations.
    pub(crate) evaluations: usize,
    /// Stop when a step lowers the objective by less than this fraction.
    pub(crate) progress: f64,
}

/// How a minimisation ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Descended {
    /// Evaluations made.
    pub(crate) evaluations: usize,
    /// The objective at the end.
    pub(crate) value: f64,
    /// Whether the limit of evaluations ended it.
    pub(crate) exhausted: bool,
}

/// Returns `a . b`, the same on any number of threads.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let part = |(a, b): (&[f64], &[f64])| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    if a.len() <= CHUNK {
        return part((a, b));
    }
    let parts: Vec<f64> = a
        .par_chunks(CHUNK)
        .zip(b.par_chunks(CHUNK))
        .map(part)
        .collect();
    parts.iter().sum()
}

/// Adds `factor * b` to `a`.
fn add(a: &mut [f64], factor: f64, b: &[f64]) {
    let part = |(a, b): (&mut [f64], &[f64])| {
        a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * b);
    };
    a.par_chunks_mut(CHUNK)
        .zip(b.par_chunks(CHUNK))
        .for_each(part);
}

struct Pair {
    s: Vec<f64>,
    y: Vec<f64>,
    inverse: f64,
}

/// Lowers `objective(x, g) -> value`, which is infinite where `x` is not allowed, from an allowed
/// `x` on. `precondition` applies `H0` in place up to a factor. Unknowns without gradient stay.
///
/// # Reference
/// [Liu1989]. Deviation: steps that satisfy the weak Wolfe conditions, by bisection.
pub(crate) fn minimise(
    x: &mut [f64],
    limits: Limits,
    precondition: &dyn Fn(&mut [f64]),
    mut objective: impl FnMut(&[f64], &mut [f64]) -> f64,
) -> Descended {
    let mut gradient = vec![0.0; x.len()];
    let mut state = Descended {
        evaluations: 1,
        value: objective(x, &mut gradient),
        exhausted: false,
    };
    let mut pairs: VecDeque<Pair> = VecDeque::new();
    let (mut trial, mut trial_gradient) = (x.to_vec(), gradient.clone());
    loop {
        let direction = direction(&gradient, &pairs, precondition);
        let slope = dot(&direction, &gradient);
        if slope.is_nan() || slope >= 0.0 || !state.value.is_finite() {
            return state;
        }
        let before = state.value;
        let found = search(&direction, slope, before, limits, &mut state, |step, _| {
            trial.copy_from_slice(x);
            add(&mut trial, step, &direction);
            let value = objective(&trial, &mut trial_gradient);
            (value, dot(&direction, &trial_gradient))
        });
        let Some(value) = found else {
            if pairs.is_empty() || state.exhausted {
                return state;
            }
            // A poor memory is forgotten before giving up.
            pairs.clear();
            continue;
        };
        push(&mut pairs, x, &trial, &gradient, &trial_gradient);
        x.copy_from_slice(&trial);
        gradient.copy_from_slice(&trial_gradient);
        state.value = value;
        if before - value <= limits.progress * before.abs() || state.exhausted {
            return state;
        }
    }
}

/// Returns the direction of descent, by the two loops of the limited memory.
fn direction(
    gradient: &[f64],
    pairs: &VecDeque<Pair>,
    precondition: &dyn Fn(&mut [f64]),
) -> Vec<f64> {
    let mut q: Vec<f64> = gradient.iter().map(|g| -g).collect();
    let mut factors = Vec::with_capacity(pairs.len());
    for pair in pairs.iter().rev() {
        let factor = pair.inverse * dot(&pair.s, &q);
        add(&mut q, -factor, &pair.y);
        factors.push(factor);
    }
    precondition(&mut q);
    if let Some(last) = pairs.back() {
        let mut scaled = last.y.clone();
        precondition(&mut scaled);
        let scale = 1.0 / (last.inverse * dot(&last.y, &scaled));
        q.par_iter_mut().for_each(|q| *q *= scale);
    }
    if pairs.is_empty() {
        let longest = q.iter().fold(0.0, |longest: f64, q| longest.max(q.abs()));
        if longest > FIRST_STEP {
            q.iter_mut().for_each(|q| *q *= FIRST_STEP / longest);
        }
    }
    for (pair, factor) in pairs.iter().zip(factors.into_iter().rev()) {
        let correction = factor - pair.inverse * dot(&pair.y, &q);
        add(&mut q, correction, &pair.s);
    }
    q
}

/// Returns the value at a step that satisfies the weak Wolfe conditions, or at least decreases.
fn search(
    direction: &[f64],
    slope: f64,
    value: f64,
    limits: Limits,
    state: &mut Descended,
    mut evaluate: impl FnMut(f64, &[f64]) -> (f64, f64),
) -> Option<f64> {
    let (mut low, mut high, mut step) = (0.0, f64::INFINITY, 1.0);
    for trial in 1..=TRIALS {
        let (trial_value, trial_slope) = evaluate(step, direction);
        state.evaluations += 1;
        state.exhausted = state.evaluations >= limits.evaluations;
        let decreased = trial_value <= value + DECREASE * step * slope;
        if decreased && (trial_slope >= CURVATURE * slope || state.exhausted || trial == TRIALS) {
            return Some(trial_value);
        }
        if decreased {
            low = step;
        } else {
            high = step;
        }
        if state.exhausted {
            return None;
        }
        step = match (high.is_finite(), trial_value.is_finite()) {
            (true, true) => 0.5 * (low + high),
            (true, false) => low + SHRINK * (high - low),
            (false, _) => 2.0 * step,
        };
    }
    None
}

fn push(pairs: &mut VecDeque<Pair>, x: &[f64], new_x: &[f64], g: &[f64], new_g: &[f64]) {
    let difference =
        |a: &[f64], b: &[f64]| -> Vec<f64> { a.par_iter().zip(b).map(|(a, b)| a - b).collect() };
    let (s, y) = (difference(new_x, x), difference(new_g, g));
    let product = dot(&s, &y);
    if product <= 1e-14 * (dot(&s, &s) * dot(&y, &y)).sqrt() {
        return;
    }
    if pairs.len() == MEMORY {
        pairs.pop_front();
    }
    let inverse = 1.0 / product;
    pairs.push_back(Pair { s, y, inverse });
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits {
        evaluations: 500,
        progress: 1e-15,
    };

    #[test]
    fn a_quadratic_is_minimised() {
        let objective = |x: &[f64], g: &mut [f64]| {
            let mut value = 0.0;
            for (i, (x, g)) in x.iter().zip(g).enumerate() {
                let weight = 1.0 + i as f64;
                *g = weight * (x - 1.0);
                value += 0.5 * weight * (x - 1.0) * (x - 1.0);
            }
            value
        };
        let mut x = vec![0.0; 50];
        let end = minimise(&mut x, LIMITS, &|_| {}, objective);
        assert!(end.value < 1e-12, "{end:?}");
        assert!(end.evaluations < 200, "{end:?}");
        let diagonal = |g: &mut [f64]| {
            g.iter_mut()
                .enumerate()
                .for_each(|(i, g)| *g /= 1.0 + i as f64);
        };
        let mut x = vec![0.0; 50];
        let end = minimise(&mut x, LIMITS, &diagonal, objective);
        assert!(end.evaluations < 10, "{end:?}");
    }

    #[test]
    fn a_barrier_is_never_crossed() {
        let mut lowest = f64::INFINITY;
        let objective = |x: &[f64], g: &mut [f64]| {
            if x[0] <= 0.0 {
                return f64::INFINITY;
            }
            lowest = lowest.min(x[0]);
            g[0] = 10.0 - 1.0 / x[0];
            10.0 * x[0] - x[0].ln()
        };
        let mut x = vec![5.0];
        minimise(&mut x, LIMITS, &|_| {}, objective);
        assert!((x[0] - 0.1).abs() < 1e-6, "{x:?}");
        assert!(lowest > 0.0);
    }
}
