//! CHOLMOD, and Eigen's simplicial factorisation, behind the interface that the timing needs.

use std::fs;

use msplines_common::linalg::SymmetricMatrix;

use crate::bindings;

/// Returns the name of the BLAS that is loaded into this process, which CHOLMOD's times depend on.
#[must_use]
pub fn blas() -> String {
    let maps = fs::read_to_string("/proc/self/maps").unwrap_or_default();
    let found = maps.lines().filter_map(|line| line.rsplit('/').next());
    let mut names: Vec<_> = found.filter(|name| name.contains("blas")).collect();
    names.sort_unstable();
    names.dedup();
    if names.is_empty() {
        "BLAS unknown".to_owned()
    } else {
        names.join(", ")
    }
}

/// In which order CHOLMOD eliminates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EliminationOrder {
    /// Nested dissection.
    Metis,
    /// Approximate minimum degree: sooner found, with larger factors.
    Amd,
}

/// Supernodal Cholesky factorisation by CHOLMOD.
pub struct Cholmod {
    solver: cxx::UniquePtr<bindings::Cholmod>,
}

impl Cholmod {
    /// Returns a solver for the principal submatrix of the rows for which `keep` holds, their
    /// order kept, that orders with METIS.
    ///
    /// # Panics
    /// If CHOLMOD has no memory.
    #[must_use]
    pub fn of(matrix: &SymmetricMatrix, keep: impl Fn(usize) -> bool) -> Self {
        Self::new(&Lower::of(matrix, keep), EliminationOrder::Metis)
    }

    /// Returns a solver for a matrix that eliminates in this order.
    ///
    /// # Panics
    /// If CHOLMOD has no memory.
    #[must_use]
    pub fn new(matrix: &Lower, order: EliminationOrder) -> Self {
        let Lower {
            starts,
            rows,
            values,
        } = matrix;
        let metis = order == EliminationOrder::Metis;
        Self {
            solver: bindings::cholmod_lower(starts, rows, values, metis),
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

/// The lower triangle of a symmetric matrix in compressed columns.
#[derive(Clone, Debug)]
pub struct Lower {
    starts: Vec<usize>,
    rows: Vec<u32>,
    values: Vec<f64>,
}

impl Lower {
    /// Returns the principal submatrix of the rows for which `keep` holds, their order kept.
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
            starts,
            rows,
            values,
        }
    }
}

/// Eigen's `SimplicialLDLT` in the order of AMD, its own choice.
pub struct Ldlt {
    solver: cxx::UniquePtr<bindings::Ldlt>,
}

impl Ldlt {
    /// Returns a solver for a matrix.
    #[must_use]
    pub fn new(matrix: &Lower) -> Self {
        Self {
            solver: bindings::eigen_lower(&matrix.starts, &matrix.rows, &matrix.values),
        }
    }

    /// Finds the ordering and the structure of the factor.
    pub fn analyze(&mut self) {
        self.solver.pin_mut().analyze();
    }

    /// Computes the numbers of the factor.
    ///
    /// # Panics
    /// If a pivot is zero.
    pub fn factor(&mut self) {
        self.solver.pin_mut().factor().expect("Eigen factors");
    }

    /// Writes the solutions of right-hand sides that stand one after another.
    pub fn solve(&self, right_hand_sides: &[f64], solutions: &mut [f64]) {
        self.solver.solve(right_hand_sides, solutions);
    }
}
