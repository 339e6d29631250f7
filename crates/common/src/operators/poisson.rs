//! Solves with the Laplacian of a connected surface, whose null space are the constants.
//!
//! One vertex is left out of the factorisation (grounded). With a right-hand side of zero sum the
//! result solves the whole system exactly, whatever vertex that was; no epsilon is added anywhere.

use faer::reborrow::ReborrowMut;
use faer::{Mat, MatMut};

use super::Operators;
use crate::linalg::{
    Cholesky, FactorError, Ordering, OrderingError, Symbolic, SymmetricMatrix, column_mut,
};
use crate::mesh::disjoint_sets::DisjointSets;

/// Why the Laplacian cannot be factored.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PoissonError {
    /// No elimination order.
    #[error(transparent)]
    Ordering(#[from] OrderingError),
    /// Several components, each of which has constants of its own.
    #[error("the surface has {components} components; solve on each by itself")]
    NotConnected {
        /// How many.
        components: usize,
    },
    /// Not positive definite: a coordinate that is not finite.
    #[error(transparent)]
    Factor(#[from] FactorError),
}

/// The factored Laplacian of a connected surface.
#[derive(Clone, Debug)]
pub struct Poisson {
    factor: Cholesky,
    grounded: usize,
    mass: Vec<f64>,
}

impl Poisson {
    /// Factors the Laplacian.
    ///
    /// # Errors
    /// A surface that is not connected.
    pub fn factor(operators: &Operators) -> Result<Self, PoissonError> {
        let laplacian = &operators.laplacian;
        // Rounding may well leave a pivot that is positive where it should be zero.
        let components = components(laplacian);
        if components > 1 {
            return Err(PoissonError::NotConnected { components });
        }
        let ordering = Ordering::minimum_degree(laplacian, |_| true)?;
        // The vertex eliminated last: leaving it out changes nothing for the others.
        let grounded = ordering.as_slice().last().map_or(0, |&row| row as usize);
        let symbolic = Symbolic::analyze_kept(laplacian, &ordering, |row| row != grounded);
        let factor = Cholesky::factor(symbolic, laplacian)?;
        Ok(Self {
            factor,
            grounded,
            mass: operators.mass.clone(),
        })
    }

    /// Replaces `b` by a solution of `L x = b - mean(b)`, zero at one vertex.
    ///
    /// # Panics
    /// If `b` has not one row per vertex.
    pub fn solve_in_place(&self, mut b: MatMut<'_, f64>) {
        for side in 0..b.ncols() {
            remove_mean(column_mut(b.rb_mut(), side));
        }
        self.solve_balanced_in_place(b);
    }

    /// Replaces `b`, whose columns sum to zero, by a solution of `L x = b`, zero at one vertex.
    ///
    /// What the sum misses is taken from that vertex, and nothing elsewhere: where `b` has tiny
    /// entries, a mean of rounding errors would swamp them.
    ///
    /// # Panics
    /// If `b` has not one row per vertex.
    pub fn solve_balanced_in_place(&self, mut b: MatMut<'_, f64>) {
        for side in 0..b.ncols() {
            column_mut(b.rb_mut(), side)[self.grounded] = 0.0;
        }
        self.factor.solve_in_place(b);
    }

    /// Returns the solution of zero mean of `L A⁻¹ L x = b - mean(b)`, by two solves with `L`.
    ///
    /// The error is that of `L`, not of the far worse conditioned bi-Laplacian.
    ///
    /// # Reference
    /// [Lipman2010] §3; [Hou2017] §5. Deviation: the bi-Laplacian itself is not factored.
    ///
    /// # Panics
    /// If `b` has not one row per vertex.
    #[must_use]
    pub fn solve_biharmonic(&self, mut b: Mat<f64>) -> Mat<f64> {
        let total: f64 = self.mass.iter().sum();
        self.solve_in_place(b.as_mut());
        for side in 0..b.ncols() {
            let values = column_mut(b.as_mut(), side);
            // The area-weighted mean goes, so that A y is a right-hand side of zero sum.
            let weighted: f64 = values
                .iter()
                .zip(&self.mass)
                .map(|(y, area)| y * area)
                .sum();
            let mean = weighted / total;
            values
                .iter_mut()
                .zip(&self.mass)
                .for_each(|(y, area)| *y = area * (*y - mean));
        }
        self.solve_in_place(b.as_mut());
        (0..b.ncols()).for_each(|side| remove_mean(column_mut(b.as_mut(), side)));
        b
    }
}

/// Returns the number of parts that no entry joins.
fn components(matrix: &SymmetricMatrix) -> usize {
    let mut sets = DisjointSets::new(matrix.size());
    for column in 0..matrix.size() {
        for (row, _) in matrix.column(column) {
            sets.join(row as u32, column as u32, false);
        }
    }
    (0..matrix.size() as u32)
        .filter(|&v| sets.root(v) == v)
        .count()
}

fn remove_mean(values: &mut [f64]) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter_mut().for_each(|value| *value -= mean);
}
