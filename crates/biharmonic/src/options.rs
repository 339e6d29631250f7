//! What can be chosen about a fit.

use msplines_common::mesh::{SurfacePoint, TriangleMesh};
use serde::{Deserialize, Serialize};

use crate::{Creases, FitError};

/// Options of [`fit`](crate::fit).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Which points are knots.
    pub knots: KnotChoice,
    /// How the places of the knots are chosen.
    pub selection: Selection,
    /// How much is done for the best places of the knots.
    pub effort: Effort,
    /// Whether a few knots move in the end to lower the largest error, at up to 1 % more mean and
    /// squared error.
    pub polish: bool,
    /// Where the spline may have creases.
    pub creases: CreaseChoice,
    /// Which Laplacian the splines are made of.
    pub laplacian: Laplacian,
    /// Seed of all random choices.
    pub seed: u64,
}

/// Which points are knots.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum KnotChoice {
    /// So many knots at optimised places.
    Optimised {
        /// Number of knots.
        count: usize,
    },
    /// As many as noisy data can bear, by generalised cross-validation, at optimised places.
    CrossValidated,
    /// These vertices.
    Given(Vec<u32>),
    /// These points of the surface, at vertices or not.
    At(Vec<SurfacePoint>),
    /// Every vertex: the spline interpolates.
    All,
}

/// How the places of the knots are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Selection {
    /// Backward elimination from a dense sample, then exchange of knots.
    Exchange,
    /// The reweighted l1 norm of the Green's coefficients.
    L1,
    /// The same, then exchange of knots.
    #[serde(rename = "l1+exchange")]
    L1Exchange,
    /// A Poisson-disk sample that is denser where the data bends.
    Curvature,
    /// An even Poisson-disk sample.
    BlueNoise,
}

/// Where a spline may have creases.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CreaseChoice {
    /// Nowhere: the spline is smooth.
    None,
    /// At edges whose faces meet at more than so many degrees.
    SharperThan {
        /// The angle, between 0 and 180.
        degrees: f64,
    },
    /// Along these edges, given by their vertices.
    Edges(Vec<[u32; 2]>),
}

impl CreaseChoice {
    /// Returns the creases on a mesh.
    ///
    /// # Errors
    /// An edge that does not exist, or an angle that is none.
    pub fn on(&self, mesh: &TriangleMesh) -> Result<Creases, FitError> {
        match self {
            Self::None => Ok(Creases::none()),
            Self::SharperThan { degrees } if (0.0..=180.0).contains(degrees) => {
                Ok(Creases::sharper_than(mesh, degrees.to_radians()))
            }
            Self::SharperThan { degrees } => Err(FitError::CreaseAngle { degrees: *degrees }),
            Self::Edges(edges) => Creases::along(mesh, edges),
        }
    }
}

/// How much is done for the best places of the knots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Effort {
    /// Elimination from three candidates a knot, and a round of exchanges, or more while they gain
    /// much.
    Fast,
    /// Slower elimination from four candidates a knot, and a few rounds of exchanges: most of what
    /// can be gained.
    Standard,
    /// The slowest elimination, and many rounds of exchanges.
    Best,
}

/// Which Laplacian the splines are made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Laplacian {
    /// The cotangent Laplacian of the mesh as it is.
    Cotangent,
    /// The cotangent Laplacian of the intrinsic Delaunay triangulation of the same surface: better
    /// conditioned by orders of magnitude on meshes with slivers.
    IntrinsicDelaunay,
}

impl Options {
    /// The choices of the paper as far as they exist here: the cotangent Laplacian of the mesh.
    ///
    /// # Reference
    /// [Hou2017] §6. Deviation: knots by elimination and exchange, not by reweighted l1.
    pub const PAPER: Self = Self {
        knots: KnotChoice::Optimised { count: 1000 },
        selection: Selection::Exchange,
        effort: Effort::Standard,
        polish: false,
        creases: CreaseChoice::None,
        laplacian: Laplacian::Cotangent,
        seed: 0,
    };
}

impl Default for Options {
    fn default() -> Self {
        Self::PAPER
    }
}
