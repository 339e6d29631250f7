//! Splines with given knots, parametrised by their values at the knots.
//!
//! # Notation
//! `H` maps values at the knots to the spline at all vertices; `Hᵀ g = g_T - B_TZ B_ZZ⁻¹ g_Z`.
//!
//! # Reference
//! [Hou2017] Eq. (11). Deviation: the constraint `(B f)_Z = 0` is eliminated instead of enforced by
//! Lagrange multipliers, which leaves normal equations of condition below 100.

use std::cell::RefCell;
use std::sync::Arc;

use msplines_common::linalg::{
    CgReport, CgTolerance, Cholesky, FactorError, Mat, MatRef, Ordering, Symbolic, SymmetricMatrix,
    column, column_mut, conjugate_gradient,
};

use crate::gram::Gram;
use crate::target::Centred;
use crate::{Bilaplacian, FitError, Space};

/// From one knot in so many vertices on, a smaller factor is worth an analysis of its own.
const ANALYSED_ANEW: usize = 5;

/// The splines with one set of knots.
pub(crate) struct KnotValues<'a> {
    bilaplacian: &'a Bilaplacian,
    /// Knots, ascending.
    knots: Vec<u32>,
    factor: Arc<Cholesky>,
}

impl<'a> KnotValues<'a> {
    /// Factors `B_ZZ` for these knots, which must be ascending and at least one.
    pub(crate) fn factor(space: &'a Space, knots: Vec<u32>) -> Result<Self, FitError> {
        let bilaplacian = space.bilaplacian()?;
        let factor = Arc::new(factor(bilaplacian, &knots)?);
        Ok(Self {
            bilaplacian,
            knots,
            factor,
        })
    }

    /// Goes over to other knots, in the memory of the present factor where theirs is as large.
    pub(crate) fn change(&mut self, knots: Vec<u32>) -> Result<(), FactorError> {
        let Bilaplacian {
            matrix, symbolic, ..
        } = self.bilaplacian;
        let shared = Arc::ptr_eq(&self.factor.shared_symbolic(), symbolic);
        match Arc::get_mut(&mut self.factor) {
            Some(factor) if shared && !are_analysed_anew(&knots, matrix) => {
                let is_knot = marked(&knots, matrix.size());
                factor.refactor_kept(matrix, |row| !is_knot[row])?;
            }
            _ => self.factor = Arc::new(factor(self.bilaplacian, &knots)?),
        }
        self.knots = knots;
        Ok(())
    }

    /// Takes up a factor of these knots again.
    pub(crate) fn with_factor(
        space: &'a Space,
        knots: Vec<u32>,
        factor: Arc<Cholesky>,
    ) -> Result<Self, FitError> {
        Ok(Self {
            bilaplacian: space.bilaplacian()?,
            knots,
            factor,
        })
    }

    /// Returns the factor, to be taken up again.
    pub(crate) fn shared_factor(&self) -> Arc<Cholesky> {
        Arc::clone(&self.factor)
    }

    pub(crate) fn knots(&self) -> &[u32] {
        &self.knots
    }

    /// Returns an order in which to eliminate unknowns at the knots: that of the vertices.
    pub(crate) fn knot_ordering(&self) -> Ordering {
        let index = |vertex: &u32| self.knots.binary_search(vertex).ok();
        let order = self
            .bilaplacian
            .ordering
            .as_slice()
            .iter()
            .filter_map(index);
        Ordering::given(order.map(|k| k as u32).collect())
    }

    /// Returns `H p`, the spline (n × d) with these values at the knots.
    pub(crate) fn extend(&self, values: MatRef<'_, f64>) -> Mat<f64> {
        let mut f = self
            .bilaplacian
            .matrix
            .multiply_columns(&self.knots, values);
        f *= -1.0;
        self.factor.solve_in_place(f.as_mut());
        self.scatter(values, &mut f);
        f
    }

    /// Returns `B_ZZ⁻¹ g_Z` in the rows of `Z` and zero at the knots.
    pub(crate) fn solve_free(&self, mut g: Mat<f64>) -> Mat<f64> {
        self.factor.solve_in_place(g.as_mut());
        for side in 0..g.ncols() {
            self.knots
                .iter()
                .for_each(|&knot| g[(knot as usize, side)] = 0.0);
        }
        g
    }

    /// Returns `Hᵀ g`, one row per knot.
    pub(crate) fn restrict(&self, g: Mat<f64>) -> Mat<f64> {
        let mut restricted = self.gather(&g);
        let solved = self.solve_free(g);
        restricted -= self
            .bilaplacian
            .matrix
            .multiply_rows(&self.knots, solved.as_ref());
        restricted
    }

    /// Returns the rows of a function at the knots.
    pub(crate) fn gather(&self, f: &Mat<f64>) -> Mat<f64> {
        Mat::from_fn(self.knots.len(), f.ncols(), |k, side| {
            f[(self.knots[k] as usize, side)]
        })
    }

    /// Returns the Green's coefficients `(B f)_T` at the knots.
    pub(crate) fn coefficients(&self, f: &Mat<f64>) -> Mat<f64> {
        self.bilaplacian
            .matrix
            .multiply_rows(&self.knots, f.as_ref())
    }

    /// Returns the least-squares spline, found from the values of `start` at the knots on, and how.
    ///
    /// `gram` approximates `Hᵀ C² H`, with the weights `C` of the target. Iterations stop when the
    /// squared error exceeds its minimum by about the share `excess`.
    pub(crate) fn least_squares(
        &self,
        target: &Centred,
        start: &Mat<f64>,
        gram: &Gram,
        excess: f64,
        max_iterations: u32,
    ) -> (Mat<f64>, CgReport) {
        let mut f = self.extend(self.gather(start).as_ref());
        let mut residual = &target.data - &f;
        target.weigh(&mut residual);
        let energy = residual.squared_norm_l2() * excess / residual.ncols() as f64;
        target.weigh(&mut residual);
        let b = self.restrict(residual);
        let mut values = Mat::zeros(b.nrows(), b.ncols());
        let direction = RefCell::new(Mat::zeros(0, 0));
        let report = conjugate_gradient(
            |p| {
                let extended = self.extend(p);
                let mut image = extended.clone();
                direction.replace(extended);
                target.weigh_twice(&mut image);
                self.restrict(image)
            },
            |r| gram.solve(r),
            |steps| {
                let direction = direction.borrow();
                for (side, step) in steps.iter().enumerate() {
                    let target = column_mut(f.as_mut(), side).iter_mut();
                    let along = target.zip(column(direction.as_ref(), side));
                    along.for_each(|(value, way)| *value += step * way);
                }
            },
            b.as_ref(),
            &mut values,
            CgTolerance::Energy(energy),
            max_iterations,
        );
        (f, report)
    }

    fn scatter(&self, values: MatRef<'_, f64>, f: &mut Mat<f64>) {
        for side in 0..values.ncols() {
            for (k, &knot) in self.knots.iter().enumerate() {
                f[(knot as usize, side)] = values[(k, side)];
            }
        }
    }
}

fn factor(bilaplacian: &Bilaplacian, knots: &[u32]) -> Result<Cholesky, FactorError> {
    let Bilaplacian {
        matrix,
        ordering,
        symbolic,
    } = bilaplacian;
    let is_knot = marked(knots, matrix.size());
    if are_analysed_anew(knots, matrix) {
        let symbolic = Symbolic::analyze_kept(matrix, ordering, |row| !is_knot[row]);
        Cholesky::factor(symbolic, matrix)
    } else {
        Cholesky::factor_kept(Arc::clone(symbolic), matrix, |row| !is_knot[row])
    }
}

fn are_analysed_anew(knots: &[u32], matrix: &SymmetricMatrix) -> bool {
    knots.len() > matrix.size() / ANALYSED_ANEW
}

fn marked(knots: &[u32], vertices: usize) -> Vec<bool> {
    let mut is_knot = vec![false; vertices];
    knots.iter().for_each(|&knot| is_knot[knot as usize] = true);
    is_knot
}
