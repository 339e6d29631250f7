//! Why a surface has no Powell-Sabin spline, and which exit code says so.

use msplines_powell_sabin::{EditError, FitError, SurfaceError};

use super::exit;

/// Why a surface has no Powell-Sabin spline.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PowellSabinError {
    /// The fit failed.
    #[error("powell-sabin: {0}")]
    Surface(#[from] SurfaceError),
    /// A change of it is none.
    #[error("powell-sabin: {0}")]
    Edit(#[from] EditError),
    /// A change of a spline of another method.
    #[error(
        "{method} has no control triangles to change; reshape a spline of `msplines fit powell-sabin`"
    )]
    NotReshaped {
        /// The method.
        method: &'static str,
    },
}

impl PowellSabinError {
    /// Returns the exit code that stands for this error.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Surface(SurfaceError::Fit(FitError::Weights { .. }))
            | Self::Edit(_)
            | Self::NotReshaped { .. } => exit::USAGE,
            Self::Surface(SurfaceError::Fit(
                FitError::Normal { .. } | FitError::NotFinite { .. },
            )) => exit::INPUT,
            Self::Surface(_) => exit::METHOD,
        }
    }
}
