//! Why there is no spline.

use msplines_common::linalg::{FactorError, OrderingError};

use crate::domain::DomainError;

/// Why numbers are not a spline.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SplineError {
    /// The numbers do not fit the domain.
    #[error(
        "{values} values and {gradients} derivatives do not fit {vertices} vertices of dimension {dimension}; give {vertices} × {dimension} values, twice as many derivatives, and at least one component"
    )]
    WrongLength {
        /// Values given.
        values: usize,
        /// Derivatives given.
        gradients: usize,
        /// Vertices of the domain.
        vertices: usize,
        /// Components of a value.
        dimension: usize,
    },
    /// A value or derivative is NaN or infinite.
    #[error("the value or a derivative at vertex {vertex} is not finite; replace it")]
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
    /// Something that only surfaces in space have was asked of a function.
    #[error(
        "the spline has {dimension} components; only surfaces of 3 have normals and Bézier cells"
    )]
    NotASurface {
        /// Components of a value.
        dimension: usize,
    },
}

/// Why data cannot be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// There is not one datum for every vertex.
    #[error("{found} data were given for {vertices} vertices; give one for each")]
    DataCount {
        /// Data given.
        found: usize,
        /// Vertices of the domain.
        vertices: usize,
    },
    /// A position or prescribed gradient is NaN, infinite or too large to be squared.
    #[error("the data at vertex {vertex} are not finite or too large; replace them")]
    NotFinite {
        /// The vertex.
        vertex: u32,
    },
    /// A normal is zero or not finite.
    #[error(
        "the normal at vertex {vertex} is zero or not finite; give a direction, or estimate normals"
    )]
    Normal {
        /// The vertex.
        vertex: u32,
    },
    /// A connected part has no vertex with a position.
    #[error("no vertex connected to vertex {vertex} has a position; give at least one")]
    ComponentWithoutPosition {
        /// First vertex of the part.
        vertex: u32,
    },
    /// A weight of the energy makes no sense.
    #[error(
        "the weights {membrane} of the membrane and {thin_plate} of the thin plate must be finite, not negative, and not both zero"
    )]
    Weights {
        /// Weight of the membrane energy.
        membrane: f64,
        /// Weight of the thin-plate energy.
        thin_plate: f64,
    },
    /// The system could not be ordered.
    #[error("the system cannot be ordered: {0}")]
    Ordering(#[from] OrderingError),
    /// The system could not be factored.
    #[error(
        "the system cannot be factored at vertex {vertex}: {source}; give the membrane a weight, or more vertices a position"
    )]
    Factor {
        /// The vertex of the failed row.
        vertex: u32,
        /// What failed.
        source: FactorError,
    },
    /// The numbers found are not a spline.
    #[error("the system has no finite solution: {0}")]
    Spline(#[from] SplineError),
}

/// Why normals cannot be estimated.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NormalError {
    /// All faces at a vertex have no area, or they cancel.
    #[error(
        "the faces around vertex {vertex} say nothing about its normal; give it one, or remove the vertex"
    )]
    Undefined {
        /// The vertex.
        vertex: u32,
    },
}

/// Why a spline cannot be edited.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// A vertex that the domain does not have.
    #[error("there is no vertex {vertex}; the domain has {vertices}")]
    NoSuchVertex {
        /// The vertex.
        vertex: u32,
        /// Vertices of the domain.
        vertices: usize,
    },
    /// A place that the domain does not have.
    #[error("there is no face {face}; the domain has {faces}")]
    NoSuchFace {
        /// The face.
        face: u32,
        /// Faces of the domain.
        faces: usize,
    },
    /// A face is named twice in one refinement.
    #[error("face {face} is to be refined twice; name it once")]
    RepeatedFace {
        /// The face.
        face: u32,
    },
    /// A new vertex at or outside of the corners.
    #[error(
        "a vertex at {at:?} of face {face} would flatten a face; stay inside of the face, or strictly between the ends of an edge"
    )]
    Place {
        /// The face.
        face: u32,
        /// The barycentric coordinates.
        at: [f64; 3],
    },
    /// A normal, an offset or a factor that no surface has.
    #[error(
        "the normal, position or factor for vertex {vertex} is zero or not finite; give a direction, a place, or a positive factor"
    )]
    Value {
        /// The vertex.
        vertex: u32,
    },
    /// The gradient at a vertex spans no tangent plane that could be turned.
    #[error("the spline has no tangent plane at vertex {vertex}; fit it again with a normal there")]
    NoTangentPlane {
        /// The vertex.
        vertex: u32,
    },
    /// The new domain is none.
    #[error(transparent)]
    Domain(#[from] DomainError),
    /// The new numbers are no spline of this kind.
    #[error(transparent)]
    Spline(#[from] SplineError),
    /// The fit at the changed vertices failed.
    #[error(transparent)]
    Fit(#[from] FitError),
}
