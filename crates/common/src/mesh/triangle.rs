//! A triangle mesh: shared topology and positions.

use std::sync::Arc;

use nalgebra::{Point3, Vector3};

use super::topology::{Topology, TopologyError};

/// A point on a surface mesh.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SurfacePoint {
    /// Face the point lies on.
    pub face: u32,
    /// Barycentric coordinates on a triangle; `[s, t, 0]`, bilinear, on a quad.
    pub at: [f64; 3],
}

/// An oriented 2-manifold triangle mesh with or without boundary.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    topology: Arc<Topology>,
    positions: Vec<Point3<f64>>,
}

impl TriangleMesh {
    /// Builds a mesh.
    ///
    /// # Errors
    /// The first way in which the faces are not an oriented manifold.
    pub fn build(positions: Vec<Point3<f64>>, faces: Vec<[u32; 3]>) -> Result<Self, TopologyError> {
        let topology = Arc::new(Topology::build(positions.len(), faces)?);
        Ok(Self {
            topology,
            positions,
        })
    }

    /// Returns the mesh of a connectivity that is shared; there is one position per vertex.
    pub(super) fn from_shared(topology: Arc<Topology>, positions: Vec<Point3<f64>>) -> Self {
        debug_assert_eq!(topology.vertex_count(), positions.len());
        Self {
            topology,
            positions,
        }
    }

    /// Returns the mesh of the same connectivity with other positions.
    ///
    /// # Panics
    /// If there is not one position per vertex.
    #[must_use]
    pub fn with_positions(&self, positions: Vec<Point3<f64>>) -> Self {
        assert_eq!(
            positions.len(),
            self.positions.len(),
            "one position per vertex"
        );
        Self {
            topology: Arc::clone(&self.topology),
            positions,
        }
    }

    /// Returns the connectivity.
    #[must_use]
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// Returns the position of every vertex.
    #[must_use]
    pub fn positions(&self) -> &[Point3<f64>] {
        &self.positions
    }

    /// Returns the corners of all faces.
    #[must_use]
    pub fn faces(&self) -> &[[u32; 3]] {
        self.topology.faces()
    }

    /// Returns the number of vertices.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// Returns the number of faces.
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.topology.face_count()
    }

    /// Returns the corner positions of a face.
    #[must_use]
    pub fn triangle(&self, face: u32) -> [Point3<f64>; 3] {
        self.faces()[face as usize].map(|v| self.positions[v as usize])
    }

    /// Returns the area-weighted normal of a face: twice its area long.
    #[must_use]
    pub fn face_normal(&self, face: u32) -> Vector3<f64> {
        let [a, b, c] = self.triangle(face);
        (b - a).cross(&(c - a))
    }

    /// Returns the orthonormal frame of a face: along its first side, and to the left of that.
    #[must_use]
    pub fn face_frame(&self, face: u32) -> [Vector3<f64>; 2] {
        let [a, b, _] = self.triangle(face);
        let along = (b - a).normalize();
        [along, self.face_normal(face).cross(&along).normalize()]
    }

    /// Returns the position of a surface point.
    #[must_use]
    pub fn position(&self, point: SurfacePoint) -> Point3<f64> {
        let [a, b, c] = self.triangle(point.face).map(|p| p.coords);
        Point3::from(point.at[0] * a + point.at[1] * b + point.at[2] * c)
    }

    /// Returns the smallest and largest corner of the axis-parallel bounding box.
    #[must_use]
    pub fn bounding_box(&self) -> [Point3<f64>; 2] {
        let mut corners = [
            Point3::from([f64::INFINITY; 3]),
            Point3::from([f64::NEG_INFINITY; 3]),
        ];
        for position in &self.positions {
            corners[0] = corners[0].inf(position);
            corners[1] = corners[1].sup(position);
        }
        corners
    }

    /// Returns the diagonal of the bounding box.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        let [low, high] = self.bounding_box();
        (high - low).norm()
    }
}
