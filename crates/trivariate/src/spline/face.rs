//! The six faces of the solid.

use msplines_common::bspline::{
    Axis, BezierCells, CellShape, curvatures, locate, slopes, span_restriction, weights,
};
use msplines_common::{Point3, Vector3};

use super::TrivariateSpline;

/// A face of the unit cube: where one parameter is 0 or 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Face {
    /// The fixed parameter: 0, 1 or 2.
    pub axis: usize,
    /// Which end it is fixed to.
    pub end: End,
}

/// An end of a direction of the cube.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum End {
    /// Parameter 0.
    Low,
    /// Parameter 1.
    High,
}

impl Face {
    /// All six: `u = 0`, `u = 1`, `v = 0`, `v = 1`, `w = 0`, `w = 1`.
    pub const ALL: [Self; 6] = [
        Self {
            axis: 0,
            end: End::Low,
        },
        Self {
            axis: 0,
            end: End::High,
        },
        Self {
            axis: 1,
            end: End::Low,
        },
        Self {
            axis: 1,
            end: End::High,
        },
        Self {
            axis: 2,
            end: End::Low,
        },
        Self {
            axis: 2,
            end: End::High,
        },
    ];

    /// The two free parameters, in cyclic order after the fixed one: with them the normal points into
    /// the direction of the fixed parameter where the solid does not fold.
    #[must_use]
    pub fn free(self) -> [usize; 2] {
        [(self.axis + 1) % 3, (self.axis + 2) % 3]
    }

    /// Returns the parameter of the solid of a point of the face.
    #[must_use]
    pub fn parameter(self, at: [f64; 2]) -> [f64; 3] {
        let mut full = [0.0; 3];
        full[self.axis] = if self.end == End::High { 1.0 } else { 0.0 };
        let [a, b] = self.free();
        full[a] = at[0];
        full[b] = at[1];
        full
    }
}

/// A face of a solid, as a uniform cubic tensor product over the unit square.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceSpline {
    spans: usize,
    points: Vec<Point3<f64>>,
}

impl TrivariateSpline {
    /// Returns the surface over a face of the cube, in the parameters [`Face::free`].
    #[must_use]
    pub fn face(&self, face: Face) -> FaceSpline {
        let size = self.size();
        let (first, row) = match face.end {
            End::Low => (0, weights(0.0)),
            End::High => (self.spans - 1, weights(1.0)),
        };
        let stride = [1, size, size * size];
        let [a, b] = face.free();
        let point = |at: usize| {
            let start = at % size * stride[a] + at / size * stride[b] + first * stride[face.axis];
            let sum = |p: usize| self.points[start + p * stride[face.axis]].coords * row[p];
            Point3::from((0..4).map(sum).sum::<Vector3<f64>>())
        };
        FaceSpline {
            spans: self.spans,
            points: (0..size * size).map(point).collect(),
        }
    }
}

impl FaceSpline {
    /// Spans in each direction.
    #[must_use]
    pub fn spans(&self) -> usize {
        self.spans
    }

    /// Control points, the first index fastest, `spans + 3` in each direction.
    #[must_use]
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// Returns the derivative of the given orders, each at most 2, in the two directions.
    ///
    /// # Panics
    /// If an order is above 2.
    #[must_use]
    pub fn derivative(&self, at: [f64; 2], orders: [usize; 2]) -> Vector3<f64> {
        let located = at.map(|t| locate(self.spans, t));
        let rows: [[f64; 4]; 2] = std::array::from_fn(|axis| {
            let basis = [weights, slopes, curvatures][orders[axis]];
            basis(located[axis].1).map(|b| b * (self.spans as f64).powi(orders[axis] as i32))
        });
        let mut sum = Vector3::zeros();
        for (q, w) in rows[1].iter().enumerate() {
            let line = located[0].0 + (self.spans + 3) * (located[1].0 + q);
            for (p, v) in rows[0].iter().enumerate() {
                sum += self.points[line + p].coords * (v * w);
            }
        }
        sum
    }

    /// Returns the position at a parameter.
    #[must_use]
    pub fn position(&self, at: [f64; 2]) -> Point3<f64> {
        Point3::from(self.derivative(at, [0; 2]))
    }

    /// The 16 Bézier points of one span, the first index fastest.
    pub(crate) fn bezier_span(&self, span: [usize; 2]) -> Vec<Point3<f64>> {
        let size = self.spans + 3;
        let at = |p: usize| self.points[span[0] + p % 4 + size * (span[1] + p / 4)];
        let mut values: Vec<f64> = (0..16).map(at).flat_map(|p| [p.x, p.y, p.z]).collect();
        for axis in 0..2 {
            let rows = span_restriction(0.0, 1.0);
            values = Axis::of(&[4; 2], axis, 3).apply(&[0; 4], &rows, &values);
        }
        let points = values.chunks_exact(3);
        points.map(|c| Point3::new(c[0], c[1], c[2])).collect()
    }

    /// Returns the surface as one bicubic Bézier quad for each span, the first index fastest.
    ///
    /// # Panics
    /// Never: the points fill all cells.
    #[must_use]
    pub fn bezier_cells(&self) -> BezierCells {
        let n = self.spans;
        let points = (0..n * n).flat_map(|at| self.bezier_span([at % n, at / n]));
        let cells = BezierCells::build(CellShape::Quads, [3, 3, 0], points.collect(), None);
        cells.expect("16 points for each span")
    }
}
