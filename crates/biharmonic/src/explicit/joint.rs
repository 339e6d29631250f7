//! The matrix `P` that makes all functions `ψ = H P` local at once.
//!
//! # Notation
//! `ψ_j = H p_j`, with `p_j` non-zero in the 2-ring `S_j` of knot `j`. Minimised is
//! `Σ_j [Σ_outside ψ_j² + μ Σ_negative ψ_j²] / |ψ_j|²`, the first sum over the vertices outside the
//! 2-ring of cells, the second where the function is negative, subject to `P 1 = 1` and to bounds. The
//! norms and the sets of the second sum are those of the round before.
//!
//! One function alone can always be made more local by letting others grow; the rows of `P` are what
//! they compete for, hence the joint problem. The lower bound on the diagonal keeps `P` well
//! conditioned, the negative part keeps functions from oscillating.
//!
//! # Reference
//! [Hou2017] §3.1, §3.3. Deviation: functions are combined from the localised `H e_k`, not from Green's
//! functions by difference masks, which lose the partition of unity.

use std::collections::BTreeSet;
use std::ops::ControlFlow;

use rayon::prelude::*;

use super::SparseColumns;
use super::columns::LocalColumns;
use super::quadratic::{Block, minimise};
use crate::FitError;
use crate::rings::Rings;

/// Rings of knots that a function is combined from, and of cells that it should stay in. A third ring of
/// knots gains 8 % of the mass outside at twice the time and entries.
const STENCIL: u32 = 2;

/// Weight `μ` of the negative part: a fifth of the negativity at no loss; 1 costs condition.
const NEGATIVE: f64 = 0.1;

/// Bounds of entries off the diagonal. Without them single functions reach several times 1.
const OFF_DIAGONAL: [f64; 2] = [-0.1, 0.6];

/// Upper bound of the diagonal.
const LARGEST_DIAGONAL: f64 = 1.5;

/// Rounds. Two more take 4 % off the mass outside and make the condition half as large again.
const ROUNDS: u32 = 3;

/// Regularisation of a Hessian against its mean diagonal.
const REGULARISATION: f64 = 1e-7;

/// Share of the neighbours in what the first round starts from.
pub(super) const NEIGHBOUR_SHARE: f64 = 0.35;

/// Returns `P = (1 - β) I + β N` with `N` the knot adjacency, its rows divided by their sums.
pub(super) fn neighbour_matrix(rings: &Rings, share: f64) -> SparseColumns {
    let columns = (0..rings.len()).map(|j| {
        let rows = rings.around(j, 1);
        let values = rows
            .iter()
            .map(|&row| neighbour_entry(rings, row as usize, j, share));
        (rows.clone(), values.collect())
    });
    SparseColumns::of_columns(rings.len(), columns)
}

fn neighbour_entry(rings: &Rings, row: usize, column: usize, share: f64) -> f64 {
    let around = rings.neighbours(row);
    if around.is_empty() {
        return 1.0; // the only knot there is
    }
    if row == column {
        1.0 - share
    } else if around.binary_search(&(column as u32)).is_ok() {
        share / around.len() as f64
    } else {
        0.0
    }
}

/// A jointly optimal `P`.
pub(super) struct Joint {
    pub(super) matrix: SparseColumns,
    /// Whether every round found its minimum; otherwise the matrix is valid, but less than optimal.
    pub(super) converged: bool,
}

/// Returns the jointly optimal `P` with a diagonal of at least `diagonal`.
///
/// None if `progress`, which is asked before each round, breaks.
pub(super) fn joint_matrix(
    rings: &Rings,
    columns: &LocalColumns,
    diagonal: f64,
    mut progress: impl FnMut(u32) -> ControlFlow<()>,
) -> Result<Option<Joint>, FitError> {
    let count = rings.len();
    let stencils: Vec<Vec<u32>> = (0..count).map(|j| rings.around(j, STENCIL)).collect();
    let start = |j: usize| -> Vec<f64> {
        let rows = stencils[j].iter();
        rows.map(|&row| neighbour_entry(rings, row as usize, j, NEIGHBOUR_SHARE))
            .collect()
    };
    let mut values: Vec<Vec<f64>> = (0..count).map(start).collect();
    let mut converged = true;
    for round in 0..ROUNDS {
        if progress(round).is_break() {
            return Ok(None);
        }
        let blocks: Vec<Block> = (0..count)
            .into_par_iter()
            .map(|j| {
                let rows = stencils[j].clone();
                let own = |&row: &u32| row as usize == j;
                let lower = |row| if own(row) { diagonal } else { OFF_DIAGONAL[0] };
                let upper = |row| {
                    if own(row) {
                        LARGEST_DIAGONAL
                    } else {
                        OFF_DIAGONAL[1]
                    }
                };
                Block {
                    hessian: hessian(rings, columns, j, &rows, &values[j]),
                    lower: rows.iter().map(lower).collect(),
                    upper: rows.iter().map(upper).collect(),
                    start: start(j),
                    rows,
                }
            })
            .collect();
        let minimum = minimise(count, &blocks)?;
        converged &= minimum.converged;
        values = minimum.unknowns;
    }
    let mut matrix = SparseColumns::of_columns(count, stencils.into_iter().zip(values));
    matrix.normalise_rows();
    Ok(Some(Joint { matrix, converged }))
}

/// Returns `H_Sᵀ diag(w) H_S / |ψ|²`, regularised, with `w = [outside] + μ [ψ < 0]`.
fn hessian(
    rings: &Rings,
    columns: &LocalColumns,
    centre: usize,
    stencil: &[u32],
    values: &[f64],
) -> Vec<f64> {
    let size = stencil.len();
    let mut hessian = vec![0.0; size * size];
    let mut norm = 0.0;
    let cells: BTreeSet<u32> = stencil
        .iter()
        .flat_map(|&knot| columns.cells(knot).iter().copied())
        .collect();
    let mut scaled = Vec::new();
    for cell in cells {
        let present: Vec<(usize, &[f64])> = stencil
            .iter()
            .enumerate()
            .filter_map(|(a, &knot)| Some((a, columns.within(knot, cell)?)))
            .collect();
        // The stencil's knots are those of the cells that the function should stay in.
        let outside = f64::from(u8::from(stencil.binary_search(&cell).is_err()));
        let mut weights = vec![0.0; rings.members(cell).len()];
        for &(a, column) in &present {
            weights
                .iter_mut()
                .zip(column)
                .for_each(|(w, h)| *w += values[a] * h);
        }
        for weight in &mut weights {
            norm += *weight * *weight;
            *weight = outside + if *weight < 0.0 { NEGATIVE } else { 0.0 };
        }
        if weights.iter().all(|&w| w == 0.0) {
            continue;
        }
        for (i, &(a, one)) in present.iter().enumerate() {
            scaled.clear();
            scaled.extend(one.iter().zip(&weights).map(|(h, w)| h * w));
            for &(b, other) in &present[..=i] {
                let product: f64 = scaled.iter().zip(other).map(|(s, h)| s * h).sum();
                hessian[a * size + b] += product;
            }
        }
    }
    let trace: f64 = (0..size).map(|a| hessian[a * size + a]).sum();
    debug_assert_eq!(stencil.binary_search(&(centre as u32)).map(|_| ()), Ok(()));
    for a in 0..size {
        for b in 0..=a {
            let regular = if a == b {
                REGULARISATION * trace / size as f64
            } else {
                0.0
            };
            let value = (hessian[a * size + b] + regular) / norm;
            hessian[a * size + b] = value;
            hessian[b * size + a] = value;
        }
    }
    hessian
}
