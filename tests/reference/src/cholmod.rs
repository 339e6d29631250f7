//! CHOLMOD behind the interface that the timing needs.

use msplines_common::linalg::SymmetricMatrix;

use crate::bindings;

/// Supernodal Cholesky factorisation by CHOLMOD with METIS ordering.
pub struct Cholmod {
    solver: cxx::UniquePtr<bindings::Cholmod>,
}

impl Cholmod {
    /// Returns a solver for the principal submatrix of the rows for which `keep` holds, their
    /// order kept.
    ///
    /// # Panics
    /// If CHOLMOD has no memory.
    #[must_use]
    pub fn of(matrix: &SymmetricMatrix, keep: impl Fn(usize) -> bool) -> Self {
        let mut place = vec![u32::MAX; matrix.size()];
        let kept: Vec<usize> = (0..matrix.size()).filter(|&row| keep(row)).collect();
        for (new, &old) in kept.iter().enumerate() {
            place[old] = new as u32;
        }
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for &column in &kept {
            for (row, value) in matrix.column(column) {
                if row >= column && place[row] != u32::MAX {
                    rows.push(place[row]);
                    values.push(value);
                }
            }
            starts.push(rows.len());
        }
        Self {
            solver: bindings::cholmod_lower(&starts, &rows, &values),
        }
    }

    /// Finds the ordering and the structure of the factor.
    ///
    /// # Panics
    /// If CHOLMOD fails.
    pub fn analyze(&mut self) {
        self.solver.pin_mut().analyze().expect("CHOLMOD analyses");
    }

    /// Computes the numbers of the factor.
    ///
    /// # Panics
    /// If the matrix is not positive definite.
    pub fn factor(&mut self) {
        self.solver.pin_mut().factor().expect("CHOLMOD factors");
    }

    /// Writes the solutions of right-hand sides that stand one after another.
    ///
    /// # Panics
    /// If CHOLMOD fails.
    pub fn solve(&mut self, right_hand_sides: &[f64], solutions: &mut [f64]) {
        let solver = self.solver.pin_mut();
        solver
            .solve(right_hand_sides, solutions)
            .expect("CHOLMOD solves");
    }

    /// Returns how many values the factor stores, zeros of its blocks included.
    #[must_use]
    pub fn stored_values(&self) -> usize {
        self.solver.stored_values()
    }
}
