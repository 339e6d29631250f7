//! Difference masks: basis functions combined from Green's functions, as the paper has them.
//!
//! # Notation
//! `ψ_j = c_j + Σ_i n_ij φ_i`, the knots `i` in the 2- or 3-ring of knot `j`, with `Σ_i n_ij = 0` and
//! `c_j` the share of the vertices in the cell of `j`: that is the discrete Eq. (2), because here
//! `B φ_i = e_i - 1/n`. The masks minimise `Σ ψ_j²` outside the 2-ring of cells.
//!
//! They stand here to be measured. Each function comes out localised, but the masks are the moments
//! that cancel global functions: their smallest errors add up, and functions far apart do not sum to
//! one. Repairing the sum destroys the localisation.
//!
//! # Reference
//! [Hou2017] Eq. (3), Eq. (6), Eq. (8), §3.3, §7.2. Deviation: one least-squares problem per function
//! in place of the two stages of Hou et al. 2015, of which the paper uses "more neighbouring knots".

use faer::linalg::solvers::{Qr, SolveLstsq};
use msplines_common::linalg::{Mat, MatRef};

use super::SparseColumns;
use crate::rings::Rings;
use crate::{FitError, Space};

/// Rings of cells that a function should stay in.
const INSIDE: u8 = 2;

/// The masks `N`, the constants `c`, and the factor of `Ñ`, which is `N` with `cᵀ` below.
#[derive(Debug)]
pub(super) struct Masks {
    /// `n_ij` in row `i` of column `j`.
    pub(super) masks: SparseColumns,
    pub(super) constants: Vec<f64>,
    factor: Qr<f64>,
    /// What the last row of `Ñ` is multiplied by, so that it weighs as much as the others.
    scale: f64,
    condition: f64,
}

impl Masks {
    /// Solves for the masks from dense Green's functions: n × K numbers.
    pub(super) fn build(
        space: &Space,
        knots: &[u32],
        rings: &Rings,
        stencil: u32,
    ) -> Result<Self, FitError> {
        let vertices = space.mesh().vertex_count();
        let units = Mat::from_fn(vertices, knots.len(), |v, k| {
            f64::from(u8::from(v == knots[k] as usize))
        });
        let green = space.poisson()?.solve_biharmonic(units);
        let constants: Vec<f64> = (0..knots.len() as u32)
            .map(|cell| rings.members(cell).len() as f64 / vertices as f64)
            .collect();
        let columns = (0..knots.len()).map(|j| {
            let rows = rings.around(j, stencil);
            let values = mask(&green, rings, j, &rows, constants[j]);
            (rows, values)
        });
        let masks = SparseColumns::of_columns(knots.len(), columns);
        let mut augmented = masks.dense(0..knots.len());
        let scale = augmented.norm_l2() / (knots.len() as f64).sqrt();
        augmented.resize_with(knots.len() + 1, knots.len(), |_, j| scale * constants[j]);
        Ok(Self {
            condition: condition(&augmented),
            factor: augmented.qr(),
            masks,
            constants,
            scale,
        })
    }

    /// Returns the control points `λ` of `Ñ λ = (w, a)`.
    ///
    /// # Reference
    /// [Hou2017] Eq. (8).
    pub(super) fn control_points(
        &self,
        coefficients: MatRef<'_, f64>,
        constant: &[f64],
    ) -> Mat<f64> {
        let knots = coefficients.nrows();
        let right = Mat::from_fn(knots + 1, constant.len(), |i, c| {
            if i < knots {
                coefficients[(i, c)]
            } else {
                self.scale * constant[c]
            }
        });
        self.factor.solve_lstsq(right)
    }

    /// Returns the coefficients `w = N λ` and the constant `a = cᵀ λ`.
    pub(super) fn implicit(&self, control_points: MatRef<'_, f64>) -> (Mat<f64>, Vec<f64>) {
        let sums = (0..control_points.ncols()).map(|side| {
            let terms = self.constants.iter().enumerate();
            terms.map(|(j, c)| c * control_points[(j, side)]).sum()
        });
        (self.masks.multiply(control_points), sums.collect())
    }

    /// Returns the condition number of `Ñ`.
    pub(super) fn condition(&self) -> f64 {
        self.condition
    }
}

/// Returns the mask of one function, as differences from its own knot.
fn mask(
    green: &Mat<f64>,
    rings: &Rings,
    centre: usize,
    stencil: &[u32],
    constant: f64,
) -> Vec<f64> {
    let distance = rings.distances(centre, INSIDE + 1);
    let outside: Vec<usize> = (0..green.nrows())
        .filter(|&v| distance[rings.cell(v)] > INSIDE)
        .collect();
    let others: Vec<usize> = stencil
        .iter()
        .map(|&knot| knot as usize)
        .filter(|&knot| knot != centre)
        .collect();
    let mut mask = vec![0.0; stencil.len()];
    if others.is_empty() || outside.len() < others.len() {
        return mask; // everything is inside
    }
    let differences = Mat::from_fn(outside.len(), others.len(), |row, i| {
        green[(outside[row], others[i])] - green[(outside[row], centre)]
    });
    let right = Mat::from_fn(outside.len(), 1, |_, _| -constant);
    let found = differences.qr().solve_lstsq(right);
    let mut next = 0;
    let mut sum = 0.0;
    for (value, &knot) in mask.iter_mut().zip(stencil) {
        if knot as usize != centre {
            *value = found[(next, 0)];
            sum += *value;
            next += 1;
        }
    }
    let own = stencil.iter().position(|&knot| knot as usize == centre);
    if let Some(own) = own {
        mask[own] = -sum;
    }
    mask
}

/// Returns the ratio of the largest to the smallest singular value, infinite where there is none.
fn condition(matrix: &Mat<f64>) -> f64 {
    match matrix.singular_values() {
        Ok(values) => {
            let smallest = values.iter().copied().fold(f64::INFINITY, f64::min);
            values.iter().copied().fold(0.0, f64::max) / smallest
        }
        Err(_) => f64::INFINITY,
    }
}
