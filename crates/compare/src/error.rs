//! Why a run gives no result, and which exit code says so.

mod conformal;
mod powell_sabin;
mod solid;
mod spline_file;
mod t_spline;

use std::path::{Path, PathBuf};

use msplines_biharmonic::{CombineError, DecomposeError, FitError};
use msplines_common::evaluate::EvaluateError;

use crate::animation::FrameError;
use crate::case::AmountError;

pub use conformal::AtlasError;
pub use powell_sabin::PowellSabinError;
pub use solid::TrivariateError;
pub use spline_file::SplineFileError;
pub use t_spline::TSplineError;

/// The exit codes of the program.
pub mod exit {
    /// A result: converged, stalled or out of iterations.
    pub const SUCCESS: u8 = 0;
    /// The command cannot be meant so.
    pub const USAGE: u8 = 2;
    /// The input is refused.
    pub const INPUT: u8 = 3;
    /// The method cannot take this input.
    pub const METHOD: u8 = 4;
    /// Stopped early; the result so far is written and marked.
    pub const STOPPED: u8 = 5;
}

/// Why a run gives no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// A number of knots that the mesh does not allow.
    #[error("{option}: {source}")]
    Amount {
        /// The option that gave it.
        option: &'static str,
        /// What is wrong with it.
        source: AmountError,
    },
    /// An output whose format is unknown.
    #[error("{}: the extension is none of .ply, .obj, .vtu, .glb, .npy, .json; give one of them", path.display())]
    UnknownOutput {
        /// The output.
        path: PathBuf,
    },
    /// An output that could not be written.
    #[error("cannot write {}: {reason}", path.display())]
    Write {
        /// The output.
        path: PathBuf,
        /// What is wrong and what to do.
        reason: String,
    },
    /// A file that cannot be opened, parsed or accepted.
    #[error("{file}: {reason}")]
    Input {
        /// The file.
        file: String,
        /// What is wrong, with place and remedy.
        reason: String,
    },
    /// A file of points that cannot be the places of knots.
    #[error(
        "--knots-from {file}: {reason}; give a mesh or point file whose vertices are the places"
    )]
    KnotPoints {
        /// The file.
        file: String,
        /// What is wrong.
        reason: String,
    },
    /// A task that another method has.
    #[error("{method} has no {task}; use biharmonic")]
    Task {
        /// The task.
        task: &'static str,
        /// The method.
        method: &'static str,
    },
    /// Something that other methods have.
    #[error("{spline} has no {what}; {remedy}")]
    Without {
        /// What the method makes, with its article.
        spline: &'static str,
        /// What was asked for.
        what: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// Too few or too many segments along a side of a face.
    #[error("--tessellate {segments}: give a number from 1 to 64")]
    Segments {
        /// What was asked for.
        segments: u32,
    },
    /// Data that cannot be split into layers.
    #[error("biharmonic: {0}")]
    Decompose(#[from] DecomposeError),
    /// Splines that cannot be combined.
    #[error("biharmonic: {0}")]
    Combine(#[from] CombineError),
    /// Knots that cannot be put in or taken out.
    #[error("biharmonic: {0}")]
    Knots(#[from] msplines_biharmonic::KnotError),
    /// Basis functions that cannot be built.
    #[error("biharmonic: {0}")]
    Explicit(#[from] msplines_biharmonic::ExplicitError),
    /// A spline that cannot be evaluated.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// Numbers that make no spline.
    #[error("biharmonic: {0}")]
    Parts(#[from] msplines_biharmonic::PartsError),
    /// A file of numbers that does not hold what it should.
    #[error("{option} {file}: {reason}")]
    Array {
        /// The option that names the file.
        option: &'static str,
        /// The file.
        file: String,
        /// What is wrong.
        reason: String,
    },
    /// Frames that the animation does not have.
    #[error("frames: {0}")]
    Frames(#[from] FrameError),
    /// An option of a single surface.
    #[error("{option} is for a single surface, not for data over time; leave it out")]
    NotOverTime {
        /// The option.
        option: &'static str,
    },
    /// An attribute that the file does not have.
    #[error(
        "{file} has no vertex attribute `{name}`; it has: {available}; give such a name, or fit the positions"
    )]
    NoSuchAttribute {
        /// The file.
        file: String,
        /// The attribute asked for.
        name: String,
        /// Those it has.
        available: String,
    },
    /// The biharmonic fit failed.
    #[error("biharmonic: {0}")]
    Biharmonic(#[from] FitError),
    /// The least-squares mesh failed.
    #[error("ls-mesh: {0}")]
    LsMesh(#[from] msplines_ls_mesh::FitError),
    /// The sparse manifold failed.
    #[error("sparse-manifold: {0}")]
    SparseManifold(#[from] msplines_sparse_manifold::FitError),
    /// The surface over a curve network failed.
    #[error("curve-network: {0}")]
    CurveNetwork(#[from] msplines_sparse_manifold::network::NetworkError),
    /// The trivariate spline failed.
    #[error(transparent)]
    Trivariate(#[from] TrivariateError),
    /// The conformal atlas failed.
    #[error(transparent)]
    Atlas(#[from] AtlasError),
    /// The Powell-Sabin spline failed.
    #[error(transparent)]
    PowellSabin(#[from] PowellSabinError),
    /// The T-spline failed.
    #[error(transparent)]
    TSpline(#[from] TSplineError),
    /// The fitted or stored spline could not be evaluated.
    #[error(transparent)]
    Spline(#[from] SplineFileError),
    /// What is wrong with a spline file, or with the spline in it.
    #[error("{file}: {source}")]
    InSplineFile {
        /// The file.
        file: String,
        /// What is wrong.
        source: Box<Self>,
    },
    /// The distance between the surfaces cannot be measured.
    #[error("--distance: {0}")]
    Distance(#[from] msplines_common::metrics::DistanceError),
    /// The spline is not finite everywhere.
    #[error(
        "the spline is not finite at vertex {vertex}: the mesh is too badly shaped for this Laplacian; try --intrinsic-delaunay"
    )]
    NotFinite {
        /// The first such vertex.
        vertex: usize,
    },
}

/// Lets `?` take the errors of a library to the error of its method, and on to [`RunError`].
macro_rules! from_library {
    ($($method:ident: $($source:ty),+;)+) => {$($(
        impl From<$source> for RunError {
            fn from(error: $source) -> Self {
                $method::from(error).into()
            }
        }
    )+)+};
}

from_library! {
    TrivariateError: msplines_trivariate::solid::SolidError,
        msplines_trivariate::cylinder::CylinderError;
    PowellSabinError: msplines_powell_sabin::SurfaceError, msplines_powell_sabin::EditError;
    TSplineError: msplines_t_spline::domain::DomainError, msplines_t_spline::FitError;
}

impl RunError {
    /// Returns the refusal of something that other methods have.
    pub(crate) fn without(spline: &'static str, what: &'static str, remedy: &'static str) -> Self {
        Self::Without {
            spline,
            what,
            remedy,
        }
    }

    /// Returns the error with the name of the spline file that it comes from, unless it names a file or is
    /// about the command.
    pub(crate) fn in_spline_file(self, path: &Path) -> Self {
        let names_file = match &self {
            Self::Input { .. } | Self::Array { .. } | Self::InSplineFile { .. } => true,
            Self::Spline(error) => matches!(error, SplineFileError::Unreadable { .. }),
            _ => false,
        };
        if names_file || self.exit_code() == exit::USAGE {
            return self;
        }
        Self::InSplineFile {
            file: path
                .file_name()
                .unwrap_or(path.as_os_str())
                .to_string_lossy()
                .into_owned(),
            source: Box::new(self),
        }
    }

    /// Returns what tells why the file at `path` was not written.
    pub(crate) fn unwritten<E: ToString>(path: &Path) -> impl Fn(E) -> Self {
        move |reason| Self::Write {
            path: path.to_owned(),
            reason: reason.to_string(),
        }
    }

    /// Returns the exit code that stands for this error.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Amount { .. }
            | Self::UnknownOutput { .. }
            | Self::Write { .. }
            | Self::Without { .. }
            | Self::Segments { .. }
            | Self::Frames(_)
            | Self::NotOverTime { .. } => exit::USAGE,
            Self::Input { .. }
            | Self::KnotPoints { .. }
            | Self::Array { .. }
            | Self::NoSuchAttribute { .. } => exit::INPUT,
            Self::Spline(error) => error.exit_code(),
            Self::InSplineFile { source, .. } => source.exit_code(),
            Self::SparseManifold(error) => manifold_exit_code(error),
            Self::CurveNetwork(_) => exit::METHOD,
            Self::Trivariate(error) => error.exit_code(),
            Self::Atlas(error) => error.exit_code(),
            Self::PowellSabin(error) => error.exit_code(),
            Self::TSpline(error) => error.exit_code(),
            Self::Task { .. }
            | Self::Biharmonic(FitError::CreaseAngle { .. } | FitError::WeightsWithL1)
            | Self::Combine(CombineError::Factor { .. })
            | Self::Decompose(DecomposeError::Factors { .. } | DecomposeError::Factor { .. }) => {
                exit::USAGE
            }
            Self::Biharmonic(
                FitError::NoSuchCrease { .. }
                | FitError::WeightCount { .. }
                | FitError::Weight { .. }
                | FitError::TooFewWeights { .. }
                | FitError::DataLength { .. }
                | FitError::DataNotFinite { .. }
                | FitError::CoincidentKnots { .. }
                | FitError::Points(_),
            )
            | Self::Combine(_) => exit::INPUT,
            Self::Biharmonic(_)
            | Self::Decompose(_)
            | Self::Knots(_)
            | Self::Explicit(_)
            | Self::Evaluate(_)
            | Self::Parts(_)
            | Self::LsMesh(_)
            | Self::Distance(_)
            | Self::NotFinite { .. } => exit::METHOD,
        }
    }
}

/// Options that mean nothing are told from meshes that are refused.
fn manifold_exit_code(error: &msplines_sparse_manifold::FitError) -> u8 {
    use msplines_sparse_manifold::FitError;
    match error {
        FitError::NoAtoms
        | FitError::EmptyCharts
        | FitError::Levels { .. }
        | FitError::TooFewObservations { .. }
        | FitError::Degree { .. }
        | FitError::NoSuchChart { .. }
        | FitError::Number { .. } => exit::USAGE,
        FitError::ControlMesh(_) | FitError::NotFinite { .. } => exit::INPUT,
        _ => exit::METHOD,
    }
}
