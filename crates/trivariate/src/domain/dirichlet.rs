//! Harmonic functions with given values at some vertices.

use msplines_common::linalg::{
    Cholesky, FactorError, Mat, Ordering, OrderingError, Symbolic, SymmetricMatrix,
};

/// Why a Dirichlet problem has no solution.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DirichletError {
    /// No elimination order.
    #[error(transparent)]
    Ordering(#[from] OrderingError),
    /// Not positive definite.
    #[error(transparent)]
    Factor(#[from] FactorError),
}

/// A factored Laplacian, some of whose vertices are given.
pub(crate) struct Dirichlet<'a> {
    laplacian: &'a SymmetricMatrix,
    /// The rows to be found.
    unknown: Vec<u32>,
    given: &'a [bool],
    factor: Option<Cholesky>,
}

impl<'a> Dirichlet<'a> {
    pub(crate) fn factor(
        laplacian: &'a SymmetricMatrix,
        given: &'a [bool],
    ) -> Result<Self, DirichletError> {
        let unknown: Vec<u32> = (0..given.len() as u32)
            .filter(|&row| !given[row as usize])
            .collect();
        let mut problem = Self {
            laplacian,
            unknown,
            given,
            factor: None,
        };
        if !problem.unknown.is_empty() {
            let inner = problem.inner();
            let ordering = Ordering::nested_dissection(&inner)?;
            let symbolic = Symbolic::analyze(&inner, &ordering);
            problem.factor = Some(Cholesky::factor(symbolic, &inner)?);
        }
        Ok(problem)
    }

    /// Returns the rows and columns to be found: without the others, their order is found faster.
    fn inner(&self) -> SymmetricMatrix {
        let mut numbers = vec![0; self.given.len()];
        for (&row, number) in self.unknown.iter().zip(0u32..) {
            numbers[row as usize] = number;
        }
        let lower = |&row: &u32| {
            let entries = self.laplacian.column(row as usize);
            let kept = entries.filter(move |e| e.0 <= row as usize && !self.given[e.0]);
            let numbers = &numbers;
            kept.map(move |(column, entry)| (numbers[row as usize], numbers[column], entry))
        };
        let entries: Vec<(u32, u32, f64)> = self.unknown.iter().flat_map(lower).collect();
        SymmetricMatrix::from_lower_triplets(self.unknown.len(), &entries)
    }

    /// Replaces the values that are not given, in all maps at once.
    pub(crate) fn solve(&self, maps: &mut [&mut [[f64; 3]]]) {
        let Some(factor) = &self.factor else { return };
        let mut x = Mat::zeros(self.unknown.len(), 3 * maps.len());
        for (number, map) in maps.iter().enumerate() {
            for (k, &row) in self.unknown.iter().enumerate() {
                let mut sums = [0.0; 3];
                let entries = self.laplacian.column(row as usize);
                for (other, entry) in entries.filter(|e| self.given[e.0]) {
                    (0..3).for_each(|d| sums[d] -= entry * map[other][d]);
                }
                (0..3).for_each(|d| x[(k, 3 * number + d)] = sums[d]);
            }
        }
        factor.solve_in_place(x.as_mut());
        for (number, map) in maps.iter_mut().enumerate() {
            for (k, &row) in self.unknown.iter().enumerate() {
                (0..3).for_each(|d| map[row as usize][d] = x[(k, 3 * number + d)]);
            }
        }
    }
}
