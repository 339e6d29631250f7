//! What one run is asked to do, as plain data.

mod conformal;
mod edit;
mod manifold;
mod powell_sabin;
mod solid;
mod t_spline;

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use msplines_biharmonic::Scheme;
use serde::{Deserialize, Serialize};

use crate::animation::Frames;
use crate::generated::{ChartFunction, ControlShape, GeneratedSurface, NetworkShape, SolidShape};

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

/// A biharmonic B-spline with its options.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BiharmonicMethod {
    /// Where its knots are.
    pub knots: Knots,
    /// How the places of the knots are chosen.
    pub selection: msplines_biharmonic::Selection,
    /// How long knots are optimised.
    pub effort: msplines_biharmonic::Effort,
    /// Whether a few of them move in the end to lower the largest error.
    #[serde(default)]
    pub polish: bool,
    /// Discrete Laplacian.
    pub laplacian: msplines_biharmonic::Laplacian,
    /// Where the surface may have creases.
    pub creases: CaseCreases,
    /// How much each vertex counts; all alike where absent.
    pub weights: Option<Weights>,
}

impl BiharmonicMethod {
    /// Returns the method with these knots and default options.
    #[must_use]
    pub fn new(knots: Knots) -> Self {
        let defaults = msplines_biharmonic::Options::default();
        Self {
            knots,
            selection: defaults.selection,
            effort: defaults.effort,
            polish: defaults.polish,
            laplacian: defaults.laplacian,
            creases: CaseCreases::None,
            weights: None,
        }
    }
}

/// How much each vertex counts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Weights {
    /// A file with a number for every vertex.
    File(PathBuf),
    /// More inside a ball than elsewhere, where the weight is 1.
    Ball {
        /// Middle of the ball, as fractions of the sides of the bounding box.
        at: [f64; 3],
        /// Its radius, as a fraction of the diagonal of the bounding box.
        radius: f64,
        /// Weight inside.
        weight: f64,
    },
}

/// Where a surface may have creases.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CaseCreases {
    /// Nowhere.
    None,
    /// At edges whose faces meet at more than so many degrees.
    SharperThan(f64),
    /// Along the edges in this file: two vertices a line, from zero.
    Along(PathBuf),
}

/// Where the knots of a biharmonic B-spline are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Knots {
    /// So many, at optimised places.
    Optimised(Amount),
    /// At every vertex: the spline interpolates.
    All,
    /// As many as the noise of the data bears, at optimised places.
    Auto,
    /// At the vertices nearest to the points of this file, each vertex once.
    Near(PathBuf),
    /// At the points of the surface nearest to the points of this file, each point once.
    At(PathBuf),
}

impl FromStr for Knots {
    type Err = AmountError;

    /// Reads `all`, `auto`, or an [`Amount`].
    fn from_str(text: &str) -> Result<Self, AmountError> {
        match text.trim() {
            "all" => Ok(Self::All),
            "auto" => Ok(Self::Auto),
            amount => amount.parse().map(Self::Optimised),
        }
    }
}

/// A number of vertices, or a fraction of them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Amount {
    /// So many vertices.
    Count(usize),
    /// This fraction of the vertices, rounded to the nearest count; at least one unless it is zero.
    Fraction(f64),
}

/// Why an amount makes no sense.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AmountError {
    /// Neither `1500` nor `3%`.
    #[error("`{text}` is neither a count such as 1500 nor a percentage such as 3%")]
    Unreadable {
        /// What was given.
        text: String,
    },
    /// Nothing at all.
    #[error("{asked} of {vertices} vertices is none; ask for at least one")]
    Zero {
        /// What was given.
        asked: Amount,
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// More than there are.
    #[error(
        "{asked} is more than the {vertices} vertices of the mesh; ask for at most {vertices} or 100%"
    )]
    TooMany {
        /// What was given.
        asked: Amount,
        /// Vertices of the mesh.
        vertices: usize,
    },
}

impl Amount {
    /// Returns the count this amount stands for on a mesh of `vertices` vertices.
    ///
    /// # Errors
    /// A count of zero, or more than there are vertices.
    pub fn of(self, vertices: usize) -> Result<usize, AmountError> {
        let count = match self {
            Self::Count(count) => count,
            Self::Fraction(fraction) if fraction > 1.0 => usize::MAX,
            Self::Fraction(fraction) if fraction > 0.0 => {
                ((fraction * vertices as f64).round() as usize).max(1)
            }
            Self::Fraction(_) => 0,
        };
        match count {
            0 => Err(AmountError::Zero {
                asked: self,
                vertices,
            }),
            _ if count > vertices => Err(AmountError::TooMany {
                asked: self,
                vertices,
            }),
            _ => Ok(count),
        }
    }
}

impl fmt::Display for Amount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count(count) => write!(f, "{count}"),
            Self::Fraction(fraction) => write!(f, "{}%", (fraction * 1e8).round() / 1e6),
        }
    }
}

impl FromStr for Amount {
    type Err = AmountError;

    fn from_str(text: &str) -> Result<Self, AmountError> {
        let unreadable = || AmountError::Unreadable {
            text: text.to_owned(),
        };
        let Some(percent) = text.trim().strip_suffix('%') else {
            return text
                .trim()
                .parse()
                .map(Self::Count)
                .map_err(|_| unreadable());
        };
        let percent: f64 = percent.trim().parse().map_err(|_| unreadable())?;
        if !percent.is_finite() || percent < 0.0 {
            return Err(unreadable());
        }
        Ok(Self::Fraction(percent / 100.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_are_read_as_counts_or_percentages() {
        assert_eq!("1500".parse(), Ok(Amount::Count(1500)));
        assert_eq!("3%".parse(), Ok(Amount::Fraction(0.03)));
        assert_eq!("0.5 %".parse(), Ok(Amount::Fraction(0.005)));
        for text in ["", "%", "-3%", "nan%", "3.5", "-1", "many"] {
            assert!(text.parse::<Amount>().is_err(), "{text} must be refused");
        }
    }

    #[test]
    fn amounts_stay_between_one_and_all_vertices() {
        assert_eq!(Amount::Fraction(0.03).of(10_044), Ok(301));
        assert_eq!(Amount::Fraction(1.0).of(7), Ok(7));
        assert_eq!(Amount::Fraction(0.001).of(7), Ok(1));
        assert_eq!(Amount::Count(7).of(7), Ok(7));
        for bad in [Amount::Count(0), Amount::Fraction(0.0)] {
            assert!(matches!(bad.of(7), Err(AmountError::Zero { .. })));
        }
        for bad in [
            Amount::Count(8),
            Amount::Fraction(1.01),
            Amount::Fraction(1e300),
        ] {
            assert!(matches!(bad.of(7), Err(AmountError::TooMany { .. })));
        }
    }

    #[test]
    fn a_refused_amount_says_what_to_ask_for() {
        let error = Amount::Count(8).of(7).expect_err("too many").to_string();
        assert_eq!(
            error,
            "8 is more than the 7 vertices of the mesh; ask for at most 7 or 100%"
        );
        let error = Amount::Fraction(0.0).of(7).expect_err("none").to_string();
        assert_eq!(error, "0% of 7 vertices is none; ask for at least one");
    }
}
