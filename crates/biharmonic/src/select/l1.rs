//! Choosing knots by the reweighted l1 norm of the coefficients, with the penalty as a path.
//!
//! Each round solves
//!
//! ```text
//! min  1/2 ‖S - f‖² + θ Σ_{i ∉ Z} ‖(B f)ᵢ‖₁ / (mᵢ + εᵢ),   (B f)_Z = 0,
//! ```
//!
//! with `mᵢ` the 1-norm of row `i` of the coefficients of the round before; rows that vanish join `Z`
//! for good. The components of the data share the weights and are else independent. `θ` rises from
//! round to round so that each leaves a given share of the knots. The round that would leave too few
//! is taken back; what the one before left too many goes by exact leave-one-out cost.
//!
//! # Notation
//! `θ` the penalty of one knot; `Z` the rows whose coefficients are zero, `T` all others.
//!
//! # Reference
//! [Hou2017] Alg. 2, Eq. (9), Eq. (10). Deviation: the penalised form, whose `θ` rises instead of a
//! bound that stays; exactly as many knots as asked for; a relative `ε`.

mod box_qp;
#[cfg(test)]
mod tests;

use msplines_common::linalg::{Mat, column};
use rayon::prelude::*;

use self::box_qp::{BoxQp, BoxSolution};
use super::Run;
use super::eliminate::eliminate;
use super::state::State;
use crate::target::Centred;
use crate::{FitError, Space};

/// Share of the vertices that are no candidates from the start, as in the paper.
const FIRST_ZEROS: f64 = 0.4;

/// `ε` of a row of norm 1, relative to the mean coefficient of the data scaled to rows of norm 1.
///
/// Zeros are constraints, not small numbers, so that all from 1e-5 to 1e-2 select alike; 1e-1 begins
/// to keep knots, and needs another penalty for the same number. Apart from `ε` and the first zeros,
/// scaling the rows of `B` would change nothing: the weights undo it.
const FLOOR: f64 = 1e-3;

/// Share of the knots that a round is meant to leave.
///
/// Means over four scans at 3 and 8 % of knots: 0.75 leaves 2 % more error in two thirds of the time,
/// 0.92 as much in half as much time again. A constant penalty, which leaves a sixth of the candidates
/// in its first round, left 6 % more on the one scan it was tried on.
const LEFT: f64 = 0.85;

/// The number of knots falls with the power `-1 / RATE` of the penalty: the squared error falls with
/// about the power -1.7 of the number of knots, and the penalty is its slope.
const RATE: f64 = 2.7;

/// The first penalty is so many times the squared error that the last knot to go would cost alone.
/// Thirty times less only adds rounds.
const FIRST_PENALTY: f64 = 30.0;

/// That cost is at least this share of the mean cost of the candidates: on flat parts it is zero.
const SMALLEST_COST: f64 = 1e-3;

/// Rounds in all. Five to twenty are taken.
const MAX_ROUNDS: u32 = 60;

/// Relative duality gap of a round: a hundred times less changes one knot in a thousand.
const GAP: f64 = 1e-4;

/// Largest share of the knots that one round of the final elimination removes.
const PRUNED: f64 = 0.1;

/// Knots and how they were found.
pub(super) struct L1Knots<'a> {
    /// The fit with as many knots as were asked for.
    pub(super) state: State<'a>,
    /// Rounds of reweighting, the one taken back included.
    pub(super) rounds: u32,
    /// Largest relative duality gap of a round; above 1e-4 if steps were used up.
    pub(super) gap: f64,
}

impl L1Knots<'_> {
    /// Returns what is to be said of a problem that was not solved as well as was asked.
    pub(super) fn warning(&self) -> Option<String> {
        let gap = self.gap;
        (gap > GAP).then(|| {
            format!("a problem of the l1 selection ran out of steps at a relative gap of {gap:.1e}")
        })
    }
}

/// Chooses `count` knots for `data`, at least one and fewer than there are vertices.
///
/// A round solves one problem per component, each with some eight factorisations of `B²`: all in all
/// 10 to 35 CPU seconds for 10,000 vertices, 4 CPU minutes for 35,000. A run that is stopped eliminates the rest.
pub(super) fn reweighted_l1<'a>(
    space: &'a Space,
    target: &'a Centred,
    count: usize,
    seed: u64,
    run: &mut Run<'_, '_>,
) -> Result<L1Knots<'a>, FitError> {
    if target.weights.is_some() {
        return Err(FitError::WeightsWithL1);
    }
    let problem = Problem::build(space, &target.data)?;
    let path = descend(&problem, count, run)?;
    let mut state = State::start(space, target, path.support.knots, seed)?;
    eliminate(&mut state, count, [PRUNED; 2], run)?;
    Ok(L1Knots {
        state,
        rounds: path.rounds,
        gap: path.gap,
    })
}

/// Follows the path down to the last support of at least `count` knots.
fn descend(problem: &Problem<'_>, count: usize, run: &mut Run<'_, '_>) -> Result<Path, FitError> {
    let vertices = problem.data.nrows();
    let (support, mut penalty) = problem.start(count);
    let mut path = Path {
        support,
        rounds: 0,
        gap: 0.0,
    };
    // Constant data has no penalty, and no order of knots either.
    while penalty > 0.0 && path.support.knots.len() > count && path.rounds < MAX_ROUNDS {
        let done = (vertices - path.support.knots.len()) as u64;
        let error = path.support.root_mean_square;
        if run.stop(done, (vertices - count) as u64, error) {
            break;
        }
        let next = problem.solve(&path.support, penalty)?;
        path.rounds += 1;
        path.gap = path.gap.max(next.gap);
        let left = next.knots.len();
        if left < count {
            break;
        }
        let wanted = (left as f64 * LEFT).max(count as f64);
        penalty *= (left as f64 / wanted).powf(RATE);
        path.support = next;
    }
    Ok(path)
}

/// Where the path ends.
struct Path {
    support: Support,
    rounds: u32,
    /// Largest gap of its rounds.
    gap: f64,
}

/// What all rounds share.
struct Problem<'a> {
    qp: BoxQp<'a>,
    data: &'a Mat<f64>,
    /// Coefficients of the data.
    coefficients: Mat<f64>,
    /// Euclidean norms of the rows of `B`.
    row_norms: Vec<f64>,
    /// `ε` of each row.
    floors: Vec<f64>,
}

/// Knots that are left, and the weights of the next round.
struct Support {
    /// Rows outside of `Z`, ascending.
    knots: Vec<u32>,
    /// 1-norms of all rows of the coefficients.
    magnitudes: Vec<f64>,
    /// Of the residual at the vertices.
    root_mean_square: f64,
    /// Largest relative duality gap of the components.
    gap: f64,
}

impl<'a> Problem<'a> {
    fn build(space: &'a Space, data: &'a Mat<f64>) -> Result<Self, FitError> {
        let bilaplacian = &space.bilaplacian()?.matrix;
        let row_norms: Vec<f64> = (0..data.nrows())
            .map(|row| {
                let squares = bilaplacian.column(row).map(|(_, value)| value * value);
                squares.sum::<f64>().sqrt()
            })
            .collect();
        let coefficients = space.coefficients(data);
        let relative = one_norms(&coefficients).into_iter().zip(&row_norms);
        let mean = relative.map(|(m, norm)| m / norm).sum::<f64>() / data.nrows() as f64;
        let floors = row_norms.iter().map(|norm| FLOOR * mean * norm).collect();
        Ok(Self {
            qp: BoxQp::build(space)?,
            data,
            coefficients,
            row_norms,
            floors,
        })
    }

    /// Returns all candidates and the first penalty.
    ///
    /// Candidates are the vertices that cost most when they alone are no knots: exactly
    /// `‖(B S)ᵢ‖² / ‖Bᵢ‖²`, with the row of `B` below.
    fn start(&self, count: usize) -> (Support, f64) {
        let vertices = self.data.nrows();
        let cost = |row: usize| {
            let squares = (0..self.data.ncols()).map(|c| self.coefficients[(row, c)].powi(2));
            squares.sum::<f64>() / self.row_norms[row].powi(2)
        };
        let mut order: Vec<(f64, u32)> = (0..vertices).map(|v| (cost(v), v as u32)).collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let zeros = (vertices as f64 * FIRST_ZEROS) as usize;
        order.truncate((vertices - zeros).max(count));
        let last = ((order.len() as f64 * LEFT) as usize).max(count) - 1;
        let mean = order.iter().map(|candidate| candidate.0).sum::<f64>() / order.len() as f64;
        let penalty = FIRST_PENALTY * order[last].0.max(SMALLEST_COST * mean);
        let mut knots: Vec<u32> = order.iter().map(|candidate| candidate.1).collect();
        knots.sort_unstable();
        let support = Support {
            knots,
            magnitudes: one_norms(&self.coefficients),
            root_mean_square: 0.0,
            gap: 0.0,
        };
        (support, penalty)
    }

    /// Returns `θ / (mᵢ + εᵢ)`, infinite in `Z`.
    fn bounds(&self, present: &Support, penalty: f64) -> Vec<f64> {
        let mut bounds = vec![f64::INFINITY; self.data.nrows()];
        for &knot in &present.knots {
            let row = knot as usize;
            bounds[row] = penalty / (present.magnitudes[row] + self.floors[row]);
        }
        bounds
    }

    /// Solves one round.
    fn solve(&self, present: &Support, penalty: f64) -> Result<Support, FitError> {
        let bounds = self.bounds(present, penalty);
        let solutions: Vec<Result<BoxSolution, FitError>> = (0..self.data.ncols())
            .into_par_iter()
            .map(|c| self.qp.solve(column(self.data.as_ref(), c), &bounds, GAP))
            .collect();
        let solutions: Vec<BoxSolution> = solutions.into_iter().collect::<Result<_, _>>()?;
        let mut knots = present.knots.clone();
        knots.retain(|&knot| {
            let row = knot as usize;
            solutions
                .iter()
                .any(|solution| solution.is_active(row, bounds[row], penalty))
        });
        let magnitude = |row: usize| solutions.iter().map(|s| s.coefficients[row].abs()).sum();
        let squares: f64 = solutions.iter().map(|s| s.squared_distance).sum();
        Ok(Support {
            knots,
            magnitudes: (0..self.data.nrows()).map(magnitude).collect(),
            gap: solutions.iter().map(|s| s.gap).fold(0.0, f64::max),
            root_mean_square: (squares / self.data.nrows() as f64).sqrt(),
        })
    }
}

/// Returns the sums of the absolute values of the rows.
fn one_norms(matrix: &Mat<f64>) -> Vec<f64> {
    (0..matrix.nrows())
        .map(|row| (0..matrix.ncols()).map(|c| matrix[(row, c)].abs()).sum())
        .collect()
}
