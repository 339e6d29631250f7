//! Why there is no spline.

use msplines_common::linalg::{FactorError, OrderingError};
use msplines_common::operators::PoissonError;
use msplines_common::operators::intrinsic::IntrinsicError;

/// Why data cannot be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// More knots than vertices, or none.
    #[error(
        "{knots} knots were asked for, but the mesh has {vertices} vertices; choose between 1 and {vertices}"
    )]
    KnotCount {
        /// Knots asked for.
        knots: usize,
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// A given knot is not a vertex.
    #[error("knot {index} is vertex {vertex}, but the mesh has {vertices} vertices")]
    NoSuchKnot {
        /// Index into the given knots.
        index: usize,
        /// Vertex it names.
        vertex: u32,
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// A knot is given twice.
    #[error("vertex {vertex} is given as a knot more than once; give each knot once")]
    RepeatedKnot {
        /// The vertex.
        vertex: u32,
    },
    /// The data does not fit the mesh.
    #[error(
        "{values} values were given for {vertices} vertices of dimension {dimension}; give {vertices} × {dimension} values"
    )]
    DataLength {
        /// Values given.
        values: usize,
        /// Vertices of the mesh.
        vertices: usize,
        /// Components of a value.
        dimension: usize,
    },
    /// A datum is NaN or infinite.
    #[error(
        "component {component} of the data at vertex {vertex} is {value}; remove or replace it"
    )]
    DataNotFinite {
        /// The vertex.
        vertex: usize,
        /// The component.
        component: usize,
        /// Its value.
        value: f64,
    },
    /// The surface is not connected.
    #[error(
        "the mesh has {components} components, but a spline lives on one; keep the largest (`--repair`) or fit them one by one"
    )]
    NotConnected {
        /// Number of components.
        components: u32,
    },
    /// A face has no area, so that its cotangents do not exist.
    #[error(
        "vertex {vertex} has area {area} and its Laplacian row is not finite; remove degenerate faces (`--repair`) or use the intrinsic Delaunay Laplacian (`--intrinsic-delaunay`)"
    )]
    DegenerateGeometry {
        /// The vertex.
        vertex: usize,
        /// Its area.
        area: f64,
    },
    /// The intrinsic Delaunay triangulation does not exist.
    #[error(transparent)]
    Intrinsic(#[from] IntrinsicError),
    /// No elimination order.
    #[error(transparent)]
    Ordering(#[from] OrderingError),
    /// A factorisation failed.
    #[error(transparent)]
    Factor(#[from] FactorError),
    /// The Laplacian could not be factored.
    #[error(transparent)]
    Poisson(#[from] PoissonError),
}
