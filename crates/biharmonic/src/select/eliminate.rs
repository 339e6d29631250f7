//! Backward elimination: rounds of removing the cheapest knots, no two of them neighbours.

use super::Run;
use super::state::State;
use crate::FitError;

/// Removes knots until `count` are left, or the run is stopped, and returns the rounds this took.
///
/// A stopped run still removes, all that is left to remove at once as far as neighbours allow.
pub(super) fn eliminate(
    state: &mut State<'_>,
    count: usize,
    share: f64,
    run: &mut Run<'_, '_>,
) -> Result<u32, FitError> {
    let start = state.knots().len();
    let mut rounds = 0;
    while state.knots().len() > count {
        let present = state.knots().len();
        let stopped = run.stop(
            (start - present) as u64,
            (start - count) as u64,
            state.root_mean_square(),
        );
        let share = if stopped { 1.0 } else { share };
        let limit = ((present as f64 * share).ceil() as usize).min(present - count);
        let removed = state.cheapest(limit);
        *state = state.moved(&removed, &[])?;
        rounds += 1;
    }
    Ok(rounds)
}
