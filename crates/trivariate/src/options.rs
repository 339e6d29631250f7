//! What can be chosen about a fit and what comes before it.

use serde::{Deserialize, Serialize};

use crate::domain::mesher::MesherOptions;
use crate::domain::volume::VolumeOptions;
use crate::validity;

/// Options of [`Domain::build`](crate::domain::Domain::build).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Domain {
    /// How a surface is filled with tetrahedra.
    pub mesher: MesherOptions,
    /// How tetrahedra are mapped to the cube.
    pub volume: VolumeOptions,
}

/// Most samples of a fit: some 5 GB of points, parameters and rows.
pub const MOST_SAMPLES: usize = 20_000_000;

/// Which points of a solid a spline is fitted to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sampling {
    /// The vertices of the tetrahedra, as in the paper.
    Vertices,
    /// Points that are even in the solid and in the cube.
    Even {
        /// Number of points inside.
        interior: usize,
        /// Number of points on the surface.
        surface: usize,
        /// Weight of the surface against that of the inside.
        surface_weight: f64,
    },
}

impl Default for Sampling {
    fn default() -> Self {
        Self::Even {
            interior: 150_000,
            surface: 60_000,
            surface_weight: 3.0,
        }
    }
}

/// How a spline is fitted to samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fitting {
    /// Multilevel B-splines.
    Multilevel(Multilevel),
    /// Least squares with smoothing.
    LeastSquares(LeastSquares),
    /// Least squares whose solid is proved not to fold.
    Certified(Certified),
}

impl Default for Fitting {
    fn default() -> Self {
        Self::Certified(Certified::default())
    }
}

/// Options of [`solid::fit`](crate::solid::fit).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Solid {
    /// How the solid is mapped to the cube.
    pub domain: Domain,
    /// Which points are fitted.
    pub sampling: Sampling,
    /// How they are fitted.
    pub fitting: Fitting,
}

impl Solid {
    /// Returns the settings of the paper for corners that a user has given: one map that is harmonic
    /// across patches, folds counted, and multilevel B-splines of its vertices.
    ///
    /// # Reference
    /// [Kim2014] §4, §5, §6.
    #[must_use]
    pub fn paper(corners: [u32; 8]) -> Self {
        Self {
            domain: Domain {
                mesher: MesherOptions::default(),
                volume: VolumeOptions::paper(corners),
            },
            sampling: Sampling::Vertices,
            fitting: Fitting::Multilevel(Multilevel::PAPER),
        }
    }
}

/// Options of [`fit::multilevel`](crate::fit::multilevel::fit).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Multilevel {
    /// Spans of the first level.
    pub coarsest: usize,
    /// Spans of the last level, a power of two times those of the first; the same number for a fit of a
    /// single level.
    pub finest: usize,
    /// Root mean square of the residuals at which no further level is made; 0 for all levels.
    pub stop_rms: f64,
}

impl Multilevel {
    /// The settings of the paper.
    ///
    /// # Reference
    /// [Kim2014] Fig. 8, §6.
    pub const PAPER: Self = Self {
        coarsest: 2,
        finest: 64,
        stop_rms: 0.0,
    };
}

impl Default for Multilevel {
    fn default() -> Self {
        Self::PAPER
    }
}

/// Options of [`fit::least_squares`](crate::fit::least_squares::fit).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LeastSquares {
    /// Spans of the first level.
    pub coarsest: usize,
    /// Spans of the last level, a power of two times those of the first.
    pub finest: usize,
    /// Weight `λ` of the second derivatives, in units of spans, positive.
    pub smoothing: f64,
    /// Share of the squared error, smoothing included, that conjugate gradients leave to be gained.
    pub tolerance: f64,
    /// Most steps of conjugate gradients on each level.
    pub max_iterations: u32,
}

impl Default for LeastSquares {
    fn default() -> Self {
        Self {
            coarsest: 4,
            finest: 16,
            smoothing: 1e-4,
            tolerance: 1e-3,
            max_iterations: 500,
        }
    }
}

/// Options of [`fit::certified`](crate::fit::certified::fit).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Certified {
    /// Those of the fit it starts from.
    pub least_squares: LeastSquares,
    /// Cells in each direction of the samplings whose elements must be positive; may be empty.
    pub samplings: Vec<usize>,
    /// Margin `δ` of element volumes and Bernstein coefficients, against those of right angles.
    pub margin: f64,
    /// Weight of an element in the first round, against the mean squared distance of the samples from
    /// the least-squares solid.
    pub element_weight: f64,
    /// Weight of a Bernstein coefficient in the first round, likewise.
    pub coefficient_weight: f64,
    /// By how much the weights of what is wrong, and of its neighbours, grow from one round to the next.
    pub growth: f64,
    /// Most rounds.
    pub rounds: u32,
    /// Most evaluations of a round over all control points, or of each of its descents over a few.
    pub evaluations: u32,
    /// Most evaluations once nothing is wrong, towards the least energy.
    pub polishing: u32,
    /// How the result is certified.
    pub certificate: validity::Options,
}

impl Default for Certified {
    fn default() -> Self {
        Self {
            least_squares: LeastSquares::default(),
            samplings: vec![20, 30],
            margin: 0.005,
            element_weight: 1e-1,
            coefficient_weight: 1e-2,
            growth: 4.0,
            rounds: 20,
            evaluations: 80,
            polishing: 320,
            certificate: validity::Options::default(),
        }
    }
}
