//! Why a spline file gives no spline.

use std::path::PathBuf;

use msplines_biharmonic::FitError;
use msplines_common::evaluate::EvaluateError;
use msplines_common::mesh::TopologyError;

use super::exit;

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
