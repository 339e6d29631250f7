//! What one run is asked to do, as plain data.

mod amount;
mod biharmonic;
mod conformal;
mod edit;
mod manifold;
mod powell_sabin;
mod solid;
mod t_spline;

use std::path::PathBuf;

use msplines_biharmonic::Scheme;
use serde::{Deserialize, Serialize};

use crate::animation::Frames;
use crate::generated::{ChartFunction, ControlShape, GeneratedSurface, NetworkShape, SolidShape};

pub use amount::{Amount, AmountError};
pub use biharmonic::{BiharmonicMethod, CaseCreases, Knots, Weights};
pub use conformal::{ConformalMethod, Form, FormError};
pub use edit::{Edit, Move};
pub use manifold::{ChartMethod, Creases, CurveNetworkMethod, Polygons, SparseManifoldMethod};
pub use powell_sabin::{BasisFunction, Layout, PowellSabinMethod, SplineEdit};
pub use solid::{Cut, Filler, LatticeMove, SolidMap, TrivariateMethod};
pub use t_spline::{NamedPuncture, Puncture, PunctureError, TSplineMethod};

/// One run: an input, the data on it, a method with its options, and what to write.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// The domain mesh.
    pub input: Input,
    /// The data to fit at its vertices.
    pub data: Data,
    /// The method and its options.
    pub method: Method,
    /// What is done with it.
    pub task: Task,
    /// Seed of everything random.
    pub seed: u64,
    /// Rounds of midpoint subdivision at whose vertices the spline is evaluated; 0 for the input
    /// vertices.
    pub subdivide: u32,
    /// Where that subdivision puts its vertices.
    pub scheme: Scheme,
    /// Rounds of Loop's subdivision that the input goes through before anything else.
    #[serde(default)]
    pub refine: u32,
    /// Whether the spline lives on the double cover of the input instead.
    pub double_cover: bool,
    /// Whether the two-sided distance between the surfaces is measured as well.
    pub measure_distance: bool,
    /// Another surface that the distance of the spline is measured to as well.
    pub reference: Option<PathBuf>,
    /// Files to write: surfaces (`.ply`, `.obj`, `.vtu`, `.glb`), values (`.npy`) and splines
    /// (`.json`); of atlases texture (`.npy`), not `.vtu`; of solids also cells (`.vtu`, `.hex.vtu`, `.msh`, `.mesh`) and G+Smo's `.xml`.
    pub outputs: Vec<PathBuf>,
    /// How a spline file names its domain.
    pub domain: DomainStorage,
}

impl Case {
    /// Returns the case that fits the positions of `input` and writes nothing.
    #[must_use]
    pub fn new(input: Input, method: Method) -> Self {
        Self {
            input,
            data: Data::Positions,
            method,
            task: Task::Fit,
            seed: 0,
            subdivide: 0,
            scheme: Scheme::Planar,
            refine: 0,
            double_cover: false,
            measure_distance: false,
            reference: None,
            outputs: Vec::new(),
            domain: DomainStorage::Embedded,
        }
    }

    /// Returns the files that the run reads besides its input.
    pub(crate) fn files_mut(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        let (mut knots, mut creases, mut weights, mut data) = (None, None, None, None);
        match &mut self.method {
            Method::Biharmonic(method) => {
                if let Knots::Near(points) | Knots::At(points) = &mut method.knots {
                    knots = Some(points);
                }
                if let CaseCreases::Along(edges) = &mut method.creases {
                    creases = Some(edges);
                }
                if let Some(Weights::File(path)) = &mut method.weights {
                    weights = Some(path);
                }
            }
            Method::SparseManifold(method) => {
                if let Creases::File(path) = &mut method.creases {
                    creases = Some(path);
                }
            }
            Method::LsMesh { .. }
            | Method::CurveNetwork(_)
            | Method::Chart(_)
            | Method::Trivariate(_)
            | Method::Conformal(_)
            | Method::PowellSabin(_)
            | Method::TSpline(_) => {}
        }
        if let Data::Array(values) = &mut self.data {
            data = Some(values);
        }
        let method = knots.into_iter().chain(creases).chain(weights);
        let animation = match &mut self.task {
            Task::Frames(frames) => Some(frames.animation.files_mut()),
            Task::Fit | Task::Decompose { .. } | Task::Edit(_) | Task::Properties => None,
        };
        let method = method.chain(animation.into_iter().flatten());
        method.chain(data).chain(&mut self.reference)
    }
}

/// What is done with a method on an input.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Task {
    /// One fit.
    #[default]
    Fit,
    /// Layers of splines, each fitted to what the ones before it leave, and their weighted sum.
    Decompose {
        /// Knots of each layer.
        layers: Vec<Amount>,
        /// Factor of each layer and of the residual.
        factors: Vec<f64>,
    },
    /// One fit whose control points are then moved.
    Edit(Edit),
    /// One fit, and measurements of the basis functions and the laws of its spline space.
    Properties,
    /// A fit to every frame of an animation, in place of the data at the vertices.
    Frames(Frames),
}

/// Where the domain mesh comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Input {
    /// A mesh file.
    File {
        /// Where it is.
        path: PathBuf,
        /// Whether defects are mended (and reported) instead of refused.
        repair: bool,
    },
    /// A surface made from a formula.
    Surface(GeneratedSurface),
    /// A control mesh made from a name.
    Control(ControlShape),
    /// A curve network made from a name.
    Network(NetworkShape),
    /// A function of a chart made from a name.
    Chart(ChartFunction),
    /// A solid made from a name.
    Solid(SolidShape),
}

impl Input {
    /// Whether this is a file whose defects are mended.
    pub(crate) fn is_mended(&self) -> bool {
        matches!(self, Self::File { repair: true, .. })
    }
}

/// What is fitted at the vertices.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Data {
    /// The vertex positions.
    Positions,
    /// These per-vertex attributes of the file, in this order.
    Attributes(Vec<String>),
    /// A NumPy array of one row for every vertex.
    Array(PathBuf),
    /// A colour of every point, as hard everywhere: see [`crate::generated::colour_pattern`].
    ColourPattern,
    /// An image-like colour of every point: see [`crate::generated::colour_image`].
    ColourImage,
}

/// How a spline file names its domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DomainStorage {
    /// The mesh is in the file.
    Embedded,
    /// The file holds the digest of the mesh file only.
    Digest,
}

/// A method with its options.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Method {
    /// Biharmonic B-spline.
    Biharmonic(BiharmonicMethod),
    /// Least-squares mesh.
    LsMesh {
        /// Number of control vertices.
        controls: Amount,
        /// How they are chosen.
        selection: msplines_ls_mesh::Selection,
        /// How they bind.
        constraints: msplines_ls_mesh::Constraints,
    },
    /// Sparse manifold over a control mesh or a scan.
    SparseManifold(Box<SparseManifoldMethod>),
    /// Sparse manifold over the patches of a curve network.
    CurveNetwork(Box<CurveNetworkMethod>),
    /// The function of a single chart.
    Chart(ChartMethod),
    /// Trivariate spline of a solid.
    Trivariate(Box<TrivariateMethod>),
    /// Conformal atlas, which splines over surfaces live on.
    Conformal(ConformalMethod),
    /// Powell-Sabin spline through the vertices of a surface and their normals.
    PowellSabin(Box<PowellSabinMethod>),
    /// T-spline that approximates a surface.
    TSpline(Box<TSplineMethod>),
}

impl Method {
    /// Returns the biharmonic B-spline with these knots and default options.
    #[must_use]
    pub fn biharmonic(knots: Knots) -> Self {
        Self::Biharmonic(BiharmonicMethod::new(knots))
    }

    /// Returns the least-squares mesh of `controls` control vertices with default options.
    #[must_use]
    pub fn ls_mesh(controls: Amount) -> Self {
        let msplines_ls_mesh::Options {
            selection,
            constraints,
            ..
        } = Default::default();
        Self::LsMesh {
            controls,
            selection,
            constraints,
        }
    }

    /// Returns the name of the method in records and files.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Biharmonic(_) => "biharmonic",
            Self::LsMesh { .. } => "ls-mesh",
            Self::SparseManifold(_) => "sparse-manifold",
            Self::CurveNetwork(_) => "curve-network",
            Self::Chart(_) => "chart",
            Self::Trivariate(_) => "trivariate",
            Self::Conformal(_) => "conformal",
            Self::PowellSabin(_) => "powell-sabin",
            Self::TSpline(_) => "t-spline",
        }
    }
}
