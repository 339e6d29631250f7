//! Base grids.

use serde::{Deserialize, Serialize};

use crate::complex::{Cylinder, Segment};

/// Zeros face each other if they are closer than a column over this: supports that end at one are then so
/// narrow that they leave little of what is anchored at the other.
const NEAR: i64 = 8;

/// Columns halved more often than this are a few units wide.
const MOST_HALVED: u8 = 60;

/// How many columns and rows a cylinder starts with, about: lines through zeros and what the coverage of
/// their neighbourhoods needs come in addition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Grid {
    /// Wanted columns.
    pub columns: usize,
    /// Wanted rows.
    pub rows: usize,
}

impl Grid {
    /// Returns the grid of about `cells` cells that are about `aspect` times as wide as high, at least one.
    #[must_use]
    pub fn of_cells(cylinder: &Cylinder, cells: f64, aspect: f64) -> Self {
        let size = [cylinder.circumference as f64, cylinder.height as f64];
        let width = (aspect * size[0] * size[1] / cells).sqrt();
        let count = |size: f64, step: f64| (size / step).round().max(1.0) as usize;
        Self {
            columns: count(size[0], width),
            rows: count(size[1], width / aspect),
        }
    }

    /// Returns the lines of the grid: columns from 0 to `C` and rows from 0 to `H`, ascending.
    ///
    /// Columns go through all zeros of both borders, as the only functions that are positive above a zero
    /// have their anchors there; then there must be anchors on the ray between the zeros of both borders,
    /// so there are two rows where these face each other or nearly so, and on every connection between zeros. The
    /// columns between are as even as these allow, and never close to one of them.
    pub(crate) fn lines(self, cylinder: &Cylinder) -> (Vec<i64>, Vec<i64>) {
        let (bottom, top) = (zeros(&cylinder.bottom), zeros(&cylinder.top));
        let size = cylinder.circumference;
        let columns = self.columns.max(1);
        let mut xs = Vec::new();
        for stretch in self.stretches(cylinder) {
            push_even(&mut xs, stretch.from, stretch.to, stretch.columns);
        }
        xs.push(size);
        let near = size / (NEAR * columns as i64);
        let distance = |a: i64, b: i64| (a - b).rem_euclid(size).min((b - a).rem_euclid(size));
        let faced = |&x: &i64| top.iter().any(|&t| distance(x, t) <= near);
        let facing = bottom.iter().any(faced);
        let rows = self.rows.max(if facing { 2 } else { 1 });
        let mut ys = Vec::new();
        push_even(&mut ys, 0, cylinder.height, rows);
        ys.push(cylinder.height);
        (xs, ys)
    }

    /// Returns the stretches between zeros of either border, and between these and 0, with their columns.
    fn stretches(self, cylinder: &Cylinder) -> Vec<Stretch> {
        let (bottom, top) = (zeros(&cylinder.bottom), zeros(&cylinder.top));
        let size = cylinder.circumference;
        let mut fixed = vec![0, size];
        fixed.extend(bottom.iter().chain(&top));
        fixed.sort_unstable();
        fixed.dedup();
        let columns = self.columns.max(1) as i128;
        let is_zero = |x: i64| bottom.contains(&x.rem_euclid(size));
        let stretch = |pair: &[i64]| {
            let gap = i128::from(pair[1] - pair[0]);
            let wanted = (2 * gap * columns + i128::from(size)) / (2 * i128::from(size));
            let least = if pair.iter().all(|&x| is_zero(x)) {
                2
            } else {
                1
            };
            Stretch {
                from: pair[0],
                to: pair[1],
                columns: wanted.max(least) as usize,
            }
        };
        fixed.windows(2).map(stretch).collect()
    }

    /// Returns where a column is halved that was halved `level` times before: where its share of the stretch
    /// says, rounded once, so that thirds and quarters of two cylinders meet over a border after all.
    pub(super) fn middle(self, cylinder: &Cylinder, [low, high]: [i64; 2], level: u8) -> i64 {
        let stretches = self.stretches(cylinder);
        let of = stretches.iter().find(|s| s.from <= low && high <= s.to);
        let Some(stretch) = of.filter(|_| level < MOST_HALVED) else {
            return low + (high - low) / 2;
        };
        let gap = i128::from(stretch.to - stretch.from);
        let parts = (stretch.columns as i128) << level;
        let into = i128::from(low - stretch.from);
        // The number of the column: its start is rounded by less than half of its width.
        let number = (2 * into * parts + gap) / (2 * gap);
        stretch.from + (gap * (2 * number + 1) / (2 * parts)) as i64
    }
}

/// Columns between two zeros, or between one and 0.
struct Stretch {
    from: i64,
    to: i64,
    columns: usize,
}

/// Returns where the zeros on a border lie, ascending.
fn zeros(border: &[Segment]) -> Vec<i64> {
    let marked = border.iter().filter(|s| s.zero.is_some());
    marked.map(|s| s.start).collect()
}

/// Adds the starts of `count` intervals between two ends, which differ by at most one unit.
fn push_even(lines: &mut Vec<i64>, from: i64, to: i64, count: usize) {
    let gap = i128::from(to - from);
    let step = |k: usize| from + (gap * k as i128 / count as i128) as i64;
    lines.extend((0..count).map(step));
}
