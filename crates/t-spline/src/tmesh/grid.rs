//! Base grids.

use serde::{Deserialize, Serialize};

use crate::complex::{Cylinder, Segment};

/// Zeros face each other if they are closer than a column over this: supports that end at one are then so
/// narrow that they leave little of what is anchored at the other.
const NEAR: i64 = 8;

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
        let zeros = |border: &[Segment]| -> Vec<i64> {
            let marked = border.iter().filter(|s| s.zero.is_some());
            marked.map(|s| s.start).collect()
        };
        let (bottom, top) = (zeros(&cylinder.bottom), zeros(&cylinder.top));
        let size = cylinder.circumference;
        let mut fixed = vec![0, size];
        fixed.extend(bottom.iter().chain(&top));
        fixed.sort_unstable();
        fixed.dedup();
        let columns = self.columns.max(1) as i128;
        let mut xs = Vec::new();
        for pair in fixed.windows(2) {
            let gap = i128::from(pair[1] - pair[0]);
            let wanted = (2 * gap * columns + i128::from(size)) / (2 * i128::from(size));
            push_even(&mut xs, pair[0], pair[1], wanted.max(1) as usize);
        }
        xs.push(size);
        for (place, &zero) in bottom.iter().enumerate() {
            let next = bottom.get(place + 1).copied();
            let next = next.unwrap_or(bottom[0] + size);
            let inside = |x: i64| (x - zero).rem_euclid(size);
            if !xs.iter().any(|&x| (1..next - zero).contains(&inside(x))) {
                xs.push((zero + (next - zero) / 2).rem_euclid(size));
            }
        }
        xs.sort_unstable();
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
}

/// Adds the starts of `count` intervals between two ends, which differ by at most one unit.
fn push_even(lines: &mut Vec<i64>, from: i64, to: i64, count: usize) {
    let gap = i128::from(to - from);
    let step = |k: usize| from + (gap * k as i128 / count as i128) as i64;
    lines.extend((0..count).map(step));
}
