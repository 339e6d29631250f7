//! What can be said about a tetrahedral mesh in numbers.

use serde::{Deserialize, Serialize};

use super::cell::dihedral_angles;
use super::mesh::TetMesh;
use crate::mesh::facts::Range;

/// Counts, topology and sizes of a tetrahedral mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TetFacts {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of edges.
    pub edges: usize,
    /// Number of faces, those inside counted once.
    pub faces: usize,
    /// Number of cells.
    pub cells: usize,
    /// Number of connected components.
    pub components: u32,
    /// Vertices minus edges plus faces minus cells: 1 for a ball.
    pub euler_characteristic: i64,
    /// Number of vertices on the boundary.
    pub boundary_vertices: usize,
    /// Number of faces on the boundary.
    pub boundary_faces: usize,
    /// Number of connected surfaces that bound the solid.
    pub boundary_components: u32,
    /// Vertices minus edges plus faces of the boundary: 2 for a sphere.
    pub boundary_euler_characteristic: i64,
    /// Number of handles of the boundary; `None` if it is several surfaces.
    pub boundary_genus: Option<u32>,
    /// Number of cells that are inverted or flat, decided exactly.
    pub not_positive: usize,
    /// Smallest and largest corner of the axis-parallel bounding box.
    pub bounding_box: [[f64; 3]; 2],
    /// Diagonal of the bounding box.
    pub diagonal: f64,
    /// Volume of all cells; inverted ones count negative.
    pub volume: f64,
    /// Area of the boundary.
    pub boundary_area: f64,
    /// Volumes of cells.
    pub cell_volume: Range,
    /// Lengths of edges.
    pub edge_length: Range,
    /// Dihedral angles of cells at their edges, in radians.
    pub dihedral_angle: Range,
    /// Smallest dihedral angle of each cell.
    pub smallest_dihedral_angle: Range,
}

impl TetFacts {
    /// Returns the facts of a mesh, in O(n).
    #[must_use]
    pub fn measure(mesh: &TetMesh) -> Self {
        let topology = mesh.topology();
        let boundary = mesh.boundary();
        let (_, boundary_components) = topology.boundary().components();
        let boundary_euler_characteristic = topology.boundary().euler_characteristic();
        let genus = ((2 - boundary_euler_characteristic) / 2) as u32;
        let cells = 0..mesh.cell_count() as u32;
        let volumes = cells.clone().map(|cell| mesh.signed_volume(cell));
        let angles: Vec<[f64; 6]> = cells
            .map(|cell| dihedral_angles(&mesh.tetrahedron(cell)))
            .collect();
        let smallest = |angles: &[f64; 6]| angles.iter().copied().fold(f64::INFINITY, f64::min);
        let length = |&[a, b]: &[u32; 2]| {
            (mesh.positions()[b as usize] - mesh.positions()[a as usize]).norm()
        };
        let faces = 0..boundary.face_count() as u32;
        Self {
            vertices: mesh.vertex_count(),
            edges: topology.edges().len(),
            faces: topology.face_count(),
            cells: mesh.cell_count(),
            components: topology.components().1,
            euler_characteristic: topology.euler_characteristic(),
            boundary_vertices: boundary.vertex_count(),
            boundary_faces: boundary.face_count(),
            boundary_components,
            boundary_euler_characteristic,
            boundary_genus: (boundary_components == 1).then_some(genus),
            not_positive: mesh.not_positive().len(),
            bounding_box: mesh.bounding_box().map(|p| p.coords.data.0[0]),
            diagonal: mesh.diagonal(),
            volume: volumes.clone().sum(),
            boundary_area: faces.map(|f| 0.5 * boundary.face_normal(f).norm()).sum(),
            cell_volume: Range::of(volumes),
            edge_length: Range::of(topology.edges().iter().map(length)),
            dihedral_angle: Range::of(angles.iter().flatten().copied()),
            smallest_dihedral_angle: Range::of(angles.iter().map(smallest)),
        }
    }
}
