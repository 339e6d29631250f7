//! The least-squares system of a growing set of controls.
//!
//! Controls are added, and after every addition the solution is corrected through the factorisation
//! of an earlier set: what the new controls change are forces at themselves alone, found by
//! conjugate gradients on the small system of their compliances. A new factorisation is made once
//! the iterations since the last one have cost as much as it does.
//!
//! # Notation
//! Soft: `A = Lᵀ L + w² F` and `A x = w² F v`, with the diagonal indicator `F` of the controls.
//! Hard: `A = (Lᵀ L)_ZZ` on the other vertices `Z`, and `x_C = v_C`.
//! With `A` factored, the columns `E` of newer controls and `1 / w² = 0` for hard ones, the forces
//! `c` of `x = x_A + A⁻¹ E c` solve `(I / w² + Eᵀ A⁻¹ E) c = v_E - Eᵀ x_A`.

use std::sync::Arc;

use msplines_common::linalg::{Cholesky, FactorError, Mat, MatRef, Symbolic};

use crate::error::FitError;
use crate::options::Constraints;
use crate::space::Space;

/// Iterations that cost as much as a factorisation, on meshes of 10,000 to 100,000 vertices.
const ITERATIONS_PER_FACTOR: u32 = 10;

/// Iterations of one solve after which a new factorisation is cheaper.
const MAX_ITERATIONS: u32 = 4 * ITERATIONS_PER_FACTOR;

/// Compliance of a clamped plate of radius one edge, in the middle: `1 / 16 π` over the stiffness of
/// the graph Laplacian on equilateral triangles. It only scales unknowns.
const PLATE_COMPLIANCE: f64 = 0.28;

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
    /// Number of controls in the factorisation; the others have forces.
    factored: usize,
    forces: Mat<f64>,
    /// Edges from each vertex to the nearest factored control.
    hops: Vec<u32>,
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
            factored: 0,
            forces: Mat::new(),
            hops: Vec::new(),
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

    /// Improves the solution until its error at the newer controls has fallen by about `tolerance`.
    pub(crate) fn improve(&mut self, tolerance: f64) -> Result<(), FitError> {
        if self.factor.is_some() && self.iterations_since_factor < ITERATIONS_PER_FACTOR {
            self.adjust_forces(tolerance);
            return Ok(());
        }
        self.refactor()?;
        self.fix_hard_controls();
        if let Some(factor) = &self.factor {
            let correction = self.precondition(factor, self.residual().as_ref());
            self.solution += correction;
        }
        self.factored = self.controls.len();
        self.forces = Mat::zeros(0, self.data.ncols());
        self.hops = self.space.hops(&self.controls);
        Ok(())
    }

    /// Conjugate gradients for the forces, from the present ones and none at the newest controls.
    ///
    /// # Reference
    /// [Hestenes1952].
    fn adjust_forces(&mut self, tolerance: f64) {
        let Some(factor) = self.factor.take() else {
            return;
        };
        let newer: Vec<usize> = self.controls[self.factored..]
            .iter()
            .map(|&v| v as usize)
            .collect();
        let sides = self.data.ncols();
        self.forces.resize_with(newer.len(), sides, |_, _| 0.0);
        let own = match self.constraints {
            Constraints::Soft { weight } => 1.0 / (weight * weight),
            Constraints::Hard => 0.0,
        };
        let scale: Vec<f64> = newer
            .iter()
            .map(|&v| own + PLATE_COMPLIANCE * f64::from(self.hops[v]).powi(2))
            .collect();
        let mut residual = Mat::from_fn(newer.len(), sides, |k, side| {
            let at = (newer[k], side);
            self.data[at] - self.solution[at] - own * self.forces[(k, side)]
        });
        let scaled =
            |r: &Mat<f64>| Mat::from_fn(r.nrows(), sides, |k, side| r[(k, side)] / scale[k]);
        let mut direction = scaled(&residual);
        let mut energy = column_products(residual.as_ref(), direction.as_ref());
        let goal: Vec<f64> = energy.iter().map(|e| e * tolerance * tolerance).collect();
        for _ in 0..MAX_ITERATIONS {
            if energy.iter().zip(&goal).all(|(e, goal)| e <= goal) {
                break;
            }
            self.iterations_since_factor += 1;
            let mut moved = Mat::zeros(self.data.nrows(), sides);
            for (k, &vertex) in newer.iter().enumerate() {
                (0..sides).for_each(|side| moved[(vertex, side)] = direction[(k, side)]);
            }
            factor.solve_in_place(moved.as_mut());
            let image = Mat::from_fn(newer.len(), sides, |k, side| {
                moved[(newer[k], side)] + own * direction[(k, side)]
            });
            let curvature = column_products(direction.as_ref(), image.as_ref());
            let steps = ratios(&energy, &curvature);
            add_multiples(&mut self.forces, &steps, &direction);
            add_multiples(&mut self.solution, &steps, &moved);
            let back: Vec<f64> = steps.iter().map(|step| -step).collect();
            add_multiples(&mut residual, &back, &image);
            let mut next = scaled(&residual);
            let reduced = column_products(residual.as_ref(), next.as_ref());
            add_multiples(&mut next, &ratios(&reduced, &energy), &direction);
            direction = next;
            energy = reduced;
        }
        self.factor = Some(factor);
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
                    Some(factor) => factor.shared_symbolic(),
                    None => Arc::new(Symbolic::analyze(
                        self.space.normal(),
                        self.space.ordering(),
                    )),
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

/// Returns `a / b` of each column, or zero where it has converged to nothing.
fn ratios(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter()
        .zip(b)
        .map(|(a, b)| if *b > 0.0 { a / b } else { 0.0 })
        .collect()
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
