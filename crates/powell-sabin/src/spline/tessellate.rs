//! The surface as a mesh of triangles.

use msplines_common::evaluate::EvaluateError;
use msplines_common::mesh::{Lattice, SurfacePoint};
use msplines_common::{Point3, Vector3};

use super::PowellSabinSpline;

/// Points of a surface joined by triangles; neighbouring faces share their points.
#[derive(Clone, Debug)]
pub struct Tessellation {
    /// Where each point is on the domain. The vertices of the domain come first, in their order.
    pub points: Vec<SurfacePoint>,
    /// Positions.
    pub positions: Vec<Point3<f64>>,
    /// Exact unit normals.
    pub normals: Vec<Vector3<f64>>,
    /// Triangles, oriented as the domain.
    pub faces: Vec<[u32; 3]>,
}

impl PowellSabinSpline {
    /// Returns the surface over `segments²` triangles per face of the domain, watertight.
    ///
    /// # Errors
    /// A spline that is not a surface.
    ///
    /// # Panics
    /// If `segments` is zero.
    pub fn tessellate(&self, segments: u32) -> Result<Tessellation, EvaluateError> {
        assert!(segments > 0, "at least one segment per edge");
        let lattice = Lattice::new(self.domain.topology(), segments);
        let normals = self.normals(&lattice.points)?;
        let samples =
            self.evaluate_flat(&lattice.points, msplines_common::evaluate::Order::Value)?;
        let positions = samples.values.chunks_exact(3).map(Point3::from_slice);
        Ok(Tessellation {
            positions: positions.collect(),
            normals,
            faces: lattice.faces(self.domain.mesh().face_count() as u32),
            points: lattice.points,
        })
    }
}
