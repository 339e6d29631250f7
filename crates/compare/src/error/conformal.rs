//! Why a surface has no conformal atlas, and which exit code says so.

use std::path::PathBuf;

use msplines_conformal::ConformalError;
use msplines_conformal::bounded::PunctureError;

use super::exit;

/// Why a surface has no conformal atlas.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AtlasError {
    /// There is no atlas of this kind.
    #[error("conformal: {0}")]
    Conformal(#[from] ConformalError),
    /// A form of a surface that has only one map.
    #[error(
        "conformal: --form {form}: the surface has genus 0, and only surfaces with handles have forms to choose from; leave out --form"
    )]
    NoChoice {
        /// The form asked for.
        form: String,
    },
    /// An output that does not hold texture.
    #[error(
        "{}: the extension is none of .json, .obj, .ply, .glb, .npy, which hold an atlas; give one of them",
        path.display()
    )]
    Output {
        /// The output.
        path: PathBuf,
    },
}

impl AtlasError {
    /// Returns the exit code that stands for this error.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Conformal(
                ConformalError::ClassCount { .. }
                | ConformalError::ZeroForm
                | ConformalError::Puncture(
                    PunctureError::NoSuchVertex { .. }
                    | PunctureError::OnBoundary { .. }
                    | PunctureError::StarsTouch { .. },
                ),
            )
            | Self::Output { .. } => exit::USAGE,
            Self::Conformal(_) | Self::NoChoice { .. } => exit::METHOD,
        }
    }
}
