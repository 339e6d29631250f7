//! A part of a mesh as a mesh of its own, and which vertex and face is which.

use msplines_common::mesh::{NONE, TopologyError, TriangleMesh};

/// Some faces of a mesh and their vertices, both in the order of the mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Part {
    /// Face of the mesh by face of the part, ascending.
    pub(super) faces: Vec<u32>,
    /// Vertex of the mesh by vertex of the part, ascending.
    pub(super) vertices: Vec<u32>,
}

impl Part {
    /// Returns the part of these faces, ascending.
    pub(super) fn new(mesh: &TriangleMesh, faces: Vec<u32>) -> Self {
        let corners = faces.iter().flat_map(|&f| mesh.faces()[f as usize]);
        let mut vertices: Vec<u32> = corners.collect();
        vertices.sort_unstable();
        vertices.dedup();
        Self { faces, vertices }
    }

    /// Returns the face of the part that is this one of the mesh.
    pub(super) fn face(&self, face: u32) -> Option<u32> {
        self.faces.binary_search(&face).ok().map(|at| at as u32)
    }

    /// Returns the vertex of the part that is this one of the mesh.
    pub(super) fn vertex(&self, vertex: u32) -> Option<u32> {
        self.vertices
            .binary_search(&vertex)
            .ok()
            .map(|at| at as u32)
    }

    /// Returns the place in the part of every vertex of a mesh of so many, or [`NONE`].
    pub(super) fn places(of: &[u32], count: usize) -> Vec<u32> {
        let mut places = vec![NONE; count];
        for (place, &item) in of.iter().enumerate() {
            places[item as usize] = place as u32;
        }
        places
    }

    /// Returns the part as a mesh.
    pub(super) fn mesh(&self, whole: &TriangleMesh) -> Result<TriangleMesh, TopologyError> {
        let places = Self::places(&self.vertices, whole.vertex_count());
        let corners = |&f: &u32| whole.faces()[f as usize].map(|v| places[v as usize]);
        TriangleMesh::build(
            self.pick(whole.positions()),
            self.faces.iter().map(corners).collect(),
        )
    }

    /// Returns what belongs to the vertices of the part.
    pub(super) fn pick<T: Copy>(&self, by_vertex: &[T]) -> Vec<T> {
        let vertices = self.vertices.iter();
        vertices.map(|&v| by_vertex[v as usize]).collect()
    }

    /// Returns what belongs to the half-edges of the part.
    pub(super) fn pick_sides<T: Copy>(&self, by_half_edge: &[T]) -> Vec<T> {
        let sides = self
            .faces
            .iter()
            .flat_map(|&f| [0, 1, 2].map(|i| 3 * f + i));
        sides.map(|h| by_half_edge[h as usize]).collect()
    }
}
