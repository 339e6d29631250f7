//! Exact crossings of a surface with the lines of a lattice.
//!
//! Coordinates are whole numbers. A line that meets an edge or vertex of the surface, and a lattice
//! point that lies on it, are decided as if the whole lattice were moved by the infinitesimal vector
//! `(e, e², e³)`: each line so crosses a closed surface an even number of times, and all directions
//! agree which lattice points are inside.

use rayon::prelude::*;

use super::grid::{DIRECTIONS, Grid, STEPS};

/// Triangles cut by one task; fixed, though the result does not depend on it.
const BLOCK: usize = 2048;

/// Distance from a lattice point within which the place of a crossing is decided exactly, in steps:
/// far above the rounding of a quotient, far below one.
const CLOSE: f64 = 1e-6;

/// A crossing of the surface with a lattice edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Crossing {
    /// Number of the lower end, times the number of directions, plus the direction of the edge.
    pub(super) edge: u32,
    /// 1 where the line enters, going up, and -1 where it leaves.
    pub(super) turn: i8,
    /// Fraction of the edge from its lower end.
    pub(super) fraction: f64,
}

/// Returns all crossings, in order of their edges and along them.
pub(super) fn crossings(grid: &Grid, points: &[[i64; 3]], faces: &[[u32; 3]]) -> Vec<Crossing> {
    let blocks: Vec<Vec<Crossing>> = faces
        .par_chunks(BLOCK)
        .map(|block| {
            let mut found = Vec::new();
            for face in block {
                let triangle = Triangle::build(face.map(|v| points[v as usize]));
                for direction in 0..DIRECTIONS {
                    triangle.cross(grid, direction, &mut found);
                }
            }
            found
        })
        .collect();
    let mut all = blocks.concat();
    all.par_sort_unstable_by(|a, b| {
        (a.edge.cmp(&b.edge))
            .then(a.fraction.total_cmp(&b.fraction))
            .then(a.turn.cmp(&b.turn))
    });
    all
}

struct Triangle {
    corners: [[i64; 3]; 3],
    normal: [i64; 3],
}

/// Returns the two coordinates that are constant along lines of a direction.
fn project(direction: usize, p: [i64; 3]) -> [i64; 2] {
    let step = STEPS[direction];
    match direction {
        0 => [p[1], p[2]],
        1 => [p[0], p[2]],
        2 => [p[0], p[1]],
        _ => [
            p[0] - i64::from(step[0]) * p[2],
            p[1] - i64::from(step[1]) * p[2],
        ],
    }
}

/// Returns the coordinates of a point of a lattice line, `along` steps of one unit from its start.
fn on_line(direction: usize, [u, v]: [i64; 2], along: i64) -> [i64; 3] {
    let step = STEPS[direction];
    match direction {
        0 => [along, u, v],
        1 => [u, along, v],
        2 => [u, v, along],
        _ => [
            u + i64::from(step[0]) * along,
            v + i64::from(step[1]) * along,
            along,
        ],
    }
}

/// Returns which way around `p`, moved infinitesimally, the line from `a` to `b` runs.
///
/// In every projection the first coordinate is moved more than the second.
fn turn([a, b]: [[i64; 2]; 2], p: [i64; 2]) -> i64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let area = along[0] * (p[1] - a[1]) - along[1] * (p[0] - a[0]);
    [area, -along[1], along[0]]
        .into_iter()
        .find(|&x| x != 0)
        .map_or(0, i64::signum)
}

impl Triangle {
    fn build(corners: [[i64; 3]; 3]) -> Self {
        let [a, b, c] = corners;
        let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
        let normal = [
            u[1] * v[2] - u[2] * v[1],
            u[2] * v[0] - u[0] * v[2],
            u[0] * v[1] - u[1] * v[0],
        ];
        Self { corners, normal }
    }

    /// Appends the crossings with lattice lines of one direction.
    fn cross(&self, grid: &Grid, direction: usize, found: &mut Vec<Crossing>) {
        let flat = self.corners.map(|p| project(direction, p));
        let inverse = 1.0 / grid.half as f64;
        let range = |axis: usize| {
            let values = flat.map(|p| p[axis]);
            let low = values[0].min(values[1]).min(values[2]);
            let high = values[0].max(values[1]).max(values[2]);
            // Half of one too many: the lines themselves are decided exactly.
            let low = (low as f64 * inverse - 1e-6).ceil() as i64;
            (low, (high as f64 * inverse + 1e-6).floor() as i64)
        };
        let ((low_u, high_u), (low_v, high_v)) = (range(0), range(1));
        if low_u > high_u || low_v > high_v {
            return;
        }
        for u in low_u..=high_u {
            for v in low_v..=high_v {
                let is_line = match direction {
                    0..=2 => (u - v) % 2 == 0,
                    _ => u % 2 == 0 && v % 2 == 0,
                };
                if !is_line {
                    continue;
                }
                let at = [u * grid.half, v * grid.half];
                let first = turn([flat[0], flat[1]], at);
                if first != 0
                    && turn([flat[1], flat[2]], at) == first
                    && turn([flat[2], flat[0]], at) == first
                {
                    found.extend(self.place(grid, direction, [u, v]));
                }
            }
        }
    }

    /// Returns the crossing with a line that is known to pass through; `None` if the triangle is
    /// parallel to it.
    fn place(&self, grid: &Grid, direction: usize, line: [i64; 2]) -> Option<Crossing> {
        let normal = self.normal;
        let unit = on_line(direction, [0, 0], 1);
        let rise: i64 = (0..3).map(|axis| normal[axis] * unit[axis]).sum();
        if rise == 0 {
            return None;
        }
        let base = on_line(direction, line.map(|x| x * grid.half), 0);
        // Twice the volume under the plane, seen from the start of the line.
        let height: i128 = (0..3)
            .map(|axis| i128::from(normal[axis]) * i128::from(self.corners[0][axis] - base[axis]))
            .sum();
        let slope = i128::from(rise) * i128::from(grid.half);
        let along = height as f64 / slope as f64;
        // Lattice points follow each other on a long line in steps of two, of the line's parity.
        let (step, shift) = match direction {
            0..=2 => (2.0, (line[0].rem_euclid(2)) as f64),
            _ => (1.0, 0.0),
        };
        let steps = (along - shift) / step;
        let mut below = steps.floor();
        let near = steps.round();
        if (steps - near).abs() < CLOSE {
            // Exactly: whether the crossing is above the lattice point nearest to it.
            let point = i128::from((near * step + shift) as i64);
            let beyond = (height - slope * point) * slope.signum();
            let moved = normal.into_iter().find(|&x| x != 0).map_or(0, i64::signum);
            let is_above = beyond > 0 || beyond == 0 && moved != rise.signum();
            below = if is_above { near } else { near - 1.0 };
        }
        let lower = on_line(direction, line, (below * step + shift) as i64).map(|x| x as i32);
        Some(Crossing {
            edge: grid.id(lower) * DIRECTIONS as u32 + direction as u32,
            turn: if rise < 0 { 1 } else { -1 },
            fraction: (steps - below).clamp(0.0, 1.0),
        })
    }
}
