//! Why there is no solid.

use crate::options::MOST_SAMPLES;
use crate::spline::MOST_SPANS;

/// Why a fit has no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// Nothing to fit.
    #[error("there are no samples with a positive weight; give some")]
    NoSamples,
    /// More samples than a fit holds in memory.
    #[error("{samples} samples are asked for; ask for at most {MOST_SAMPLES}")]
    TooManySamples {
        /// What was asked for, inside and on the surface together.
        samples: usize,
    },
    /// Arrays of different lengths.
    #[error("{parameters} parameters, {points} points and {weights} weights; give one of each")]
    Lengths {
        /// Number of parameters.
        parameters: usize,
        /// Number of points.
        points: usize,
        /// Number of weights.
        weights: usize,
    },
    /// A parameter that is not in the unit cube.
    #[error("sample {sample} has no parameter in the unit cube; give three numbers from 0 to 1")]
    Parameter {
        /// The sample.
        sample: usize,
    },
    /// A point that is NaN or infinite.
    #[error("the point of sample {sample} is not finite")]
    Point {
        /// The sample.
        sample: usize,
    },
    /// A weight that is negative or not finite.
    #[error("sample {sample} has the weight {weight}; give a finite one of at least 0")]
    Weight {
        /// The sample.
        sample: usize,
        /// Its weight.
        weight: f64,
    },
    /// Numbers of spans that do not follow from each other by doubling.
    #[error(
        "levels from {coarsest} to {finest} spans; give 1 to {most}, the finest a power of two times the coarsest", most = MOST_SPANS
    )]
    Levels {
        /// Spans of the coarsest level.
        coarsest: usize,
        /// Spans of the finest level.
        finest: usize,
    },
    /// More spans than a fit holds in memory.
    #[error("{spans} spans by least squares; ask for at most {most}")]
    TooFine {
        /// What was asked for.
        spans: usize,
        /// The most.
        most: usize,
    },
    /// An option that means nothing.
    #[error("`{name}` is {value:?}; give a number {range}")]
    Number {
        /// The option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        range: &'static str,
    },
    /// Samples that leave a trilinear map open, such as samples of one plane.
    #[error(
        "the samples do not determine even a trilinear map: their parameters lie on a surface or on too few points; give samples inside of the solid"
    )]
    Undetermined,
    /// A solid turned inside out, which no small change makes valid.
    #[error(
        "the fitted solid has the volume {volume}; exchange two parameters of the samples so that it becomes positive"
    )]
    InsideOut {
        /// Its signed volume.
        volume: f64,
    },
}
