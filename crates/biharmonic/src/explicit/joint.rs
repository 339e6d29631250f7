//! The matrix `P` that makes all functions `ψ = H P` local at once.
//!
//! # Notation
//! `ψ_j = H p_j`, with `p_j` non-zero in the 2-ring `S_j` of knot `j`. Minimised is
//! `Σ_j [Σ_outside |ψ_j| + μ Σ_negative |ψ_j|] / Σ |ψ_j|`, the first sum over the vertices outside the
//! 2-ring of cells, the second where the function is negative, subject to `P 1 = 1` and to bounds, by
//! reweighted squares: a round minimises `Σ w ψ_j²` with `w = 1 / (|ψ_j| + δ)`, and takes that, the sums
//! `Σ |ψ_j|` and the signs from the round before. The first round minimises the squares themselves.
//!
//! One function alone can always be made more local by letting others grow; the rows of `P` are what
//! they compete for, hence the joint problem. The lower bound on the diagonal keeps `P` well
//! conditioned, and is raised at single knots where it does not; the negative part keeps functions from
//! oscillating.
//!
//! # Reference
//! [Hou2017] §3.1, §3.3; [Daubechies2010]. Deviation: functions are combined from the localised
//! `H e_k`, not from Green's functions by difference masks, which lose the partition of unity.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::SparseColumns;
use super::columns::LocalColumns;
use super::quadratic::{Block, minimise};
use crate::FitError;
use crate::rings::Rings;

/// Rings of knots that a function is combined from, and of cells that it should stay in. A third ring of
/// knots gains 6 to 9 % of the mass outside at twice the time and entries.
const STENCIL: u32 = 2;

/// Weight `μ` of the negative part. Twice as much takes 12 % off it and puts 6 % on the mass outside.
const NEGATIVE: f64 = 0.1;

/// What `δ` is, for functions whose largest value is about 1. 0.003 and 0.0003 leave the same within 3 %.
const SMALL_VALUE: f64 = 1e-3;

/// Bounds of entries off the diagonal. Without them single functions reach several times 1.
const OFF_DIAGONAL: [f64; 2] = [-0.1, 0.6];

/// Upper bound of the diagonal.
const LARGEST_DIAGONAL: f64 = 1.5;

/// By how much the diagonal is above its lower bound at the start.
const ROOM: f64 = 0.15;

/// Rounds. Two more take 3 % off the mass outside.
pub(super) const ROUNDS: u32 = 4;

/// By how much lower bounds are raised at once.
const RAISE: f64 = 0.1;

/// A knot is held if its part in the weakest combination is so large a share of the largest one; a
/// tenth does as well.
const LARGE_PART: f64 = 0.25;

/// Regularisation of a Hessian against its mean diagonal.
const REGULARISATION: f64 = 1e-7;

/// Share of the neighbours in what a round starts from.
pub(super) const NEIGHBOUR_SHARE: f64 = 0.35;

/// The least share of the neighbours that raised bounds leave.
const LEAST_SHARE: f64 = 0.05;

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

/// The rounds towards the optimal `P`.
pub(super) struct Joint<'a> {
    rings: &'a Rings,
    columns: &'a LocalColumns,
    /// The 2-ring of each knot.
    stencils: Vec<Vec<u32>>,
    /// The columns of `P`, in the rows of their stencils.
    values: Vec<Vec<f64>>,
    /// The share of the neighbours in the start, for each row; the diagonal is bounded accordingly.
    shares: Vec<f64>,
    rounds: u32,
    converged: bool,
}

impl<'a> Joint<'a> {
    pub(super) fn start(rings: &'a Rings, columns: &'a LocalColumns) -> Self {
        let count = rings.len();
        let mut joint = Self {
            rings,
            columns,
            stencils: (0..count).map(|j| rings.around(j, STENCIL)).collect(),
            values: Vec::new(),
            shares: vec![NEIGHBOUR_SHARE; count],
            rounds: 0,
            converged: true,
        };
        joint.values = (0..count).map(|j| joint.start_column(j)).collect();
        joint
    }

    /// Returns whether every round found its minimum; otherwise `P` is valid, but less than optimal.
    pub(super) fn converged(&self) -> bool {
        self.converged
    }

    /// Returns `P` as it is now.
    pub(super) fn matrix(&self) -> SparseColumns {
        let columns = self
            .stencils
            .iter()
            .cloned()
            .zip(self.values.iter().cloned());
        let mut matrix = SparseColumns::of_columns(self.stencils.len(), columns);
        matrix.normalise_rows();
        matrix
    }

    /// Minimises once.
    pub(super) fn round(&mut self) -> Result<(), FitError> {
        let count = self.stencils.len();
        let this = &*self;
        let blocks: Vec<Block> = (0..count).into_par_iter().map(|j| this.block(j)).collect();
        let minimum = minimise(count, &blocks)?;
        self.converged &= minimum.converged;
        self.values = minimum.unknowns;
        self.rounds += 1;
        Ok(())
    }

    /// Raises the lower bounds of the knots that have large parts in a combination of control points.
    pub(super) fn hold(&mut self, combination: &[f64]) {
        let largest = combination
            .iter()
            .fold(0.0, |most: f64, part| most.max(part.abs()));
        for (share, part) in self.shares.iter_mut().zip(combination) {
            if part.abs() > LARGE_PART * largest {
                *share = (*share - RAISE).max(LEAST_SHARE);
            }
        }
    }

    fn block(&self, j: usize) -> Block {
        let rows = self.stencils[j].clone();
        let bounds = |&row: &u32| {
            if row as usize == j {
                [1.0 - self.shares[j] - ROOM, LARGEST_DIAGONAL]
            } else {
                OFF_DIAGONAL
            }
        };
        let weigh = if self.rounds == 0 {
            Weigh::Squares
        } else {
            Weigh::Values
        };
        Block {
            hessian: hessian(self.rings, self.columns, &rows, &self.values[j], weigh),
            lower: rows.iter().map(|row| bounds(row)[0]).collect(),
            upper: rows.iter().map(|row| bounds(row)[1]).collect(),
            start: self.start_column(j),
            rows,
        }
    }

    fn start_column(&self, j: usize) -> Vec<f64> {
        let rows = self.stencils[j].iter();
        rows.map(|&row| neighbour_entry(self.rings, row as usize, j, self.shares[row as usize]))
            .collect()
    }
}

/// What is minimised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Weigh {
    Squares,
    Values,
}

/// Returns `H_Sᵀ diag(w) H_S`, regularised, over the mass of `ψ`, with `w = [outside] + μ [ψ < 0]` times
/// what makes squares of values.
fn hessian(
    rings: &Rings,
    columns: &LocalColumns,
    stencil: &[u32],
    values: &[f64],
    weigh: Weigh,
) -> Vec<f64> {
    let size = stencil.len();
    let mut hessian = vec![0.0; size * size];
    let mut mass = 0.0;
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
            let value = *weight;
            *weight = outside + if value < 0.0 { NEGATIVE } else { 0.0 };
            match weigh {
                Weigh::Squares => mass += value * value,
                Weigh::Values => {
                    mass += value.abs();
                    *weight /= value.abs() + SMALL_VALUE;
                }
            }
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
    for a in 0..size {
        for b in 0..=a {
            let regular = if a == b {
                REGULARISATION * trace / size as f64
            } else {
                0.0
            };
            let value = (hessian[a * size + b] + regular) / mass;
            hessian[a * size + b] = value;
            hessian[b * size + a] = value;
        }
    }
    hessian
}
