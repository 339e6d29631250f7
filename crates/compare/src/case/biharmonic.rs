//! Biharmonic B-splines as a case asks for them.

use std::path::PathBuf;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::{Amount, AmountError};

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
