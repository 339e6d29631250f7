//! Why a surface has no map to the cube.

use msplines_common::linalg::{FactorError, OrderingError};

/// Why a surface was not mapped to that of the cube.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BoundaryError {
    /// The surface has a boundary.
    #[error(
        "the surface is open: it has {loops} boundary loops, the first through vertex {vertex}; close its holes"
    )]
    Open {
        /// Number of boundary loops.
        loops: usize,
        /// A vertex of the first.
        vertex: u32,
    },
    /// The surface is in several pieces.
    #[error("the surface is {pieces} pieces, the second has vertex {vertex}; give one surface")]
    SeveralSurfaces {
        /// Number of pieces.
        pieces: u32,
        /// A vertex of the second.
        vertex: u32,
    },
    /// The surface has handles.
    #[error("the surface has genus {genus}, not 0; give one without tunnels or handles")]
    Genus {
        /// Number of handles.
        genus: u32,
    },
    /// There are fewer vertices than corners.
    #[error("the surface has {vertices} vertices, fewer than a cube; refine it")]
    TooSmall {
        /// Number of vertices.
        vertices: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not finite; repair the surface first")]
    NotFinite {
        /// The vertex.
        vertex: u32,
    },
    /// A face has no area.
    #[error("face {face} with vertices {vertices:?} has no area; repair the surface first")]
    FlatFace {
        /// The face.
        face: u32,
        /// Its vertices.
        vertices: [u32; 3],
    },
    /// A corner is no vertex of the surface.
    #[error(
        "corner {corner} is vertex {vertex}, which is none of the {vertices} vertices of the surface; choose another"
    )]
    NoVertex {
        /// The corner of the cube.
        corner: usize,
        /// The vertex given.
        vertex: u32,
        /// Number of vertices of the surface.
        vertices: usize,
    },
    /// Two corners lie on one spot.
    #[error(
        "corners {} and {} lie on one spot, at vertices {} and {}; choose eight points apart from each other",
        .corners[0], .corners[1], .vertices[0], .vertices[1]
    )]
    SameSpot {
        /// The corners of the cube.
        corners: [usize; 2],
        /// Their vertices.
        vertices: [u32; 2],
    },
    /// No path between two corners keeps clear of the others.
    #[error(
        "no path from corner {} at vertex {} to corner {} at vertex {} keeps clear of the others; move these corners apart from the others",
        .corners[0], .vertices[0], .corners[1], .vertices[1]
    )]
    NoRoute {
        /// The corners of the cube.
        corners: [usize; 2],
        /// Their vertices.
        vertices: [u32; 2],
    },
    /// The paths do not cut the surface like the edges of a cube.
    #[error(
        "the paths do not bound the face {face} of the cube at vertex {vertex}; choose other corners"
    )]
    NotCube {
        /// The face of the cube.
        face: usize,
        /// A vertex where another one lies.
        vertex: u32,
    },
    /// Rounding folded a patch that is squeezed too much.
    #[error(
        "{count} triangles, the first with vertices {vertices:?}, are squeezed below rounding; place a corner nearer to them"
    )]
    Squeezed {
        /// Number of triangles that are not positive.
        count: usize,
        /// Vertices of the first.
        vertices: [u32; 3],
    },
    /// A system of equations has no solution.
    #[error("the harmonic map of the surface failed: {0}")]
    Factor(#[from] FactorError),
    /// A system of equations could not be ordered.
    #[error("the harmonic map of the surface failed: {0}")]
    Ordering(#[from] OrderingError),
    /// An option that means nothing.
    #[error("`{name}` is {value}; give a number {range}")]
    Number {
        /// The option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        range: &'static str,
    },
    /// The observer asked to stop before there was a map.
    #[error("stopped before there was a map of the surface; allow more time")]
    Stopped,
}
