//! Why there is no explicit representation.

use msplines_common::evaluate::EvaluateError;

use crate::{CombineError, FitError, PartsError};

/// Why an explicit basis, or what is asked of it, does not exist.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExplicitError {
    /// The share of the neighbours makes the basis singular.
    #[error(
        "neighbours cannot have the share {share} of a control point; give at least 0 and less than 0.5"
    )]
    Share {
        /// The share.
        share: f64,
    },
    /// Difference masks are made of Green's functions, which creases do not have.
    #[error("splines with creases have no difference masks; choose another kind of basis")]
    Creases,
    /// Difference masks need all Green's functions at once.
    #[error(
        "difference masks of {knots} knots on {vertices} vertices need {} GB; use fewer knots, or the joint basis",
        numbers.div_ceil(1 << 27)
    )]
    TooLarge {
        /// Vertices of the mesh.
        vertices: usize,
        /// Knots.
        knots: usize,
        /// Numbers to be stored.
        numbers: usize,
    },
    /// Difference masks need a ring to reach into.
    #[error("difference masks cannot reach {rings} rings far; give 1 to 8")]
    Rings {
        /// Rings asked for.
        rings: u32,
    },
    /// The observer broke before there was a basis.
    #[error("the basis was stopped before it was complete")]
    Stopped,
    /// A spline of another mesh, Laplacian or creases.
    #[error("the spline lives in another space; build the basis for the space of the spline")]
    OtherSpace,
    /// A spline with other knots.
    #[error(
        "the spline has {found} knots, the basis {expected}, and number {index} is the first that differs; build the basis for the knots of the spline"
    )]
    OtherKnots {
        /// Index of the first knot that differs.
        index: usize,
        /// Knots of the spline.
        found: usize,
        /// Knots of the basis.
        expected: usize,
    },
    /// There is no such basis function or control point.
    #[error("there is no control point {index}; the basis has {knots}, counted from 0")]
    NoSuchControlPoint {
        /// The index.
        index: usize,
        /// Control points there are.
        knots: usize,
    },
    /// Control points or a displacement have the wrong number of components.
    #[error("{found} numbers were given instead of {expected}; give one for each component")]
    Length {
        /// Numbers given.
        found: usize,
        /// Numbers expected.
        expected: usize,
    },
    /// A number is NaN or infinite.
    #[error("number {index} is not finite; remove or replace it")]
    NotFinite {
        /// Index into the numbers given.
        index: usize,
    },
    /// The knots or the mesh do not make splines.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The spline cannot be evaluated.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// An edited spline cannot be added up.
    #[error(transparent)]
    Combine(#[from] CombineError),
    /// The numbers found do not make a spline.
    #[error(transparent)]
    Parts(#[from] PartsError),
}
