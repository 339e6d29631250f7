//! Holes where vertices were.

use msplines_common::mesh::{NONE, TopologyError, TriangleMesh};

/// Why stars cannot be removed from a mesh.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PunctureError {
    /// No such vertex.
    #[error("vertex {vertex} does not exist; the mesh has {vertices} vertices, numbered from 0")]
    NoSuchVertex {
        /// The vertex.
        vertex: u32,
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// The vertex, or one beside it, lies on the boundary.
    #[error(
        "the star of vertex {vertex} touches the boundary at vertex {at}; \
         choose a vertex farther inside"
    )]
    OnBoundary {
        /// The vertex.
        vertex: u32,
        /// A vertex of its star on the boundary.
        at: u32,
    },
    /// Two stars share a vertex.
    #[error(
        "the stars of vertices {first} and {second} share vertex {at}; \
         choose vertices at least three edges apart"
    )]
    StarsTouch {
        /// One vertex.
        first: u32,
        /// The other vertex.
        second: u32,
        /// A vertex of both stars.
        at: u32,
    },
    /// What is left is not a manifold.
    #[error("without these stars the mesh is not a manifold: {0}; choose other vertices")]
    NotManifold(#[from] TopologyError),
}

/// Returns the mesh without the stars of some vertices, and the vertex of the mesh that each of its
/// vertices was.
///
/// Every star leaves one boundary loop. Vertices and faces keep their order. O(n).
///
/// # Errors
/// Stars that touch each other or the boundary, and a rest that is not a manifold.
pub fn puncture(
    mesh: &TriangleMesh,
    vertices: &[u32],
) -> Result<(TriangleMesh, Vec<u32>), PunctureError> {
    check(mesh, vertices)?;
    let mut renamed = vec![0; mesh.vertex_count()];
    vertices.iter().for_each(|&v| renamed[v as usize] = NONE);
    let mut origins = Vec::with_capacity(mesh.vertex_count() - vertices.len());
    for (vertex, name) in renamed.iter_mut().enumerate() {
        if *name != NONE {
            *name = origins.len() as u32;
            origins.push(vertex as u32);
        }
    }
    let faces = mesh
        .faces()
        .iter()
        .map(|corners| corners.map(|v| renamed[v as usize]))
        .filter(|corners| !corners.contains(&NONE))
        .collect();
    let positions = origins.iter().map(|&v| mesh.positions()[v as usize]);
    let rest = TriangleMesh::build(positions.collect(), faces)?;
    Ok((rest, origins))
}

fn check(mesh: &TriangleMesh, vertices: &[u32]) -> Result<(), PunctureError> {
    let topology = mesh.topology();
    let mut owner = vec![NONE; mesh.vertex_count()];
    for &vertex in vertices {
        if vertex as usize >= mesh.vertex_count() {
            let vertices = mesh.vertex_count();
            return Err(PunctureError::NoSuchVertex { vertex, vertices });
        }
        for at in std::iter::once(vertex).chain(topology.neighbours(vertex)) {
            if topology.is_boundary_vertex(at) {
                return Err(PunctureError::OnBoundary { vertex, at });
            }
            let first = std::mem::replace(&mut owner[at as usize], vertex);
            if first != NONE {
                let second = vertex;
                return Err(PunctureError::StarsTouch { first, second, at });
            }
        }
    }
    Ok(())
}
