//! Triangle meshes in spline files.

use msplines_common::Point3;
use msplines_common::mesh::TriangleMesh;
use serde::{Deserialize, Serialize};

use super::LARGEST;
use crate::error::SplineFileError;

/// A triangle mesh in a spline file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredMesh {
    /// Position of every vertex.
    pub positions: Vec<[f64; 3]>,
    /// Corners of every face, zero-based.
    pub faces: Vec<[u32; 3]>,
}

impl StoredMesh {
    /// Returns the stored form of a mesh.
    #[must_use]
    pub fn of(mesh: &TriangleMesh) -> Self {
        Self {
            positions: mesh.positions().iter().map(|p| [p.x, p.y, p.z]).collect(),
            faces: mesh.faces().to_vec(),
        }
    }

    /// Returns the mesh.
    ///
    /// # Errors
    /// Positions that are not finite, or faces that are not an oriented manifold.
    pub fn restore(&self) -> Result<TriangleMesh, SplineFileError> {
        let finite = |p: &[f64; 3]| p.iter().all(|x| x.abs() <= LARGEST);
        if let Some(vertex) = self.positions.iter().position(|p| !finite(p)) {
            return Err(SplineFileError::NotFinite {
                what: "position",
                index: vertex,
            });
        }
        let positions = self.positions.iter().map(|&p| Point3::from(p)).collect();
        Ok(TriangleMesh::build(positions, self.faces.clone())?)
    }
}
