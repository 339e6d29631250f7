//! T-splines: control points on a space.
//!
//! ```
//! use std::f64::consts::TAU;
//! use std::sync::Arc;
//!
//! use msplines_common::Vector3;
//! use msplines_common::evaluate::Order;
//! use msplines_t_spline::caps::CapOptions;
//! use msplines_t_spline::complex::{CylinderComplex, Point};
//! use msplines_t_spline::tmesh::{Axis, Grading, Grid, TMesh};
//! use msplines_t_spline::{TSpline, TSplineSpace};
//!
//! // A torus of 1 by 1 in units of 2^-44, with 8 by 8 faces, of which one is split.
//! let one = 1_i64 << 44;
//! let complex = Arc::new(CylinderComplex::torus(one, one, 0)?);
//! let grid = Grid { columns: 8, rows: 8 };
//! let mut mesh = TMesh::build(&complex, &[grid])?;
//! mesh.refine(&[(5, Axis::Both)], &Grading::default());
//! let space = Arc::new(TSplineSpace::build(mesh, &CapOptions::default())?);
//! assert_eq!(space.unknowns(), 64 + 5);
//! let control = space.functions().iter().map(|f| {
//!     let [a, b] = [f.node.x, f.node.y].map(|c| c as f64 / one as f64 * TAU);
//!     let r = 2.0 + b.cos();
//!     Vector3::new(r * a.cos(), r * a.sin(), b.sin())
//! });
//! let spline = TSpline::new(Arc::clone(&space), control.collect());
//! let point = Point { cylinder: 0, x: 0.3 * one as f64, y: 0.0 };
//! let samples = spline.evaluate(&[point], Order::First);
//! // Splines lie inside of their control nets.
//! let radius = samples.positions[0].coords.norm();
//! assert!(2.5 < radius && radius < 3.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#[cfg(test)]
mod refinement;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use msplines_common::evaluate::Order;
use msplines_common::{Point3, Vector3};
use rayon::prelude::*;

use crate::complex::Point;
use crate::space::{Row, Rows, TSplineSpace};

/// Points evaluated at a time.
const BATCH: usize = 1 << 14;

/// A surface: one control point per function, one coefficient vector per monomial of a cap.
#[derive(Clone, Debug, PartialEq)]
pub struct TSpline {
    space: Arc<TSplineSpace>,
    control: Vec<Vector3<f64>>,
}

/// Points of a surface and its derivatives by `x` and `y`, in units of the form's 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceSamples {
    /// Positions.
    pub positions: Vec<Point3<f64>>,
    /// Derivatives by `x` and `y`; empty if not asked for.
    pub first: Vec<[Vector3<f64>; 2]>,
    /// Derivatives by `xx`, `xy`, `yy`; empty if not asked for.
    pub second: Vec<[Vector3<f64>; 3]>,
}

impl TSpline {
    /// Returns the surface of control vectors.
    ///
    /// # Panics
    /// If there is not one per unknown of the space.
    #[must_use]
    pub fn new(space: Arc<TSplineSpace>, control: Vec<Vector3<f64>>) -> Self {
        assert_eq!(control.len(), space.unknowns(), "one vector per unknown");
        Self { space, control }
    }

    /// Returns the space.
    #[must_use]
    pub fn space(&self) -> &Arc<TSplineSpace> {
        &self.space
    }

    /// Returns the control vectors: points of functions, then coefficients of caps.
    #[must_use]
    pub fn control(&self) -> &[Vector3<f64>] {
        &self.control
    }

    /// Returns positions and, up to an order, derivatives at points.
    ///
    /// # Panics
    /// If a point names a cylinder that is not there.
    #[must_use]
    pub fn evaluate(&self, points: &[Point], order: Order) -> SurfaceSamples {
        let mut out = SurfaceSamples::default();
        let mut rows = Rows::default();
        for batch in points.chunks(BATCH) {
            self.space.rows_into(batch, order, &mut rows);
            self.apply(&rows, order, &mut out);
        }
        out
    }

    /// Adds the samples of rows to others; the rows must be those of the space.
    ///
    /// # Panics
    /// If rows have unknowns that the space does not have, or lack derivatives.
    pub fn apply(&self, rows: &Rows, order: Order, out: &mut SurfaceSamples) {
        let all = || (0..rows.len()).into_par_iter().with_min_len(256);
        let position = |i| Point3::from(self.sum(rows.row(i), |row, k| row.values[k]));
        out.positions.par_extend(all().map(position));
        if order >= Order::First {
            let first = |i| [0, 1].map(|d| self.sum(rows.row(i), |row, k| row.first[k][d]));
            out.first.par_extend(all().map(first));
        }
        if order >= Order::Second {
            let second = |i| [0, 1, 2].map(|d| self.sum(rows.row(i), |row, k| row.second[k][d]));
            out.second.par_extend(all().map(second));
        }
    }

    #[inline]
    fn sum(&self, row: Row<'_>, factor: impl Fn(&Row<'_>, usize) -> f64) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        for (k, &unknown) in row.unknowns.iter().enumerate() {
            sum += self.control[unknown as usize] * factor(&row, k);
        }
        sum
    }
}
