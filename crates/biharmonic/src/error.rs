//! Why there is no spline.

use msplines_common::linalg::{FactorError, OrderingError};
use msplines_common::mesh::SplitError;
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
    /// A crease is no edge of the mesh.
    #[error(
        "crease {index} goes from vertex {from} to vertex {to}, which no edge of the mesh joins; name the two ends of an edge"
    )]
    NoSuchCrease {
        /// Index into the given creases.
        index: usize,
        /// Vertex where it starts.
        from: u32,
        /// Vertex where it ends.
        to: u32,
    },
    /// The angle beyond which edges are creases makes no sense.
    #[error(
        "edges sharper than {degrees:?} degrees cannot be found; give an angle between 0 and 180"
    )]
    CreaseAngle {
        /// The angle.
        degrees: f64,
    },
    /// There is not one weight for every vertex.
    #[error("{found} weights were given for {vertices} vertices; give one for each")]
    WeightCount {
        /// Weights given.
        found: usize,
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// A weight is negative, NaN or infinite.
    #[error(
        "the weight of vertex {vertex} is {weight:?}; give a finite one that is not negative, at most 1e150"
    )]
    Weight {
        /// The vertex.
        vertex: usize,
        /// Its weight.
        weight: f64,
    },
    /// The l1 selection takes all vertices alike.
    #[error("the l1 selection takes no weights; select by exchange, or leave the weights out")]
    WeightsWithL1,
    /// Fewer vertices have a weight than there are knots.
    #[error(
        "only {weighted} vertices have a positive weight, too few for {knots} knots; give more of them a weight or ask for fewer knots"
    )]
    TooFewWeights {
        /// Vertices of positive weight.
        weighted: usize,
        /// Knots asked for.
        knots: usize,
    },
    /// Knots were given at points that are not on the mesh.
    #[error(transparent)]
    Points(#[from] SplitError),
    /// Two knots were given at one place.
    #[error("knots {first} and {second} are at the same place; give each knot once")]
    CoincidentKnots {
        /// Index of one point.
        first: usize,
        /// Index of the other.
        second: usize,
    },
    /// Knots at points of the domain come with a space of their own.
    #[error("this space was built without the points that are to be knots; build it with them")]
    PointsOutsideSpace,
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
    /// A datum is NaN, infinite or too large to be squared.
    #[error(
        "component {component} of the data at vertex {vertex} is {value:?}; remove or replace it"
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
