//! Boxes of whole units, and how the unit square lies over them.

use nalgebra::Complex;

use crate::caps::{CapKind, Caps};
use crate::complex::{Beyond, Border, CylinderComplex, Point, UNITS};

/// A box of a cylinder. Beside a pole boxes go on beyond the end of the cylinder, over the disk that is
/// left there; `y` is then linear in `|w|`, up to [`pole_depth`] at the pole itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tile {
    pub(super) cylinder: u32,
    pub(super) x: [i64; 2],
    pub(super) y: [i64; 2],
    /// The leaf that holds it; none beyond the end of a cylinder.
    pub(super) leaf: Option<u32>,
}

/// How far tiles go beyond a border at a pole, in units.
pub(super) fn pole_depth(complex: &CylinderComplex, cylinder: u32) -> i64 {
    complex.cylinders()[cylinder as usize].circumference / 4
}

/// Returns the pole that a border closes around, if it does.
pub(super) fn pole_at(complex: &CylinderComplex, cylinder: u32, border: Border) -> Option<u32> {
    match complex.border(cylinder, border).first()?.beyond {
        Beyond::Pole { index } => Some(index),
        _ => None,
    }
}

/// Returns the zero at a point of a cylinder, not wrapped.
pub(super) fn zero_at(complex: &CylinderComplex, cylinder: u32, [x, y]: [i64; 2]) -> Option<u32> {
    let height = complex.cylinders()[cylinder as usize].height;
    let on = |border| complex.zero_at(cylinder, border, x);
    let bottom = (y == 0).then(|| on(Border::Bottom)).flatten();
    bottom.or_else(|| (y == height).then(|| on(Border::Top)).flatten())
}

/// How the unit square lies over a tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Chart {
    /// Linearly.
    Plain,
    /// With a corner at a zero, around which it is smooth in the root of `z`.
    Zero {
        /// Whether the zero lies at the upper end in `x` and in `y`.
        high: [bool; 2],
        /// Which root.
        root: u32,
    },
    /// Beyond a border at a pole, linearly in `|w|` and its angle.
    Pole(Border),
}

impl Tile {
    /// Returns the two halves of a tile at a line along an axis.
    pub(super) fn cut(self, axis: usize, at: i64) -> [Self; 2] {
        let mut halves = [self; 2];
        if axis == 0 {
            (halves[0].x[1], halves[1].x[0]) = (at, at);
        } else {
            (halves[0].y[1], halves[1].y[0]) = (at, at);
        }
        halves
    }

    /// Returns the two halves of a tile along an axis.
    pub(super) fn halves(self, axis: usize) -> [Self; 2] {
        let [low, high] = [self.x, self.y][axis];
        self.cut(axis, low + (high - low) / 2)
    }

    pub(super) fn size(&self) -> [i64; 2] {
        [self.x[1] - self.x[0], self.y[1] - self.y[0]]
    }

    /// Returns the zeros at corners, and at which.
    pub(super) fn zeros(&self, complex: &CylinderComplex) -> Vec<(u32, [bool; 2])> {
        let corners = [[false, false], [true, false], [true, true], [false, true]];
        let zero = |high: [bool; 2]| {
            let at = [self.x[usize::from(high[0])], self.y[usize::from(high[1])]];
            Some((zero_at(complex, self.cylinder, at)?, high))
        };
        corners.into_iter().filter_map(zero).collect()
    }

    /// Returns how the unit square lies over a tile with a zero at one of its corners at most.
    pub(super) fn chart(&self, complex: &CylinderComplex, caps: &Caps) -> Chart {
        if self.leaf.is_none() {
            let bottom = self.y[0] < 0;
            return Chart::Pole(if bottom { Border::Bottom } else { Border::Top });
        }
        match self.zeros(complex).first() {
            Some(&(zero, high)) => match caps.caps()[zero as usize].kind {
                CapKind::Zero { order, .. } => Chart::Zero {
                    high,
                    root: order + 1,
                },
                CapKind::Pole { .. } => Chart::Plain,
            },
            None => Chart::Plain,
        }
    }

    /// Returns the point of the surface over `(s, t)` of the unit square.
    pub(super) fn point(&self, complex: &CylinderComplex, chart: Chart, at: [f64; 2]) -> Point {
        let own = &complex.cylinders()[self.cylinder as usize];
        let linear = |range: [i64; 2], t: f64| {
            let [low, high] = range.map(|end| end as f64);
            if t == 1.0 {
                high
            } else {
                low + t * (high - low)
            }
        };
        let [mut x, mut y] = [linear(self.x, at[0]), linear(self.y, at[1])];
        match chart {
            Chart::Plain => {}
            Chart::Zero { high, root } => [x, y] = self.near_zero(high, root, at),
            Chart::Pole(border) => {
                let edge = match border {
                    Border::Bottom => 0.0,
                    Border::Top => own.height as f64,
                };
                let share = (y - edge).abs() / pole_depth(complex, self.cylinder) as f64;
                let way = -(1.0 - share).ln() * own.circumference as f64 / std::f64::consts::TAU;
                y = edge + if border == Border::Top { way } else { -way };
            }
        }
        let size = own.circumference as f64;
        Point {
            cylinder: self.cylinder,
            x: if x >= size { x - size } else { x },
            y,
        }
    }

    /// Blends the sides of the tile in the root of `z`: those at the zero are straight in it.
    fn near_zero(&self, high: [bool; 2], root: u32, at: [f64; 2]) -> [f64; 2] {
        let [w, h] = self.size().map(|s| s as f64 / UNITS);
        let from = |k: usize| if high[k] { 1.0 - at[k] } else { at[k] };
        let [p, q] = [from(0), from(1)];
        let power = |re: f64, im: f64| Complex::new(re, im).powf(1.0 / f64::from(root));
        let corner = power(w, h);
        let z = power(w * p, h) * q + power(w, h * q) * p - corner * (p * q);
        let z = z.powu(root);
        let place = |k: usize, range: [i64; 2], part: f64, size: f64| {
            let [inner, way] = if high[k] {
                [range[1], -1]
            } else {
                [range[0], 1]
            };
            let part = part.clamp(0.0, size) * UNITS;
            inner as f64 + way as f64 * part
        };
        [
            place(0, self.x, side(p, z.re, w), w),
            place(1, self.y, side(q, z.im, h), h),
        ]
    }

    /// Returns the parameter along a side, 0 to 3 counterclockwise from below, at a coordinate.
    pub(super) fn parameter(&self, chart: Chart, side: usize, at: i64) -> f64 {
        let axis = side % 2;
        let range = [self.x, self.y][axis];
        let share = (at - range[0]) as f64 / (range[1] - range[0]) as f64;
        let Chart::Zero { high, root } = chart else {
            return share;
        };
        // Sides 0 and 3 are the low ones across their axis, 1 and 2 the high ones.
        let is_high = side == 1 || side == 2;
        if high[1 - axis] != is_high {
            return share;
        }
        let root = 1.0 / f64::from(root);
        if high[axis] {
            1.0 - (1.0 - share).powf(root)
        } else {
            share.powf(root)
        }
    }
}

/// Returns a coordinate, exact on the sides.
fn side(at: f64, inside: f64, size: f64) -> f64 {
    if at == 0.0 {
        0.0
    } else if at == 1.0 {
        size
    } else {
        inside
    }
}
