//! What can be chosen about a fit.

use serde::{Deserialize, Serialize};

/// Options of [`fit`](crate::fit).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Which vertices are knots.
    pub knots: KnotChoice,
    /// How much is done for the best places of the knots.
    pub effort: Effort,
    /// Which Laplacian the splines are made of.
    pub laplacian: Laplacian,
    /// Seed of all random choices.
    pub seed: u64,
}

/// Which vertices are knots.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum KnotChoice {
    /// So many knots at optimised places.
    ///
    /// The reweighted l1 selection of [Hou2017] (Eq. 9, 10) will stand beside this choice.
    Optimised {
        /// Number of knots.
        count: usize,
    },
    /// These vertices.
    Given(Vec<u32>),
    /// Every vertex: the spline interpolates.
    All,
}

/// How much is done for the best places of the knots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Effort {
    /// Elimination and a single round of exchanges.
    Fast,
    /// Elimination and a few rounds of exchanges: most of what can be gained.
    Standard,
    /// Slower elimination from more candidates, and exchanges until they gain nothing.
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
        effort: Effort::Standard,
        laplacian: Laplacian::Cotangent,
        seed: 0,
    };
}

impl Default for Options {
    fn default() -> Self {
        Self::PAPER
    }
}
