//! The surface as Bézier triangles.

use msplines_common::Point3;
use msplines_common::bspline::{BezierCells, CellShape};

use super::PowellSabinSpline;
use crate::element::micro_ordinates;
use crate::error::SplineError;

impl PowellSabinSpline {
    /// Returns the surface as quadratic Bézier triangles, exactly: six per face of the domain, cell
    /// `6 face + micro`.
    ///
    /// # Errors
    /// A spline that is not a surface.
    ///
    /// # Panics
    /// Never: the points fill whole cells.
    pub fn bezier_cells(&self) -> Result<BezierCells, SplineError> {
        self.check_surface()?;
        let mut points = Vec::with_capacity(36 * self.domain.mesh().face_count());
        for face in 0..self.domain.mesh().face_count() as u32 {
            let [x, y, z] = [0, 1, 2].map(|c| self.ordinates(face, c));
            for micro in 0..6 {
                let [p, q, r, pq, qr, pr] = micro_ordinates(micro);
                // The power of the second corner varies fastest.
                points.extend([p, pq, q, pr, qr, r].map(|at| Point3::new(x[at], y[at], z[at])));
            }
        }
        Ok(
            BezierCells::build(CellShape::Triangles, [2, 0, 0], points, None)
                .expect("six points per cell"),
        )
    }
}
