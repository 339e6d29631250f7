//! How many knots noisy data can bear: generalised cross-validation along a path of eliminations.
//!
//! # Notation
//! `σ²(K) = SSE / N`, `N` the weight of all vertices. The score is `σ²(K) / (1 - γ K / n)²`: plain
//! cross-validation has `γ = 1` for splines whose knots do not depend on the data. Knots that were
//! chosen by the data follow its noise, each of them as if it were more than one.

use super::state::{Precision, State};
use super::{Plan, Run, sample};
use crate::target::Centred;
use crate::{FitError, Options, Space};

/// What a chosen knot counts, as for adaptive regression splines; 2 follows the noise, 4 smooths
/// details away.
const KNOT_COST: f64 = 3.0;

/// The path starts at this share of the vertices; the score has its pole at `1 / KNOT_COST`.
const LARGEST_SHARE: f64 = 0.25;

/// The path ends once the score is this many times the smallest one.
const BEYOND_MINIMUM: f64 = 1.5;

/// Fewest knots on the path.
const FEWEST_KNOTS: usize = 4;

/// A number of knots and its score of cross-validation, in squared units of the data.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Trial {
    /// Number of knots.
    pub knots: usize,
    /// Its score; the smallest one is the best.
    pub score: f64,
}

/// Returns the scores along the path, from many knots to few. The smallest one tells how many to
/// take.
///
/// # Reference
/// [Hou2017] §9. Deviation: the paper mentions denoising as an application and gives no rule.
pub(super) fn cross_validate(
    space: &Space,
    target: &Centred,
    options: &Options,
    run: &mut Run<'_, '_>,
) -> Result<Vec<Trial>, FitError> {
    let counted = target.counted();
    let most = ((counted as f64 * LARGEST_SHARE) as usize).max(1);
    let start = sample::sample(space, target, most, most, options.seed);
    let mut state = State::start(space, target, start, options.seed)?;
    let share = Plan::of(options.effort).elimination[1];
    let mut trials: Vec<Trial> = Vec::new();
    let mut best = f64::INFINITY;
    loop {
        let knots = state.knots().len();
        let left = 1.0 - KNOT_COST * knots as f64 / counted as f64;
        if left > 0.0 {
            let score = state.error() / target.total_weight() / (left * left);
            best = best.min(score);
            trials.push(Trial { knots, score });
        }
        let beyond = trials
            .last()
            .is_some_and(|t| t.score > BEYOND_MINIMUM * best);
        let done = (most.saturating_sub(knots)) as u64;
        if beyond || knots <= FEWEST_KNOTS || run.stop(done, most as u64, state.root_mean_square())
        {
            break;
        }
        let limit = ((knots as f64 * share).ceil() as usize).min(knots - FEWEST_KNOTS);
        let removed = state.cheapest(limit);
        if removed.is_empty() {
            break;
        }
        state.remove(&removed, Precision::Fair)?;
    }
    Ok(trials)
}

/// Returns the number of knots of the smallest score, the fewest where several share it.
pub(super) fn best_count(trials: &[Trial], otherwise: usize) -> usize {
    let better = |a: &&Trial, b: &&Trial| a.score.total_cmp(&b.score).then(a.knots.cmp(&b.knots));
    trials.iter().min_by(better).map_or(otherwise, |t| t.knots)
}
