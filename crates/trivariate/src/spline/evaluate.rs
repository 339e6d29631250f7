//! Positions and derivatives at parameters.

use msplines_common::bspline::{Axis, curvatures, locate, slopes, weights};
use msplines_common::evaluate::{
    EvaluateError, Evaluator, Order, Samples, VolumePoint, VolumeSpline,
};
use msplines_common::{Point3, Vector3};
use rayon::prelude::*;

use super::TrivariateSpline;

/// Points that one task evaluates.
const BATCH: usize = 1024;

/// Position and derivatives at a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// The position.
    pub value: Point3<f64>,
    /// Derivatives by the three parameters.
    pub first: [Vector3<f64>; 3],
    /// Second derivatives `uu, uv, uw, vv, vw, ww`.
    pub second: [Vector3<f64>; 6],
}

impl Jet {
    /// The determinant of the first derivatives: how volume changes from the parameters to the
    /// solid.
    #[must_use]
    pub fn determinant(&self) -> f64 {
        self.first[0].dot(&self.first[1].cross(&self.first[2]))
    }
}

/// Where a point lies in the lattice, and the basis functions there, for each direction and order.
#[derive(Clone, Copy, Debug)]
struct Row {
    span: [usize; 3],
    basis: [[[f64; 4]; 3]; 3],
}

impl Row {
    fn at(spans: usize, parameter: [f64; 3], order: Order) -> Self {
        let (mut span, mut basis) = ([0; 3], [[[0.0; 4]; 3]; 3]);
        let scale = spans as f64;
        for axis in 0..3 {
            let (s, x) = locate(spans, parameter[axis]);
            span[axis] = s;
            basis[0][axis] = weights(x);
            if order >= Order::First {
                basis[1][axis] = slopes(x).map(|d| d * scale);
            }
            if order >= Order::Second {
                basis[2][axis] = curvatures(x).map(|d| d * scale * scale);
            }
        }
        Self { span, basis }
    }

    /// Derivative of the given order in each direction, over the 64 control points of the span.
    fn apply(&self, block: &[[Point3<f64>; 4]; 16], orders: [usize; 3]) -> Vector3<f64> {
        let [u, v, w] = [0, 1, 2].map(|axis| self.basis[orders[axis]][axis]);
        let mut sum = Vector3::zeros();
        for (jk, line) in block.iter().enumerate() {
            let factor = v[jk % 4] * w[jk / 4];
            for (point, weight) in line.iter().zip(u) {
                sum += point.coords * (factor * weight);
            }
        }
        sum
    }
}

impl TrivariateSpline {
    /// Returns the position at a parameter; one outside of the unit cube is moved to its nearest
    /// point.
    #[must_use]
    pub fn position(&self, parameter: [f64; 3]) -> Point3<f64> {
        let row = Row::at(self.spans, parameter, Order::Value);
        Point3::from(row.apply(&self.block(row.span), [0; 3]))
    }

    /// Returns position, first and second derivatives at a parameter; one outside of the unit cube
    /// is moved to its nearest point.
    #[must_use]
    pub fn jet(&self, parameter: [f64; 3]) -> Jet {
        let row = Row::at(self.spans, parameter, Order::Second);
        let block = self.block(row.span);
        Jet {
            value: Point3::from(row.apply(&block, [0; 3])),
            first: FIRST.map(|orders| row.apply(&block, orders)),
            second: SECOND.map(|orders| row.apply(&block, orders)),
        }
    }

    /// The 64 control points that act on a span, by lines of the first index.
    pub(crate) fn block(&self, span: [usize; 3]) -> [[Point3<f64>; 4]; 16] {
        let size = self.size();
        std::array::from_fn(|jk| {
            let start = span[0] + size * (span[1] + jk % 4 + size * (span[2] + jk / 4));
            std::array::from_fn(|i| self.points[start + i])
        })
    }

    /// Returns the positions at a regular grid of `cells + 1` parameters in each direction, the first
    /// varying fastest, ends included.
    #[must_use]
    pub fn grid(&self, cells: usize) -> Vec<Point3<f64>> {
        let (first, rows) = grid_rows(self.spans, cells);
        let (mut sizes, mut values) = ([self.size(); 3], self.flat());
        for axis in (0..3).rev() {
            values = Axis::of(&sizes, axis, 3).apply(&first, &rows, &values);
            sizes[axis] = first.len();
        }
        let points = values.chunks_exact(3);
        points.map(|c| Point3::new(c[0], c[1], c[2])).collect()
    }
}

/// Spans and basis functions at `cells + 1` parameters from 0 to 1.
pub(crate) fn grid_rows(spans: usize, cells: usize) -> (Vec<usize>, Vec<[f64; 4]>) {
    let step = |i: usize| {
        if cells == 0 {
            0.0
        } else {
            i as f64 / cells as f64
        }
    };
    let at = |i| locate(spans, step(i));
    (0..=cells).map(|i| (at(i).0, weights(at(i).1))).unzip()
}

const FIRST: [[usize; 3]; 3] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const SECOND: [[usize; 3]; 6] = [
    [2, 0, 0],
    [1, 1, 0],
    [1, 0, 1],
    [0, 2, 0],
    [0, 1, 1],
    [0, 0, 2],
];

/// Prepared points of a spline.
struct Prepared<'a> {
    spline: &'a TrivariateSpline,
    rows: Vec<Row>,
    order: Order,
}

impl VolumeSpline for TrivariateSpline {
    fn prepare(
        &self,
        points: &[VolumePoint],
        order: Order,
    ) -> Result<Box<dyn Evaluator + '_>, EvaluateError> {
        let outside = |p: &VolumePoint| !p.at.iter().all(|t| (0.0..=1.0).contains(t));
        if let Some(point) = points.iter().position(outside) {
            return Err(EvaluateError::OutsideCube { point });
        }
        let row = |p: &VolumePoint| Row::at(self.spans, p.at, order);
        Ok(Box::new(Prepared {
            spline: self,
            rows: points.iter().map(row).collect(),
            order,
        }))
    }
}

impl Prepared<'_> {
    /// Writes the given derivatives of all points, one point after another.
    fn write<const N: usize>(&self, orders: [[usize; 3]; N], out: &mut Vec<f64>) {
        out.resize(self.rows.len() * 3 * N, 0.0);
        out.par_chunks_mut(BATCH * 3 * N)
            .zip(self.rows.par_chunks(BATCH))
            .for_each(|(numbers, rows)| {
                for (row, out) in rows.iter().zip(numbers.chunks_exact_mut(3 * N)) {
                    let block = self.spline.block(row.span);
                    for (order, out) in orders.iter().zip(out.chunks_exact_mut(3)) {
                        out.copy_from_slice(row.apply(&block, *order).as_slice());
                    }
                }
            });
    }
}

impl Evaluator for Prepared<'_> {
    fn evaluate(&self, out: &mut Samples) {
        out.dimension = 3;
        self.write([[0; 3]], &mut out.values);
        out.first.clear();
        out.second.clear();
        if self.order >= Order::First {
            self.write(FIRST, &mut out.first);
        }
        if self.order >= Order::Second {
            self.write(SECOND, &mut out.second);
        }
    }
}
