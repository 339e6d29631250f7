//! A tetrahedral mesh: shared topology and positions.

use std::sync::Arc;

use nalgebra::Point3;
use rayon::prelude::*;

use super::cell::signed_volume;
use super::orientation::{Orientation, orientation};
use super::topology::{TetTopology, TetTopologyError};
use crate::mesh::triangle::TriangleMesh;

/// Why the boundary of a solid is not a sphere.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NotSphere {
    /// The boundary is in several pieces.
    #[error(
        "the boundary is {pieces} surfaces; the second has vertex {vertex}: fill the voids inside, or give one solid"
    )]
    SeveralSurfaces {
        /// Number of surfaces.
        pieces: u32,
        /// A vertex of the second surface.
        vertex: u32,
    },
    /// The boundary has handles.
    #[error("the boundary has genus {genus}, not 0; give a solid without tunnels or handles")]
    Genus {
        /// Number of handles.
        genus: u32,
    },
}

/// An oriented tetrahedral mesh of a solid whose boundary is a surface.
///
/// Its topology is checked, its positions are not: a map of the solid may invert cells, which
/// [`Self::not_positive`] lists.
#[derive(Clone, Debug)]
pub struct TetMesh {
    topology: Arc<TetTopology>,
    positions: Vec<Point3<f64>>,
}

impl TetMesh {
    /// Builds a mesh.
    ///
    /// # Errors
    /// The first way in which the cells are not an oriented solid whose boundary is a surface.
    pub fn build(
        positions: Vec<Point3<f64>>,
        cells: Vec<[u32; 4]>,
    ) -> Result<Self, TetTopologyError> {
        let topology = Arc::new(TetTopology::build(positions.len(), cells)?);
        Ok(Self {
            topology,
            positions,
        })
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
    pub fn topology(&self) -> &TetTopology {
        &self.topology
    }

    /// Returns the position of every vertex.
    #[must_use]
    pub fn positions(&self) -> &[Point3<f64>] {
        &self.positions
    }

    /// Returns the corners of all cells.
    #[must_use]
    pub fn cells(&self) -> &[[u32; 4]] {
        self.topology.cells()
    }

    /// Returns the number of vertices.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// Returns the number of cells.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.topology.cell_count()
    }

    /// Returns the corner positions of a cell.
    #[must_use]
    pub fn tetrahedron(&self, cell: u32) -> [Point3<f64>; 4] {
        self.cells()[cell as usize].map(|v| self.positions[v as usize])
    }

    /// Returns the volume of a cell, negative if it is inverted.
    #[must_use]
    pub fn signed_volume(&self, cell: u32) -> f64 {
        signed_volume(&self.tetrahedron(cell))
    }

    /// Returns the inverted and the flat cells, ascending, decided exactly.
    #[must_use]
    pub fn not_positive(&self) -> Vec<u32> {
        (0..self.cell_count() as u32)
            .into_par_iter()
            .filter(|&cell| orientation(&self.tetrahedron(cell)) != Orientation::Positive)
            .collect()
    }

    /// Returns the boundary, oriented outwards, over the vertices
    /// [`TetTopology::boundary_vertices`] in that order; its connectivity is shared.
    #[must_use]
    pub fn boundary(&self) -> TriangleMesh {
        let vertices = self.topology.boundary_vertices().iter();
        let positions = vertices.map(|&v| self.positions[v as usize]).collect();
        TriangleMesh::from_shared(Arc::clone(self.topology.boundary()), positions)
    }

    /// Checks that the boundary is one sphere, as a map of the solid to a ball or a cube needs.
    ///
    /// # Errors
    /// The number of surfaces or handles, if it is not.
    pub fn require_sphere(&self) -> Result<(), NotSphere> {
        let boundary = self.topology.boundary();
        let (labels, pieces) = boundary.components();
        if pieces != 1 {
            let second = labels.iter().position(|&label| label == 1).unwrap_or(0);
            let vertex = self.topology.boundary_vertices()[second];
            return Err(NotSphere::SeveralSurfaces { pieces, vertex });
        }
        match (2 - boundary.euler_characteristic()) / 2 {
            0 => Ok(()),
            genus => Err(NotSphere::Genus {
                genus: genus as u32,
            }),
        }
    }

    /// Returns the smallest and largest corner of the axis-parallel bounding box.
    #[must_use]
    pub fn bounding_box(&self) -> [Point3<f64>; 2] {
        let infinity = Point3::from([f64::INFINITY; 3]);
        self.positions
            .iter()
            .fold([infinity, -infinity], |[low, high], p| {
                [low.inf(p), high.sup(p)]
            })
    }

    /// Returns the diagonal of the bounding box.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        let [low, high] = self.bounding_box();
        (high - low).norm()
    }
}
