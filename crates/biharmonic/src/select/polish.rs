//! Polish: a few knots move to where the spline is farthest from the data.
//!
//! Elimination and exchange minimise the squared error, which a single far vertex hardly changes. A
//! round of polish inserts one knot in each cell that has a peak, a distance near the largest one,
//! and then removes as many of the cheapest knots, none of them near a peak or an inserted knot. It is
//! kept if the largest distance falls and neither the squared error nor the mean distance rises much.
//!
//! # Notation
//! `d_v = c_v |S_v - f_v|` the distance at a vertex, with its weight; `M` the largest one. The round
//! is kept if `M` falls, `Σ d_v²` stays below 1.01 times its value before the polish, and `Σ d_v` too.
//!
//! # Reference
//! [Hou2017] §6. Deviation: the paper minimises the squared error alone.

use super::Run;
use super::state::{Precision, State};
use super::voronoi::largest_in_cells;
use crate::FitError;

/// Rounds in all. On ten fits of scans six rounds left 0.81 of the largest distance, ten 0.78.
const ROUNDS: u32 = 8;

/// Share of the knots that a round moves at most at first. Twice and half as many leave 1 % more.
const FIRST_SHARE: f64 = 0.01;

/// A peak is a distance of at least so many times the largest one; 0.8 leaves the same.
const PEAK: f64 = 0.7;

/// A knot is kept if its cell has a distance of so many times the largest one.
const NEAR_PEAK: f64 = 0.6;

/// Share by which the squared error and the mean distance may rise in all.
const ALLOWED_RISE: f64 = 1e-2;

/// Where in the cell of a peak a knot comes.
///
/// Either alone lowers the largest distance by 7 %, the second where the first failed by 12 %: a peak
/// may lie where its cell gains nothing.
#[derive(Clone, Copy)]
enum Place {
    /// Where the squared error gains most.
    LargestGain,
    /// At the peak itself.
    Peak,
}

/// What is judged about a fit.
struct Judged {
    largest: f64,
    sum: f64,
    squares: f64,
}

impl Judged {
    fn of(state: &State<'_>) -> Self {
        let distances = state.distances();
        Self {
            largest: largest(&distances),
            sum: distances.iter().sum(),
            squares: state.error(),
        }
    }

    /// Returns whether the sums have risen by no more than is allowed since `start`.
    fn stays_near(&self, start: &Self) -> bool {
        let allowed = 1.0 + ALLOWED_RISE;
        self.squares <= allowed * start.squares && self.sum <= allowed * start.sum
    }
}

/// Moves knots to lower the largest distance, and returns the rounds tried and kept.
///
/// A round costs somewhat more than one of exchange, as its last fit is closer to the minimum.
pub(super) fn polish(state: &mut State<'_>, run: &mut Run<'_, '_>) -> Result<[u32; 2], FitError> {
    if run.stopped {
        return Ok([0, 0]);
    }
    state.fit(Precision::Fine);
    let start = Judged::of(state);
    let mut best = start.largest;
    let mut most = ((state.knots().len() as f64 * FIRST_SHARE) as usize).max(1);
    let (mut place, mut tried, mut kept) = (Place::LargestGain, 0, 0);
    while tried < ROUNDS && most > 0 && best > 0.0 {
        if run.stop(
            u64::from(tried),
            u64::from(ROUNDS),
            state.root_mean_square(),
        ) {
            break;
        }
        tried += 1;
        let saved = state.save();
        let moved = move_to_peaks(state, most, place)?;
        let judged = Judged::of(state);
        if moved && judged.largest < best && judged.stays_near(&start) {
            best = judged.largest;
            (place, kept) = (Place::LargestGain, kept + 1);
            continue;
        }
        state.restore(saved)?;
        (place, most) = match place {
            Place::LargestGain => (Place::Peak, most),
            Place::Peak => (Place::LargestGain, most / 2),
        };
    }
    Ok([tried, kept])
}

/// Moves up to `most` knots, and returns whether that went as it should: not where no knot can come
/// or go.
fn move_to_peaks(state: &mut State<'_>, most: usize, place: Place) -> Result<bool, FitError> {
    let count = state.knots().len();
    let inserted = wanted(state, most, place);
    if inserted.is_empty() {
        return Ok(false);
    }
    state.insert(&inserted, Precision::Rough)?;
    while state.knots().len() > count {
        let kept = near_peaks(state, &inserted);
        let removed = state.cheapest_of(state.knots().len() - count, |knot| !kept[knot]);
        if removed.is_empty() {
            return Ok(false);
        }
        state.remove(&removed, Precision::Fair)?;
    }
    state.fit(Precision::Fine);
    Ok(true)
}

/// Returns the vertices where knots come: up to `most`, one in the cell of each peak.
fn wanted(state: &State<'_>, most: usize, place: Place) -> Vec<u32> {
    let (cells, distances) = (state.rings().cells(), state.distances());
    let farthest = largest_in_cells(cells, &distances, state.knots().len());
    let least = PEAK * largest(&distances);
    let mut peaks: Vec<usize> = (0..farthest.len())
        .filter(|&k| farthest[k].0 >= least)
        .collect();
    peaks.sort_by(|&a, &b| farthest[b].0.total_cmp(&farthest[a].0).then(a.cmp(&b)));
    peaks.truncate(most);
    match place {
        Place::LargestGain => {
            let best = largest_in_cells(cells, &state.gains(), farthest.len());
            let gaining = peaks.into_iter().filter(|&k| best[k].0 > 0.0);
            gaining.map(|k| best[k].1).collect()
        }
        Place::Peak => {
            let vertices = peaks.into_iter().map(|k| farthest[k].1);
            let is_new = |vertex: &u32| state.knots().binary_search(vertex).is_err();
            vertices.filter(is_new).collect()
        }
    }
}

/// Returns which knots have a large distance in their cells, or a cell that touches that of an
/// inserted one.
fn near_peaks(state: &State<'_>, inserted: &[u32]) -> Vec<bool> {
    let (cells, distances) = (state.rings().cells(), state.distances());
    let farthest = largest_in_cells(cells, &distances, state.knots().len());
    let least = NEAR_PEAK * largest(&distances);
    let mut near: Vec<bool> = farthest.iter().map(|peak| peak.0 > least).collect();
    for &vertex in inserted {
        let cell = cells[vertex as usize] as usize;
        near[cell] = true;
        let around = state.rings().neighbours(cell).iter();
        around.for_each(|&other| near[other as usize] = true);
    }
    near
}

fn largest(distances: &[f64]) -> f64 {
    distances.iter().copied().fold(0.0, f64::max)
}
