//! The matrix `P` of `ψ = H P`: control points to values at the knots, and back.
//!
//! # Notation
//! `p = P λ`. `P` is square, sparse and not symmetric, its rows sum to one. It is inverted through
//! `P Pᵀ`, whose sparse Cholesky factor the crate's own linear algebra provides, and the solution is
//! refined with residuals of `P` itself: at a condition below 100 nothing of the squaring remains.

use msplines_common::linalg::{Cholesky, Mat, MatRef, Ordering, Symbolic, SymmetricMatrix, column};

use super::SparseColumns;
use crate::FitError;

/// Steps of refinement: each gains `16 - 2 log₁₀ cond P` digits.
const REFINEMENTS: u32 = 3;

/// Steps of the power iterations that estimate the condition number.
const POWER_STEPS: u32 = 300;

/// Relative change of an eigenvalue at which power iterations stop.
const POWER_CHANGE: f64 = 1e-5;

/// `P` and the factor of `P Pᵀ`.
#[derive(Debug)]
pub(super) struct Mixture {
    matrix: SparseColumns,
    factor: Cholesky,
}

impl Mixture {
    /// Factors `P Pᵀ`.
    pub(super) fn build(matrix: SparseColumns) -> Result<Self, FitError> {
        let size = matrix.shape().0;
        let mut entries = Vec::new();
        for column in 0..size {
            let (rows, values) = matrix.column(column);
            for (a, &row) in rows.iter().enumerate() {
                for b in 0..=a {
                    entries.push((row, rows[b], values[a] * values[b]));
                }
            }
        }
        let normal = SymmetricMatrix::from_lower_triplets(size, &entries);
        let ordering = Ordering::nested_dissection(&normal)?;
        let factor = Cholesky::factor(Symbolic::analyze(&normal, &ordering), &normal)?;
        Ok(Self { matrix, factor })
    }

    pub(super) fn matrix(&self) -> &SparseColumns {
        &self.matrix
    }

    /// Returns `P λ`.
    pub(super) fn mix(&self, control_points: MatRef<'_, f64>) -> Mat<f64> {
        self.matrix.multiply(control_points)
    }

    /// Returns `P⁻¹ p`.
    pub(super) fn unmix(&self, values: MatRef<'_, f64>) -> Mat<f64> {
        let solve = |mut r: Mat<f64>| {
            self.factor.solve_in_place(r.as_mut());
            self.matrix.multiply_transposed(r.as_ref())
        };
        let mut control_points = solve(values.to_owned());
        for _ in 0..REFINEMENTS {
            let residual = values - self.mix(control_points.as_ref());
            control_points += solve(residual);
        }
        control_points
    }

    /// Returns an estimate of the condition number of `P` in the 2-norm, from below.
    pub(super) fn condition(&self) -> f64 {
        let (largest, _) = power(self.matrix.shape().0, |x| {
            self.mix(self.matrix.multiply_transposed(x.as_ref()).as_ref())
        });
        let (inverse, _) = self.weakest_values();
        (largest * inverse).sqrt()
    }

    /// Returns the combination of control points that changes the values at the knots least, up to a
    /// factor.
    pub(super) fn weakest(&self) -> Vec<f64> {
        let (_, values) = self.weakest_values();
        let points = self.matrix.multiply_transposed(values.as_ref());
        column(points.as_ref(), 0).to_vec()
    }

    fn weakest_values(&self) -> (f64, Mat<f64>) {
        power(self.matrix.shape().0, |mut x| {
            self.factor.solve_in_place(x.as_mut());
            x
        })
    }
}

/// Returns the largest eigenvalue of a symmetric positive definite operator, and its vector up to a
/// factor.
fn power(size: usize, apply: impl Fn(Mat<f64>) -> Mat<f64>) -> (f64, Mat<f64>) {
    // Without symmetry of its own, so that it lacks no eigenvector.
    let mut x = Mat::from_fn(size, 1, |i, _| (i as f64 * 1.618_034).fract() - 0.3);
    let mut eigenvalue = 0.0;
    for _ in 0..POWER_STEPS {
        x *= 1.0 / x.norm_l2();
        let image = apply(x.clone());
        let next = image.norm_l2();
        let settled = (next - eigenvalue).abs() <= POWER_CHANGE * next;
        eigenvalue = next;
        x = image;
        if settled {
            break;
        }
    }
    (eigenvalue, x)
}
