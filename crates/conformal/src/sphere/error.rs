//! Why a mesh has no spherical map, and the checks that say so.

use msplines_common::linalg::{FactorError, OrderingError};
use msplines_common::mesh::TriangleMesh;
use msplines_common::operators::intrinsic::IntrinsicError;
use msplines_common::progress::Stopped;

/// Why a mesh has no spherical map.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SphereError {
    /// There are no faces.
    #[error("the mesh has no faces; a spherical map needs a closed surface")]
    Empty,
    /// The surface has a boundary.
    #[error(
        "the surface has {loops} boundary loops, one of them through vertex {vertex}; \
         close them, or flatten a disk instead"
    )]
    Boundary {
        /// Number of boundary loops.
        loops: usize,
        /// A vertex on the first of them.
        vertex: u32,
    },
    /// The surface falls into parts.
    #[error("the surface has {components} components; map each of them by itself")]
    Components {
        /// Number of components.
        components: u32,
    },
    /// The surface has handles.
    #[error(
        "the surface has genus {genus}, and only genus 0 maps to the sphere; \
         use holomorphic 1-forms, or close its handles"
    )]
    Genus {
        /// Number of handles.
        genus: i64,
    },
    /// The observer asked to stop before there was a map.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// No intrinsic triangulation.
    #[error(transparent)]
    Intrinsic(#[from] IntrinsicError),
    /// The Laplacian could not be ordered.
    #[error("the Laplacian cannot be ordered: {0}")]
    Ordering(#[from] OrderingError),
    /// The Laplacian could not be factored.
    #[error("the Laplacian cannot be factored: {0}")]
    Factor(#[from] FactorError),
    /// Some triangles are not oriented like the sphere.
    #[error(
        "{flips} triangles are turned over on the sphere, the first of them {corners:?}; \
         keep the triangulation simplicial, or subdivide the mesh there"
    )]
    Flipped {
        /// Number of such triangles.
        flips: usize,
        /// Corners of the first one.
        corners: [u32; 3],
    },
    /// The image winds around the sphere another number of times than once.
    #[error("the image covers the sphere {degree} times; subdivide the mesh and try again")]
    Degree {
        /// The number of times.
        degree: i64,
    },
}

/// Checks that a mesh is a closed surface of genus 0 in one piece.
pub(super) fn check(mesh: &TriangleMesh) -> Result<(), SphereError> {
    let topology = mesh.topology();
    if mesh.face_count() == 0 {
        return Err(SphereError::Empty);
    }
    let loops = topology.boundary_loops();
    if let Some(first) = loops.first() {
        return Err(SphereError::Boundary {
            loops: loops.len(),
            vertex: topology.origin(first[0]),
        });
    }
    let (_, components) = topology.components();
    if components != 1 {
        return Err(SphereError::Components { components });
    }
    match (2 - topology.euler_characteristic()) / 2 {
        0 => Ok(()),
        genus => Err(SphereError::Genus { genus }),
    }
}
