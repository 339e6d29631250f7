//! Why there is no domain.

use msplines_common::mesh::TopologyError;

/// Why vectors along half-edges are not a flat domain.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DomainError {
    /// The faces are not an oriented manifold.
    #[error(transparent)]
    Topology(#[from] TopologyError),
    /// There is nothing to build a spline over.
    #[error("the domain has no face; give at least one")]
    NoFaces,
    /// The points of a planar domain lie on one line, or are fewer than three.
    #[error("{points} points span no triangle; give at least three that are not on one line")]
    NoTriangle {
        /// Points given.
        points: usize,
    },
    /// Two points of a planar domain are the same.
    #[error("point {point} is at the place of an earlier point; give each place once")]
    RepeatedPoint {
        /// The later of the two.
        point: usize,
    },
    /// A coordinate of a vertex or planar point is NaN, infinite or too large to be squared.
    #[error("vertex {vertex} has coordinates that are not finite or too large; replace them")]
    PositionNotFinite {
        /// The vertex.
        vertex: usize,
    },
    /// There is not one vector for every half-edge.
    #[error("{found} edge vectors were given for {half_edges} half-edges; give three per face")]
    VectorCount {
        /// Vectors given.
        found: usize,
        /// Half-edges of the mesh.
        half_edges: usize,
    },
    /// A flat vector is NaN, infinite, or too large or small to be squared.
    #[error(
        "the flat vector of side {side} of face {face} cannot be computed with; scale the domain to lengths near 1, and cut out faces where the form vanishes"
    )]
    VectorNotFinite {
        /// The face.
        face: u32,
        /// Side from corner `side` to the next one.
        side: u32,
    },
    /// Two faces disagree on the flat vector of their common edge.
    #[error(
        "faces {faces:?} disagree on the flat vector of edge ({from}, {to}) by {gap:.1e} of its length; charts are glued by translations, so both must use one 1-form"
    )]
    TwinsDiffer {
        /// Start of the edge.
        from: u32,
        /// End of the edge.
        to: u32,
        /// The two faces.
        faces: [u32; 2],
        /// Length of the sum of both vectors, relative to one.
        gap: f64,
    },
    /// The vectors around a face do not close.
    #[error(
        "the flat vectors around face {face} miss closing by {gap:.1e} of its longest side; the 1-form must be closed"
    )]
    FaceOpen {
        /// The face.
        face: u32,
        /// Length of the sum, relative to the longest vector.
        gap: f64,
    },
    /// A face is flipped or flattened to a line.
    #[error(
        "face {face} of vertices {vertices:?} has the flat area {area:.1e}, which is not positive beyond rounding; flip its longest edge, use intrinsic Delaunay triangles, or cut the face out"
    )]
    FaceNotPositive {
        /// The face.
        face: u32,
        /// Its corners.
        vertices: [u32; 3],
        /// Its signed flat area.
        area: f64,
    },
    /// The flat angles around an inner vertex sum to more than a full turn.
    #[error(
        "the flat angles around vertex {vertex} sum to {turns:.2} full turns; this is a zero of the 1-form: cut out the faces around it"
    )]
    ConePoint {
        /// The vertex.
        vertex: u32,
        /// Sum of the angles over 2π.
        turns: f64,
    },
}
