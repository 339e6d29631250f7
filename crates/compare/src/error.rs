//! Why a run gives no result, and which exit code says so.

mod conformal;
mod powell_sabin;
mod solid;
mod t_spline;

use std::path::{Path, PathBuf};

use msplines_biharmonic::{CombineError, DecomposeError, FitError};
use msplines_common::evaluate::EvaluateError;
use msplines_common::mesh::TopologyError;

use crate::animation::FrameError;
use crate::case::AmountError;

pub use conformal::AtlasError;
pub use powell_sabin::PowellSabinError;
pub use solid::TrivariateError;
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

/// Why a stored spline cannot be read or evaluated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SplineFileError {
    /// The file cannot be read.
    #[error("{}: {source}; give a file that `msplines fit -o FILE.json` wrote", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Not JSON, or not the fields of a spline.
    #[error("not a spline file: {0}; give a file that `msplines fit -o FILE.json` wrote")]
    Json(#[from] serde_json::Error),
    /// JSON of another kind.
    #[error(
        "this is `{found}`, not `msplines.spline/2`; give a file that `msplines fit -o FILE.json` wrote"
    )]
    WrongSchema {
        /// The schema it states.
        found: String,
    },
    /// Numbers of coefficients that do not belong together.
    #[error(
        "the spline file lists {knots} knots of {dimension} components but {values} values; it is damaged, fit again"
    )]
    WrongLength {
        /// Knots or control vertices.
        knots: usize,
        /// Components of a value.
        dimension: usize,
        /// Coefficients or control values.
        values: usize,
    },
    /// Two faces of the domain with the same corners.
    #[error(
        "faces {first} and {second} of the mesh in the spline file have the same corners; it is damaged, fit again"
    )]
    TwinFaces {
        /// One face.
        first: usize,
        /// The other face.
        second: usize,
    },
    /// A knot that the domain does not have.
    #[error(
        "the spline file names vertex {vertex}, but its domain has {vertices} vertices; give the mesh that was fitted"
    )]
    NoSuchVertex {
        /// The vertex.
        vertex: u32,
        /// Vertices of the domain.
        vertices: usize,
    },
    /// A number that is not finite.
    #[error("{what} {index} of the spline file is not finite; it is damaged, fit again")]
    NotFinite {
        /// Which numbers.
        what: &'static str,
        /// Index of the first.
        index: usize,
    },
    /// A form whose bytes are not those of the mesh.
    #[error(
        "the form of the spline file has {bytes} bytes, which is not what {edges} edges ask for; it is damaged, fit again"
    )]
    Form {
        /// How many bytes there are.
        bytes: usize,
        /// Edges of the mesh.
        edges: usize,
    },
    /// Runs of a mesh that do not belong together.
    #[error("the {what} of the spline file do not fit its domain; it is damaged, fit again")]
    Layout {
        /// What does not fit.
        what: &'static str,
    },
    /// A level that is not in the file.
    #[error(
        "--level {level}: the file has levels 0, the coarsest, to {last}, the surface itself; give one of them"
    )]
    NoSuchLevel {
        /// What was asked for.
        level: usize,
        /// The finest one.
        last: usize,
    },
    /// The embedded domain is not a manifold.
    #[error("the domain of the spline file: {0}; the file is damaged, fit again")]
    Domain(#[from] TopologyError),
    /// The domain is another file.
    #[error(
        "the spline belongs to a mesh file with SHA-256 {expected}, but this one has {found}; give the mesh that was fitted with --mesh"
    )]
    OtherDomain {
        /// The digest in the spline file.
        expected: String,
        /// The digest of the given mesh.
        found: String,
    },
    /// No domain at all.
    #[error(
        "the spline file holds only the digest of its mesh (SHA-256 {sha256}); give that mesh with --mesh"
    )]
    DomainMissing {
        /// The digest in the spline file.
        sha256: String,
    },
    /// Neither coefficients with their constant nor values at the knots.
    #[error(
        "the spline file must hold either `coefficients` and `constant` or `knot_values`; it is damaged, fit again"
    )]
    Numbers,
    /// The domain carries no spline of this kind.
    #[error("biharmonic: {0}; the spline file is damaged or belongs to another mesh")]
    Space(#[from] FitError),
    /// A least-squares mesh between its vertices.
    #[error("a least-squares mesh is defined at the vertices only; leave out --subdivide")]
    VerticesOnly,
    /// The parts do not make a biharmonic spline.
    #[error("biharmonic: {0}; the spline file is damaged or belongs to another mesh")]
    Biharmonic(#[from] msplines_biharmonic::PartsError),
    /// The parts do not make a least-squares mesh.
    #[error("ls-mesh: {0}")]
    LsMesh(#[from] msplines_ls_mesh::FitError),
    /// The parts do not make a sparse manifold.
    #[error("sparse-manifold: {0}")]
    SparseManifold(#[from] msplines_sparse_manifold::SplineError),
    /// The parts do not make the function of a chart.
    #[error("chart: {0}")]
    Chart(#[from] msplines_sparse_manifold::LocalError),
    /// A domain of polygons, or a spline over one, where triangles are needed.
    #[error("the spline lives on polygons, not on triangles; evaluate it by itself")]
    Polygons,
    /// A cube as domain, or a spline over it, where triangles are needed.
    #[error("the spline lives on the unit cube, not on triangles; evaluate it by itself")]
    Cube,
    /// Values of a Powell-Sabin spline are asked for at points of its own mesh.
    #[error(
        "a Powell-Sabin spline is evaluated by its own tessellation; leave out subdivision and sums"
    )]
    SurfacePoints,
    /// The stored numbers are no Powell-Sabin spline over the mesh.
    #[error("the spline does not fit its mesh: {0}")]
    PowellSabin(#[from] msplines_powell_sabin::SurfaceError),
    /// Values of a T-spline are asked for at points of its own mesh.
    #[error(
        "a T-spline is evaluated at the vertices of its input or by its own tessellation; leave out subdivision and sums"
    )]
    OwnTessellation,
    /// The stored numbers are no T-spline over the mesh.
    #[error("t-spline: {0}; the spline file is damaged, fit again")]
    TSpline(#[from] msplines_t_spline::parts::PartsError),
    /// A trivariate spline over something else than the cube.
    #[error("a trivariate spline must have the domain `cube`; the file is damaged, fit again")]
    NoCube,
    /// The numbers do not make a trivariate spline.
    #[error("trivariate: {0}; the spline file is damaged, fit again")]
    Trivariate(#[from] msplines_trivariate::spline::SplineError),
    /// The spline could not be evaluated.
    #[error("{0}; where its file is damaged, fit again")]
    Evaluate(#[from] EvaluateError),
}

impl SplineFileError {
    /// Returns the exit code that stands for this error.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::VerticesOnly
            | Self::Polygons
            | Self::Cube
            | Self::SurfacePoints
            | Self::OwnTessellation
            | Self::NoSuchLevel { .. }
            | Self::DomainMissing { .. } => exit::USAGE,
            Self::Biharmonic(_) | Self::Space(_) | Self::LsMesh(_) | Self::Evaluate(_) => {
                exit::METHOD
            }
            _ => exit::INPUT,
        }
    }
}
