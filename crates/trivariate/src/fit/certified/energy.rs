//! What a certified fit minimises, over all control points in one lattice for each coordinate.

use super::descent::Descent;
use super::hinges::Hinges;
use crate::fit::least_squares::System;

/// Squared distances with smoothing, over the mean square size, and hinges.
pub(super) struct Energy<'a> {
    pub(super) system: &'a System,
    /// Divides the sum of squares: total weight times the squared diagonal of the solid.
    pub(super) scale: f64,
    /// Sum of squares of the samples, so that the energy of a perfect fit is 0.
    pub(super) constant: f64,
    pub(super) hinges: Hinges,
}

impl Energy<'_> {
    /// Squared distances and smoothing; `each` is told the gradient, number after number.
    fn squares(&self, x: &[f64], mut each: impl FnMut(f64)) -> f64 {
        let equations = &self.system.equations;
        let product = equations.matrix.apply(x);
        let mut value = self.constant;
        for ((&x, &ax), &b) in x.iter().zip(&product).zip(&equations.right) {
            value += x * (ax - 2.0 * b);
            each(2.0 * (ax - b) / self.scale);
        }
        value / self.scale
    }
}

impl Descent for Energy<'_> {
    fn evaluate(&self, x: &[f64]) -> (f64, Vec<f64>) {
        let mut gradient = Vec::with_capacity(x.len());
        let value = self.squares(x, |g| gradient.push(g));
        let hinges = self.hinges.add(x, &mut gradient);
        (value + hinges, gradient)
    }

    fn precondition(&self, gradient: &[f64]) -> Vec<f64> {
        let mut step = self.system.inverse.apply(gradient);
        step.iter_mut().for_each(|s| *s *= 0.5 * self.scale);
        step
    }
}
