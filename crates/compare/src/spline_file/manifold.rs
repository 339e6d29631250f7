//! Sparse manifolds in spline files.

use msplines_common::Point3;
use msplines_common::mesh::polygon::PolygonMesh;
use msplines_sparse_manifold::{DictionaryKind, SparseManifold};
use serde::{Deserialize, Serialize};

use super::LARGEST;
use crate::error::SplineFileError;

/// A polygon mesh in a spline file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredPolygons {
    /// Position of every vertex.
    pub positions: Vec<[f64; 3]>,
    /// Corners of every face, zero-based.
    pub faces: Vec<Vec<u32>>,
}

impl StoredPolygons {
    /// Returns the stored form of a mesh.
    #[must_use]
    pub fn of(mesh: &PolygonMesh) -> Self {
        Self {
            positions: mesh.positions().iter().map(|p| [p.x, p.y, p.z]).collect(),
            faces: mesh.topology().faces().map(<[u32]>::to_vec).collect(),
        }
    }

    /// Returns the mesh.
    ///
    /// # Errors
    /// Positions that are not finite, or faces that are not an oriented manifold.
    pub fn restore(&self) -> Result<PolygonMesh, SplineFileError> {
        let finite = |p: &[f64; 3]| p.iter().all(|x| x.abs() <= LARGEST);
        if let Some(index) = self.positions.iter().position(|p| !finite(p)) {
            return Err(SplineFileError::NotFinite {
                what: "position",
                index,
            });
        }
        let positions = self.positions.iter().map(|&p| Point3::from(p)).collect();
        let mut offsets = vec![0];
        for face in &self.faces {
            offsets.push(offsets[offsets.len() - 1] + face.len() as u32);
        }
        Ok(PolygonMesh::build(positions, self.faces.concat(), offsets)?)
    }
}

/// The charts of a sparse manifold.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredManifold {
    /// What charts are made of.
    pub dictionary: DictionaryKind,
    /// Largest degree of monomials; by the valence where absent.
    pub degree: Option<u32>,
    /// A chart for every vertex.
    pub charts: Vec<StoredChart>,
}

/// The function of a chart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredChart {
    /// Numbers of its atoms.
    pub atoms: Vec<u16>,
    /// Their coefficients, `[atom][coordinate]`.
    pub coefficients: Vec<f64>,
}

impl StoredManifold {
    /// Returns the stored form of a manifold.
    #[must_use]
    pub fn of(spline: &SparseManifold) -> Self {
        let (dictionary, degree) = spline.made_of();
        let charts = 0..spline.mesh().vertex_count() as u32;
        let stored = |chart| {
            let (atoms, coefficients) = spline.chart(chart);
            StoredChart {
                atoms: atoms.to_vec(),
                coefficients: coefficients.to_vec(),
            }
        };
        Self {
            dictionary,
            degree,
            charts: charts.map(stored).collect(),
        }
    }

    /// Returns the manifold over its control mesh.
    ///
    /// # Errors
    /// Charts that do not fit the mesh.
    pub fn restore(&self, mesh: &PolygonMesh) -> Result<SparseManifold, SplineFileError> {
        let charts = self
            .charts
            .iter()
            .cloned()
            .map(|c| (c.atoms, c.coefficients));
        let charts = charts.collect();
        Ok(SparseManifold::from_parts(
            mesh,
            self.dictionary,
            self.degree,
            charts,
        )?)
    }
}
