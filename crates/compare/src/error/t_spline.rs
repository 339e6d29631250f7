//! Why a surface has no T-spline, and which exit code says so.

use msplines_common::mesh::TopologyError;
use msplines_t_spline::FitError;
use msplines_t_spline::domain::DomainError;

use super::exit;

/// Why a surface has no T-spline.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TSplineError {
    /// The surface cannot be cut into cylinders.
    #[error("t-spline: {0}")]
    Domain(#[from] DomainError),
    /// The fit failed.
    #[error("t-spline: {0}")]
    Fit(#[from] FitError),
    /// A tolerance that means nothing.
    #[error(
        "--tolerance {given}: give a positive fraction of the longest side of the bounding box, such as 0.36%"
    )]
    Tolerance {
        /// What was asked for, as a fraction.
        given: f64,
    },
    /// Samples per control point beyond what is of use.
    #[error("--face-samples {given}: give 0 to {most} samples per control point")]
    FaceSamples {
        /// What was asked for.
        given: f64,
        /// The most there may be.
        most: f64,
    },
    /// A vertex that the input does not have.
    #[error("--puncture {vertex}: the mesh has {vertices} vertices, counted from 0")]
    NoSuchVertex {
        /// What was asked for.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// Poles that do not close the mesh.
    #[error("t-spline: the surface around its poles is no manifold: {0}; choose other poles")]
    Poles(#[from] TopologyError),
}

impl TSplineError {
    /// Returns the exit code that stands for this error.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Fit(
                FitError::Budget { .. } | FitError::Tolerance { .. } | FitError::Option { .. },
            )
            | Self::FaceSamples { .. }
            | Self::Tolerance { .. }
            | Self::NoSuchVertex { .. } => exit::USAGE,
            Self::Fit(FitError::NotFinite { .. }) => exit::INPUT,
            Self::Domain(_) | Self::Fit(_) | Self::Poles(_) => exit::METHOD,
        }
    }
}
