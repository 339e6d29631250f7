//! Exchange: knots come where they gain most, as many go where they cost least.

use super::state::{Precision, State};
use super::{Plan, Run};
use crate::FitError;

/// Exchange ends when fewer than this share of the knots would move.
const SMALLEST_SHARE: f64 = 0.004;

/// Exchange has converged when a round gains less than this share of the squared error.
const SMALLEST_GAIN: f64 = 0.002;

/// A round that gains more than this share is followed by another, of the same size, even beyond the
/// number of rounds that the plan has; up to this many times that number.
const LARGE_GAIN: f64 = 0.05;
const LONGEST: u32 = 4;

/// Exchanges knots, keeping the best set, and returns the rounds tried and kept.
pub(super) fn exchange(
    state: &mut State<'_>,
    plan: &Plan,
    run: &mut Run<'_, '_>,
) -> Result<[u32; 2], FitError> {
    let count = state.knots().len();
    let (mut share, mut tried, mut kept) = (plan.exchange, 0, 0);
    let mut rounds = plan.rounds;
    while tried < rounds && share >= SMALLEST_SHARE {
        if run.stop(
            u64::from(tried),
            u64::from(rounds),
            state.root_mean_square(),
        ) {
            break;
        }
        let inserted = state.most_wanted(((count as f64 * share) as usize).max(1));
        if inserted.is_empty() {
            break;
        }
        let saved = state.save();
        state.insert(&inserted, Precision::Rough)?;
        while state.knots().len() > count {
            let removed = state.cheapest(state.knots().len() - count);
            state.remove(&removed, Precision::Fair)?;
        }
        tried += 1;
        let gain = saved.error() - state.error();
        if gain > 0.0 {
            kept += 1;
            if gain > LARGE_GAIN * saved.error() {
                rounds = (rounds + 1).min(LONGEST * plan.rounds);
            } else if gain < SMALLEST_GAIN * saved.error() {
                share *= 0.5;
            } else {
                share *= plan.cooling;
            }
        } else {
            state.restore(saved)?;
            share *= 0.5;
        }
    }
    Ok([tried, kept])
}
