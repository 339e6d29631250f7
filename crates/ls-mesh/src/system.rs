//! The least-squares system of a growing set of controls.
//!
//! Controls are added, and after every addition the solution is improved from the last one by
//! conjugate gradients, preconditioned by the factorisation of an earlier set: the controls since
//! then are a positive diagonal of low rank, so that few iterations suffice. A new factorisation is
//! made once the iterations since the last one have cost as much as it does.
//!
//! # Notation
//! Soft: `(Lᵀ L + w² F) x = w² F v`, with the diagonal indicator `F` of the controls.
//! Hard: `(Lᵀ L)_ZZ x_Z = -(Lᵀ L)_ZC v_C` on the other vertices `Z`, and `x_C = v_C`.

use msplines_common::linalg::{Cholesky, FactorError, Mat, MatRef, Symbolic};

use crate::error::FitError;
use crate::options::Constraints;
use crate::space::Space;

/// Iterations that cost as much as a factorisation, on meshes of 10,000 to 100,000 vertices.
const ITERATIONS_PER_FACTOR: u32 = 7;

/// Iterations of one solve after which a new factorisation is cheaper.
const MAX_ITERATIONS: u32 = 4 * ITERATIONS_PER_FACTOR;

/// Refinement steps of the final solve. Two reach rounding unless the system is close to singular.
const REFINEMENTS: u32 = 4;

/// The system and its present solution, one column per component.
pub(crate) struct System<'a> {
    space: &'a Space,
    constraints: Constraints,
    data: Mat<f64>,
    solution: Mat<f64>,
    controls: Vec<u32>,
    is_control: Vec<bool>,
    factor: Option<Cholesky>,
    iterations_since_factor: u32,
}

impl<'a> System<'a> {
    /// Starts without controls, from a `solution` that the Laplacian maps to zero.
    pub(crate) fn new(
        space: &'a Space,
        constraints: Constraints,
        data: Mat<f64>,
        solution: Mat<f64>,
    ) -> Self {
        Self {
            space,
            constraints,
            data,
            solution,
            controls: Vec::new(),
            is_control: vec![false; space.size()],
            factor: None,
            iterations_since_factor: 0,
        }
    }

    pub(crate) fn space(&self) -> &'a Space {
        self.space
    }

    pub(crate) fn controls(&self) -> &[u32] {
        &self.controls
    }

    pub(crate) fn is_control(&self, vertex: usize) -> bool {
        self.is_control[vertex]
    }

    pub(crate) fn solution(&self) -> MatRef<'_, f64> {
        self.solution.as_ref()
    }

    /// Returns the squared distance of the present solution from the data at every vertex.
    pub(crate) fn squared_errors(&self) -> Vec<f64> {
        let square = |vertex: usize, side: usize| {
            (self.solution[(vertex, side)] - self.data[(vertex, side)]).powi(2)
        };
        let sides = self.data.ncols();
        (0..self.data.nrows())
            .map(|v| (0..sides).map(|side| square(v, side)).sum())
            .collect()
    }

    /// Adds controls; the solution is then due for [`Self::improve`] or [`Self::solve`].
    pub(crate) fn add(&mut self, controls: &[u32]) {
        for &control in controls {
            self.is_control[control as usize] = true;
        }
        self.controls.extend_from_slice(controls);
        self.fix_hard_controls();
    }

    fn fix_hard_controls(&mut self) {
        if self.constraints == Constraints::Hard {
            for &control in &self.controls {
                for side in 0..self.data.ncols() {
                    self.solution[(control as usize, side)] = self.data[(control as usize, side)];
                }
            }
        }
    }

    /// Improves the solution until the energy norm of its error has fallen by about `tolerance`.
    pub(crate) fn improve(&mut self, tolerance: f64) -> Result<(), FitError> {
        let stale = self.factor.is_some() && self.iterations_since_factor < ITERATIONS_PER_FACTOR;
        if !stale {
            self.refactor()?;
        }
        let Some(factor) = self.factor.take() else {
            return Ok(());
        };
        let mut residual = self.residual();
        if stale {
            self.descend(&factor, &mut residual, tolerance);
        } else {
            self.solution += self.precondition(&factor, residual.as_ref());
        }
        self.factor = Some(factor);
        Ok(())
    }

    /// Conjugate gradients from the present solution, all columns side by side.
    ///
    /// # Reference
    /// [Hestenes1952].
    fn descend(&mut self, factor: &Cholesky, residual: &mut Mat<f64>, tolerance: f64) {
        let mut direction = self.precondition(factor, residual.as_ref());
        let mut energy = column_products(residual.as_ref(), direction.as_ref());
        let goal: Vec<f64> = energy.iter().map(|e| e * tolerance * tolerance).collect();
        for _ in 0..MAX_ITERATIONS {
            self.iterations_since_factor += 1;
            let image = self.product(direction.as_ref());
            let curvature = column_products(direction.as_ref(), image.as_ref());
            let steps: Vec<f64> = energy
                .iter()
                .zip(&curvature)
                .map(|(e, c)| ratio(*e, *c))
                .collect();
            add_multiples(&mut self.solution, &steps, &direction);
            let back: Vec<f64> = steps.iter().map(|step| -step).collect();
            add_multiples(residual, &back, &image);
            let mut next = self.precondition(factor, residual.as_ref());
            let reduced = column_products(residual.as_ref(), next.as_ref());
            if reduced.iter().zip(&goal).all(|(e, goal)| e <= goal) {
                return;
            }
            let ratios: Vec<f64> = reduced
                .iter()
                .zip(&energy)
                .map(|(r, e)| ratio(*r, *e))
                .collect();
            add_multiples(&mut next, &ratios, &direction);
            direction = next;
            energy = reduced;
        }
    }

    /// Solves for the present controls by factorisation and refinement, from nothing else.
    ///
    /// Returns the largest change of the last refinement step.
    pub(crate) fn solve(&mut self) -> Result<f64, FitError> {
        self.solution.fill(0.0);
        self.fix_hard_controls();
        self.refactor()?;
        let Some(factor) = self.factor.take() else {
            return Ok(0.0);
        };
        let mut change = f64::INFINITY;
        for step in 0..=REFINEMENTS {
            let correction = self.precondition(&factor, self.residual().as_ref());
            let size = largest(correction.as_ref());
            // Steps that no longer shrink are rounding.
            if step > 0 && size >= 0.5 * change {
                break;
            }
            self.solution += correction;
            change = size;
            if size == 0.0 {
                break;
            }
        }
        self.factor = Some(factor);
        Ok(change)
    }

    /// Factors the system of the present controls; leaves nothing where all vertices are fixed.
    fn refactor(&mut self) -> Result<(), FactorError> {
        let last = self.factor.take();
        self.iterations_since_factor = 0;
        self.factor = match self.constraints {
            Constraints::Hard if self.controls.len() == self.data.nrows() => None,
            Constraints::Hard => {
                let keep = |row: usize| !self.is_control[row];
                let symbolic =
                    Symbolic::analyze_kept(self.space.normal(), self.space.ordering(), keep);
                Some(Cholesky::factor(symbolic, self.space.normal())?)
            }
            Constraints::Soft { weight } => {
                let shift = |&control: &bool| if control { weight * weight } else { 0.0 };
                let shift: Vec<f64> = self.is_control.iter().map(shift).collect();
                let matrix = self.space.normal().plus_diagonal(&shift);
                let symbolic = match last {
                    Some(factor) => factor.into_symbolic(),
                    None => Symbolic::analyze(self.space.normal(), self.space.ordering()),
                };
                Some(Cholesky::factor(symbolic, &matrix)?)
            }
        };
        Ok(())
    }

    /// Returns the right-hand side minus the matrix times the solution.
    fn residual(&self) -> Mat<f64> {
        let mut residual = -self.space.normal_product(self.solution.as_ref());
        for &control in &self.controls {
            let control = control as usize;
            for side in 0..residual.ncols() {
                let gap = self.data[(control, side)] - self.solution[(control, side)];
                match self.constraints {
                    Constraints::Soft { weight } => {
                        residual[(control, side)] += weight * weight * gap;
                    }
                    Constraints::Hard => residual[(control, side)] = 0.0,
                }
            }
        }
        residual
    }

    /// Returns the matrix times `x`, which is zero at hard controls.
    fn product(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        let mut product = self.space.normal_product(x);
        for &control in &self.controls {
            let control = control as usize;
            for side in 0..product.ncols() {
                match self.constraints {
                    Constraints::Soft { weight } => {
                        product[(control, side)] += weight * weight * x[(control, side)];
                    }
                    Constraints::Hard => product[(control, side)] = 0.0,
                }
            }
        }
        product
    }

    fn precondition(&self, factor: &Cholesky, residual: MatRef<'_, f64>) -> Mat<f64> {
        let mut x = residual.to_owned();
        factor.solve_in_place(x.as_mut());
        if self.constraints == Constraints::Hard {
            for &control in &self.controls {
                for side in 0..x.ncols() {
                    x[(control as usize, side)] = 0.0;
                }
            }
        }
        x
    }
}

/// Returns `a / b`, or zero where the column has converged to nothing.
fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 0.0 }
}

fn column_products(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Vec<f64> {
    let columns = a.col_iter().zip(b.col_iter());
    columns
        .map(|(a, b)| a.iter().zip(b.iter()).map(|(a, b)| a * b).sum())
        .collect()
}

fn add_multiples(x: &mut Mat<f64>, factors: &[f64], y: &Mat<f64>) {
    for (side, factor) in factors.iter().enumerate() {
        x.col_mut(side)
            .iter_mut()
            .zip(y.col(side).iter())
            .for_each(|(x, y)| *x += factor * y);
    }
}

fn largest(x: MatRef<'_, f64>) -> f64 {
    x.col_iter()
        .map(|column| column.iter().fold(0.0, |m: f64, v| m.max(v.abs())))
        .fold(0.0, f64::max)
}
