//! Why a surface has no T-spline, and which exit code says so.

use msplines_common::mesh::TopologyError;
use msplines_t_spline::FitError;
use msplines_t_spline::domain::DomainError;
use msplines_t_spline::edit::EditError;

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
        "--tolerance {given:?}: give a positive fraction of the longest side of the bounding box, such as 0.36%"
    )]
    Tolerance {
        /// What was asked for, as a fraction.
        given: f64,
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
    /// A movement of control points that is none.
    #[error("t-spline: {0}")]
    Edit(#[from] EditError),
    /// A vertex of the input that has no place on the surface.
    #[error(
        "--pull {vertex}: the surface has no such vertex; give one of the input, counted from 0"
    )]
    NotOnSurface {
        /// What was asked for.
        vertex: u32,
    },
    /// A spline of another method.
    #[error(
        "levels, lists and movements of control points by number are for T-splines, and this file holds a {method} spline; give a file that `msplines fit t-spline -o FILE.json` wrote"
    )]
    NotATSpline {
        /// The method of the file.
        method: &'static str,
    },
}

impl TSplineError {
    /// Returns the exit code that stands for this error.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Fit(
                FitError::Budget { .. }
                | FitError::LargeBudget { .. }
                | FitError::Tolerance { .. }
                | FitError::Sampling { .. }
                | FitError::Option { .. },
            )
            | Self::Domain(DomainError::SamePole { .. })
            | Self::Tolerance { .. }
            | Self::NoSuchVertex { .. }
            | Self::Edit(_)
            | Self::NotOnSurface { .. }
            | Self::NotATSpline { .. } => exit::USAGE,
            Self::Fit(FitError::NotFinite { .. }) => exit::INPUT,
            Self::Domain(_) | Self::Fit(_) | Self::Poles(_) => exit::METHOD,
        }
    }
}
