//! A curve of cubic pieces, by arc length.

use nalgebra::{Point3, Vector3};

/// Sub-intervals of a piece on which its length is tabulated.
const PARTS: usize = 8;

/// Newton steps from a length to its parameter; the start is within a small part of a piece, on
/// which the speed hardly changes.
const NEWTON_STEPS: usize = 4;

/// Points and weights of Gauss-Legendre quadrature on [0, 1], exact to degree 7.
const GAUSS: [[f64; 2]; 4] = [
    [0.069_431_844_202_973_71, 0.173_927_422_568_726_93],
    [0.330_009_478_207_571_87, 0.326_072_577_431_273_07],
    [0.669_990_521_792_428_1, 0.326_072_577_431_273_07],
    [0.930_568_155_797_026_3, 0.173_927_422_568_726_93],
];

/// A chain of cubic Bézier pieces with its arc length.
#[derive(Clone, Debug, PartialEq)]
pub struct ArcCurve {
    pieces: Vec<[Point3<f64>; 4]>,
    /// Length up to each part of each piece, from zero to the whole length.
    lengths: Vec<f64>,
}

impl ArcCurve {
    pub(super) fn new(pieces: Vec<[Point3<f64>; 4]>) -> Self {
        let mut lengths = Vec::with_capacity(PARTS * pieces.len() + 1);
        let mut sum = 0.0;
        lengths.push(sum);
        for piece in &pieces {
            for part in 0..PARTS {
                let [from, to] = [part, part + 1].map(|i| i as f64 / PARTS as f64);
                sum += length_between(piece, from, to);
                lengths.push(sum);
            }
        }
        Self { pieces, lengths }
    }

    /// Returns its length.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    /// Returns its cubic pieces as Bézier control points; they meet at the points of the network.
    #[must_use]
    pub fn pieces(&self) -> &[[Point3<f64>; 4]] {
        &self.pieces
    }

    /// Returns the length from the start to the end of piece `index`.
    ///
    /// # Panics
    /// If there is no such piece.
    #[must_use]
    pub fn length_to_end_of(&self, index: usize) -> f64 {
        self.lengths[(index + 1) * PARTS]
    }

    /// Returns the point at an arc length from its start; lengths beyond an end mean that end.
    #[must_use]
    pub fn point(&self, length: f64) -> Point3<f64> {
        let (piece, t) = self.parameter(length);
        point(&self.pieces[piece], t)
    }

    /// Returns the unit tangent at an arc length from its start.
    #[must_use]
    pub fn tangent(&self, length: f64) -> Vector3<f64> {
        let (piece, t) = self.parameter(length);
        tangent(&self.pieces[piece], t)
    }

    /// Returns points and unit tangents, `per_piece` steps on each piece, both ends included.
    pub(super) fn samples(&self, per_piece: usize) -> Vec<(Point3<f64>, Vector3<f64>)> {
        let at = |piece: &[Point3<f64>; 4], i: usize| {
            let t = i as f64 / per_piece as f64;
            (point(piece, t), tangent(piece, t))
        };
        let first = std::iter::once(at(&self.pieces[0], 0));
        let rest = self.pieces.iter();
        let rest = rest.flat_map(|piece| (1..=per_piece).map(move |i| at(piece, i)));
        first.chain(rest).collect()
    }

    /// Returns the piece at a length, and the parameter on it.
    fn parameter(&self, length: f64) -> (usize, f64) {
        let length = length.clamp(0.0, self.length());
        let last = self.lengths.len() - 2;
        let part = (self.lengths.partition_point(|&l| l <= length).max(1) - 1).min(last);
        let (piece, from) = (part / PARTS, (part % PARTS) as f64 / PARTS as f64);
        let wanted = length - self.lengths[part];
        let whole = self.lengths[part + 1] - self.lengths[part];
        let to = from + 1.0 / PARTS as f64;
        let mut t = from + (wanted / whole).min(1.0) / PARTS as f64;
        for _ in 0..NEWTON_STEPS {
            let speed = derivative(&self.pieces[piece], t).norm();
            if speed > 0.0 {
                let excess = length_between(&self.pieces[piece], from, t) - wanted;
                t = (t - excess / speed).clamp(from, to);
            }
        }
        (piece, t)
    }
}

fn point(piece: &[Point3<f64>; 4], t: f64) -> Point3<f64> {
    let s = 1.0 - t;
    let [a, b, c, d] = piece.map(|p| p.coords);
    Point3::from(a * (s * s * s) + b * (3.0 * s * s * t) + c * (3.0 * s * t * t) + d * (t * t * t))
}

fn derivative(piece: &[Point3<f64>; 4], t: f64) -> Vector3<f64> {
    let s = 1.0 - t;
    let [a, b, c, d] = piece;
    ((b - a) * (s * s) + (c - b) * (2.0 * s * t) + (d - c) * (t * t)) * 3.0
}

fn tangent(piece: &[Point3<f64>; 4], t: f64) -> Vector3<f64> {
    let chord = piece[3] - piece[0];
    let derivative = derivative(piece, t);
    // Where the parameterisation stops, the chord tells more than rounding does.
    let stopped = derivative.norm() <= 1e-9 * chord.norm();
    if stopped { chord } else { derivative }.normalize()
}

fn length_between(piece: &[Point3<f64>; 4], from: f64, to: f64) -> f64 {
    let speed = |x: f64| derivative(piece, from + (to - from) * x).norm();
    GAUSS.iter().map(|[x, w]| w * speed(*x)).sum::<f64>() * (to - from)
}

/// Returns the cubic from `ends[0]` to `ends[1]` of the centripetal Catmull-Rom spline through what
/// comes before and after; where the spline ends, its last two pieces share a parabola.
///
/// # Reference
/// [Yuksel2011].
pub(super) fn catmull_rom(
    before: Option<Point3<f64>>,
    ends: [Point3<f64>; 2],
    after: Option<Point3<f64>>,
) -> [Point3<f64>; 4] {
    let [p, q] = ends;
    let step = (q - p).norm().sqrt();
    let slope = (q - p) / step;
    // Derivative at the middle of three points of the parabola through them.
    let middle = |in_step: f64, in_slope: Vector3<f64>, out_step: f64, out_slope: Vector3<f64>| {
        (in_slope * out_step + out_slope * in_step) / (in_step + out_step)
    };
    let start = before.map(|o| {
        let h = (p - o).norm().sqrt();
        middle(h, (p - o) / h, step, slope)
    });
    let end = after.map(|r| {
        let h = (r - q).norm().sqrt();
        middle(step, slope, h, (r - q) / h)
    });
    let opposite = |known: Vector3<f64>| slope * 2.0 - known;
    let (start, end) = match (start, end) {
        (Some(start), Some(end)) => (start, end),
        (Some(start), None) => (start, opposite(start)),
        (None, Some(end)) => (opposite(end), end),
        (None, None) => (slope, slope),
    };
    [p, p + start * (step / 3.0), q - end * (step / 3.0), q]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points on a quarter of the unit circle.
    fn quarter(count: usize) -> ArcCurve {
        let place = |i: i64| {
            let angle = std::f64::consts::FRAC_PI_2 * i as f64 / count as f64;
            Point3::new(angle.cos(), angle.sin(), 0.0)
        };
        let piece = |i: i64| {
            let ends = [place(i), place(i + 1)];
            catmull_rom(Some(place(i - 1)), ends, Some(place(i + 2)))
        };
        ArcCurve::new((0..count as i64).map(piece).collect())
    }

    #[test]
    fn arc_length_runs_along_a_circle_and_gains_three_orders() {
        let errors = [8, 16].map(|count| {
            let curve = quarter(count);
            (0..=20)
                .map(|i| {
                    let s = curve.length() * f64::from(i) / 20.0;
                    let angle = std::f64::consts::FRAC_PI_2 * f64::from(i) / 20.0;
                    (curve.point(s) - Point3::new(angle.cos(), angle.sin(), 0.0)).norm()
                })
                .fold(0.0, f64::max)
        });
        assert!(
            errors[0] < 1e-4 && errors[1] < errors[0] / 7.5,
            "{errors:?}"
        );
    }

    #[test]
    fn equal_steps_of_length_are_equal_steps_of_the_curve() {
        let curve = quarter(3);
        let mut sum = 0.0;
        let mut last = curve.point(0.0);
        for i in 1..=10_000 {
            let next = curve.point(curve.length() * f64::from(i) / 10_000.0);
            sum += (next - last).norm();
            let mean = curve.length() / 10_000.0;
            assert!(((next - last).norm() - mean).abs() < 1e-6 * mean);
            last = next;
        }
        assert!((sum - curve.length()).abs() < 1e-6);
        assert!((curve.tangent(0.0) - Vector3::y()).norm() < 0.1);
    }

    #[test]
    fn a_single_piece_without_neighbours_is_straight() {
        let ends = [Point3::origin(), Point3::new(0.0, 3.0, 4.0)];
        let curve = ArcCurve::new(vec![catmull_rom(None, ends, None)]);
        assert!((curve.length() - 5.0).abs() < 1e-14);
        assert!((curve.point(2.5) - Point3::new(0.0, 1.5, 2.0)).norm() < 1e-14);
    }
}
