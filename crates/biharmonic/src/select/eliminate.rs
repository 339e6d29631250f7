//! Backward elimination: rounds of removing the cheapest knots, no two of them neighbours.
//!
//! A round takes a smaller share of the knots than the one before: while there are many candidates,
//! a good share of them does not matter, and the last ones are chosen with care.

use super::Run;
use super::state::{Precision, State};
use crate::FitError;

/// A round that would leave less than this share of what it removes takes it along.
const REMAINDER: f64 = 0.3;

/// Removes knots until `count` are left, or the run is stopped, and returns the rounds this took.
///
/// The share of the knots that a round removes goes from the first to the second of `shares`, linearly
/// in the number of knots. A stopped run still removes, all that is left to remove at once as far as
/// neighbours allow.
pub(super) fn eliminate(
    state: &mut State<'_>,
    count: usize,
    shares: [f64; 2],
    run: &mut Run<'_, '_>,
) -> Result<u32, FitError> {
    let start = state.knots().len();
    let mut rounds = 0;
    while state.knots().len() > count {
        let present = state.knots().len();
        let (left, total) = (present - count, start - count);
        let stopped = run.stop(
            (start - present) as u64,
            total as u64,
            state.root_mean_square(),
        );
        let share = shares[1] + (shares[0] - shares[1]) * left as f64 / total as f64;
        let limit = present as f64 * if stopped { 1.0 } else { share };
        let limit = if left as f64 <= (1.0 + REMAINDER) * limit {
            left
        } else {
            limit.ceil() as usize
        };
        let removed = state.cheapest(limit);
        state.remove(&removed, Precision::Rough)?;
        rounds += 1;
    }
    Ok(rounds)
}
