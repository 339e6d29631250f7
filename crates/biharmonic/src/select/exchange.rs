//! Exchange: knots come where they gain most, as many go where they cost least.

use super::state::{Precision, State};
use super::{Plan, Run};
use crate::FitError;

/// Exchange ends when fewer than this share of the knots would move.
const SMALLEST_SHARE: f64 = 0.004;

/// Exchange has converged when a round gains less than this share of the squared error.
const SMALLEST_GAIN: f64 = 0.002;

/// Exchanges knots, keeping the best set, and returns the rounds tried and kept.
pub(super) fn exchange(
    state: &mut State<'_>,
    plan: &Plan,
    run: &mut Run<'_, '_>,
) -> Result<[u32; 2], FitError> {
    let count = state.knots().len();
    let (mut share, mut tried, mut kept) = (plan.exchange, 0, 0);
    while tried < plan.rounds && share >= SMALLEST_SHARE {
        if run.stop(
            u64::from(tried),
            u64::from(plan.rounds),
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
            let small = gain < SMALLEST_GAIN * saved.error();
            kept += 1;
            share *= if small { 0.5 } else { plan.cooling };
        } else {
            state.restore(saved)?;
            share *= 0.5;
        }
    }
    Ok([tried, kept])
}
