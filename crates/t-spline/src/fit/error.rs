//! Why there is no fit.

use crate::caps::CapsError;
use crate::tmesh::TMeshError;

/// A task that has no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// No samples to fit to.
    #[error("there are no samples; give the vertices of the mesh")]
    NoSamples,
    /// A sample that is no point.
    #[error("sample {sample} has a coordinate or a weight that is not finite; remove it")]
    NotFinite {
        /// The sample.
        sample: usize,
    },
    /// A sample on no cylinder of the complex.
    #[error(
        "sample {sample} lies on cylinder {cylinder}, but there are {cylinders}, counted from 0"
    )]
    NoCylinder {
        /// The sample.
        sample: usize,
        /// Its cylinder.
        cylinder: u32,
        /// How many there are.
        cylinders: usize,
    },
    /// Fewer control points than the coarsest T-mesh has.
    #[error(
        "{given} control points are fewer than the coarsest T-mesh of this surface has; allow at least {least}"
    )]
    Budget {
        /// Those allowed.
        given: usize,
        /// Those needed.
        least: usize,
    },
    /// More control points than a fit holds in memory.
    #[error("{given} control points are asked for; ask for at most {most}")]
    LargeBudget {
        /// Those allowed.
        given: usize,
        /// The most.
        most: usize,
    },
    /// A tolerance that no surface meets.
    #[error("the tolerance {given} is not a positive length; give one")]
    Tolerance {
        /// The one given.
        given: f64,
    },
    /// Samples per control point beyond what is of use.
    #[error(
        "{given:?} samples are wanted per control point; give 0, for vertices and poles alone, to {most}"
    )]
    Sampling {
        /// Those wanted.
        given: f64,
        /// The most there may be.
        most: f64,
    },
    /// Options out of their range.
    #[error("{option} must be {range}, not {given:?}")]
    Option {
        /// The option.
        option: &'static str,
        /// What it may be.
        range: &'static str,
        /// What it is.
        given: f64,
    },
    /// A T-mesh that cannot be laid out.
    #[error(transparent)]
    TMesh(#[from] TMeshError),
    /// Caps that cannot be laid out.
    #[error(transparent)]
    Caps(#[from] CapsError),
    /// A system that cannot be solved.
    #[error(
        "the system of {unknowns} unknowns cannot be solved: {reason}; choose another fairness, or allow fewer control points"
    )]
    Solve {
        /// Number of unknowns.
        unknowns: usize,
        /// Why.
        reason: String,
    },
}
