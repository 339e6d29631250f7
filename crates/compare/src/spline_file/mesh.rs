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
    /// Positions that are not finite, or faces that are not an oriented manifold or twice the same.
    pub fn restore(&self) -> Result<TriangleMesh, SplineFileError> {
        let finite = |p: &[f64; 3]| p.iter().all(|x| x.abs() <= LARGEST);
        if let Some(vertex) = self.positions.iter().position(|p| !finite(p)) {
            return Err(SplineFileError::NotFinite {
                what: "position",
                index: vertex,
            });
        }
        if let Some([first, second]) = self.twin_faces() {
            return Err(SplineFileError::TwinFaces { first, second });
        }
        let positions = self.positions.iter().map(|&p| Point3::from(p)).collect();
        Ok(TriangleMesh::build(positions, self.faces.clone())?)
    }

    /// Returns two faces with the same corners: back to back they are an oriented manifold, but their
    /// subdivision is none.
    fn twin_faces(&self) -> Option<[usize; 2]> {
        let sorted = |(index, face): (usize, &[u32; 3])| {
            let mut corners = *face;
            corners.sort_unstable();
            (corners, index)
        };
        let mut faces: Vec<_> = self.faces.iter().enumerate().map(sorted).collect();
        faces.sort_unstable();
        let pair = faces.windows(2).find(|pair| pair[0].0 == pair[1].0);
        pair.map(|pair| [pair[0].1, pair[1].1])
    }
}
