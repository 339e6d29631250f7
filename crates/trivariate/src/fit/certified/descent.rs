//! L-BFGS: descent along an inverse Hessian that is learnt from the last steps.

use std::collections::VecDeque;

/// Steps that are remembered.
const MEMORY: usize = 12;

/// Share of the decrease that the slope promises which a step must bring.
const SUFFICIENT: f64 = 1e-4;

/// Halvings of a step before the search gives up.
const HALVINGS: u32 = 30;

/// How a descent ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// The last step brought too little, in the sense of the tolerance.
    Resting,
    /// No step along the direction brings anything.
    Stuck,
    /// The allowed number of evaluations was used up.
    Evaluations,
}

/// When a descent ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Most evaluations.
    pub(crate) evaluations: u32,
    /// Decrease of a step, against the value, below which it ends.
    pub(crate) tolerance: f64,
}

/// A function to descend on.
pub(crate) trait Descent {
    /// Value and gradient.
    fn evaluate(&self, x: &[f64]) -> (f64, Vec<f64>);
    /// An approximate inverse Hessian times a vector, symmetric and positive definite.
    fn precondition(&self, gradient: &[f64]) -> Vec<f64>;
}

/// One remembered step, the change of the gradient along it, and the inverse of their product.
struct Pair {
    step: Vec<f64>,
    change: Vec<f64>,
    inverse: f64,
}

/// A point with the value and gradient there.
struct Place {
    x: Vec<f64>,
    value: f64,
    gradient: Vec<f64>,
}

impl Place {
    fn at(function: &impl Descent, x: Vec<f64>) -> Self {
        let (value, gradient) = function.evaluate(&x);
        Self { x, value, gradient }
    }
}

/// Lowers a function from `x`, and returns how that ended and with how many evaluations.
pub(crate) fn descend(function: &impl Descent, x: &mut Vec<f64>, limits: Limits) -> (End, u32) {
    let mut pairs: VecDeque<Pair> = VecDeque::new();
    let mut now = Place::at(function, std::mem::take(x));
    let (mut evaluations, mut resting) = (1, 0);
    let end = loop {
        let direction = direction(function, &now.gradient, &pairs);
        let next = match search(
            function,
            &now,
            &direction,
            limits.evaluations,
            &mut evaluations,
        ) {
            Ok(next) => next,
            Err(End::Stuck) if !pairs.is_empty() => {
                // A fresh start along the gradient.
                pairs.clear();
                continue;
            }
            Err(end) => break end,
        };
        remember(&now, &next, &mut pairs);
        let rested = now.value - next.value <= limits.tolerance * next.value.abs();
        resting = if rested { resting + 1 } else { 0 };
        now = next;
        if resting >= 2 {
            break End::Resting;
        }
    };
    *x = now.x;
    (end, evaluations)
}

/// The first place along a direction that brings enough, steps growing shorter.
fn search(
    function: &impl Descent,
    now: &Place,
    direction: &[f64],
    most: u32,
    evaluations: &mut u32,
) -> Result<Place, End> {
    let slope = dot(direction, &now.gradient);
    let mut length = 1.0;
    for _ in 0..HALVINGS {
        if *evaluations >= most {
            return Err(End::Evaluations);
        }
        if slope >= 0.0 || slope.is_nan() {
            break;
        }
        let x = now.x.iter().zip(direction).map(|(x, d)| x + length * d);
        let next = Place::at(function, x.collect());
        *evaluations += 1;
        if next.value <= now.value + SUFFICIENT * length * slope {
            return Ok(next);
        }
        // The minimum of the parabola through what is known, within reason.
        let rise = next.value - now.value - length * slope;
        let parabola = if rise > 0.0 {
            -0.5 * slope * length * length / rise
        } else {
            0.0
        };
        length = parabola.clamp(0.1 * length, 0.5 * length);
    }
    Err(End::Stuck)
}

/// Keeps a step along which the function is convex.
fn remember(now: &Place, next: &Place, pairs: &mut VecDeque<Pair>) {
    let difference = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect();
    let step: Vec<f64> = difference(&next.x, &now.x);
    let change: Vec<f64> = difference(&next.gradient, &now.gradient);
    let product = dot(&step, &change);
    if product > f64::EPSILON * (dot(&change, &change) * dot(&step, &step)).sqrt() {
        if pairs.len() == MEMORY {
            pairs.pop_front();
        }
        pairs.push_back(Pair {
            step,
            change,
            inverse: 1.0 / product,
        });
    }
}

/// The two-loop recursion.
fn direction(function: &impl Descent, gradient: &[f64], pairs: &VecDeque<Pair>) -> Vec<f64> {
    let mut q: Vec<f64> = gradient.iter().map(|g| -g).collect();
    let mut shares = Vec::with_capacity(pairs.len());
    for pair in pairs.iter().rev() {
        let share = pair.inverse * dot(&pair.step, &q);
        add(-share, &pair.change, &mut q);
        shares.push(share);
    }
    let mut direction = function.precondition(&q);
    if let Some(pair) = pairs.back() {
        // How the approximate inverse is off along the last step.
        let scaled = dot(&function.precondition(&pair.change), &pair.change);
        let factor = 1.0 / (pair.inverse * scaled);
        direction.iter_mut().for_each(|d| *d *= factor);
    }
    for (pair, share) in pairs.iter().zip(shares.iter().rev()) {
        let back = pair.inverse * dot(&pair.change, &direction);
        add(share - back, &pair.step, &mut direction);
    }
    direction
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn add(factor: f64, from: &[f64], to: &mut [f64]) {
    for (sum, value) in to.iter_mut().zip(from) {
        *sum += factor * value;
    }
}
