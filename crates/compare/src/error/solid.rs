//! Why a solid has no result, and which exit code says so.

use std::path::PathBuf;

use msplines_trivariate::FitError;
use msplines_trivariate::cylinder::CylinderError;
use msplines_trivariate::domain::DomainError;
use msplines_trivariate::domain::boundary::BoundaryError;
use msplines_trivariate::domain::mesher::MesherError;
use msplines_trivariate::domain::volume::VolumeError;
use msplines_trivariate::solid::SolidError;
use msplines_trivariate::spline::SplineError;

use super::exit;

/// Why a solid has no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TrivariateError {
    /// The fit failed.
    #[error("trivariate: {0}")]
    Solid(#[from] SolidError),
    /// The solid has no cylindrical parameters.
    #[error("trivariate, cylinder: {0}")]
    Cylinder(#[from] CylinderError),
    /// An option of the harness that means nothing.
    #[error("{option} is {value}; give {range}")]
    Option {
        /// The option.
        option: &'static str,
        /// Its value.
        value: String,
        /// What it must be.
        range: &'static str,
    },
    /// Control points that cannot be moved.
    #[error("--move: {0}")]
    Move(SplineError),
    /// Something that solids have and surfaces have not.
    #[error("{method} has no {what}; give the spline file of a trivariate spline")]
    SolidOnly {
        /// What was asked for.
        what: &'static str,
        /// The method.
        method: &'static str,
    },
    /// An output whose format is unknown for solids.
    #[error(
        "{}: the extension is none of .json, .vtu, .hex.vtu, .xml, .msh, .mesh, .ply, .obj, .glb, .npy; give one of them",
        path.display()
    )]
    Output {
        /// The output.
        path: PathBuf,
    },
    /// An output that does not hold single points.
    #[error("{}: points of --at are written as .npy or .csv; give one of them", path.display())]
    PointOutput {
        /// The output.
        path: PathBuf,
    },
    /// The program `tetgen` is not there.
    #[error(
        "--tetgen: the program `tetgen` is not installed; install it (`apt install tetgen`), or leave out --tetgen, as this program has a mesher of its own"
    )]
    NoTetgen,
    /// The program `tetgen` gave no mesh.
    #[error("--tetgen: {reason}; leave out --tetgen, as this program has a mesher of its own")]
    Tetgen {
        /// What went wrong.
        reason: String,
    },
}

impl TrivariateError {
    /// Returns the exit code that stands for this error.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Solid(SolidError::Domain(error)) => domain_exit_code(error),
            Self::Solid(SolidError::Fit(
                FitError::Levels { .. }
                | FitError::TooFine { .. }
                | FitError::TooManySamples { .. }
                | FitError::Number { .. }
                | FitError::Weight { .. },
            ))
            | Self::Option { .. }
            | Self::Move(_)
            | Self::SolidOnly { .. }
            | Self::Output { .. }
            | Self::PointOutput { .. }
            | Self::NoTetgen => exit::USAGE,
            Self::Solid(_) | Self::Cylinder(_) | Self::Tetgen { .. } => exit::METHOD,
        }
    }
}

/// Corners and options that cannot be are told from inputs that are refused, and both from those that no
/// map exists for.
fn domain_exit_code(error: &DomainError) -> u8 {
    match error {
        DomainError::NoVertex { .. }
        | DomainError::CloseCorners { .. }
        | DomainError::Mesher(MesherError::Number { .. } | MesherError::TooFine { .. })
        | DomainError::Volume(
            VolumeError::Number { .. }
            | VolumeError::CornerInside { .. }
            | VolumeError::Boundary(
                BoundaryError::Number { .. }
                | BoundaryError::NoVertex { .. }
                | BoundaryError::SameSpot { .. },
            ),
        ) => exit::USAGE,
        DomainError::Mesher(MesherError::NotFinite { .. })
        | DomainError::Volume(
            VolumeError::NotPositive { .. }
            | VolumeError::NotFinite { .. }
            | VolumeError::Boundary(BoundaryError::NotFinite { .. } | BoundaryError::FlatFace { .. }),
        ) => exit::INPUT,
        _ => exit::METHOD,
    }
}
