//! What can be chosen about the map of a solid.

use serde::{Deserialize, Serialize};

use super::error::VolumeError;
use crate::domain::boundary::BoundaryOptions;

/// Options of [`map`](super::map()).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct VolumeOptions {
    /// Which vertices become the corners.
    pub corners: Corners,
    /// How the boundary is mapped.
    pub boundary: BoundaryOptions,
    /// Rounds in which paths are made fair, vertices of the solid moving along its surface; none with
    /// borders that are free.
    pub fairing: u32,
    /// Weights of the harmonic map.
    pub weights: VolumeWeights,
    /// What is done about folds.
    pub folds: FoldOptions,
    /// How long a map without folds is made less distorted.
    pub smoothing: Smoothing,
}

/// Which vertices become the corners of the cube.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Corners {
    /// These vertices of the solid, all on its boundary. Bit `d` of the place in the list is the
    /// coordinate along axis `d`.
    Given([u32; 8]),
    /// The best of all combinations.
    Found(Search),
}

/// Which corners and paths are tried.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Search {
    /// Turns of the box about the main axis, in degrees.
    pub turns: Vec<f64>,
    /// How much corners must be extreme along all axes alike.
    pub evenness: Vec<f64>,
    /// How much longer concave ground counts for paths.
    pub avoid_concave: Vec<f64>,
    /// How many of the best are mapped, one after another, until there is a map without folds.
    pub tries: u32,
}

/// Weights of the harmonic map of a solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VolumeWeights {
    /// Those of linear finite elements, which reproduce linear functions.
    #[default]
    Linear,
    /// Those printed in the paper, with the length of the edge itself.
    Literal,
}

/// What is done about cells that are inverted or flat.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FoldOptions {
    /// They are counted.
    Counted,
    /// They are unfolded around where they are.
    Unfolded {
        /// Most rounds, each with another size of the surroundings.
        rounds: u32,
        /// Most evaluations of the energy in each part and round.
        evaluations: u32,
        /// Smallest determinant that counts as unfolded; the mean is 1.
        least: f64,
    },
}

/// How long a map without folds is made less distorted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Smoothing {
    /// Most evaluations of the distortion with steps preconditioned by the Laplacian.
    pub global_evaluations: u32,
    /// Most evaluations after them with cheap steps.
    pub local_evaluations: u32,
    /// A step that lowers the distortion by less than this fraction is the last.
    pub progress: f64,
}

impl Smoothing {
    /// Keeps the harmonic map.
    pub const NONE: Self = Self {
        global_evaluations: 0,
        local_evaluations: 0,
        progress: 1e-5,
    };
}

impl Default for Smoothing {
    fn default() -> Self {
        Self {
            global_evaluations: 15,
            local_evaluations: 20,
            progress: 1e-5,
        }
    }
}

impl Default for VolumeOptions {
    fn default() -> Self {
        Self {
            corners: Corners::default(),
            boundary: BoundaryOptions::default(),
            fairing: 12,
            weights: VolumeWeights::default(),
            folds: FoldOptions::default(),
            smoothing: Smoothing::default(),
        }
    }
}

impl Default for Corners {
    fn default() -> Self {
        Self::Found(Search::default())
    }
}

impl Default for Search {
    fn default() -> Self {
        Self {
            turns: vec![0.0, 22.5, 45.0, 67.5],
            evenness: vec![0.15],
            avoid_concave: vec![0.0, 4.0],
            tries: 3,
        }
    }
}

impl Default for FoldOptions {
    fn default() -> Self {
        Self::Unfolded {
            rounds: 16,
            evaluations: 500,
            least: 1e-6,
        }
    }
}

impl VolumeOptions {
    /// Returns the settings of the paper for corners that a user has given: a boundary that is
    /// harmonic across patches, its weights as printed, and no remedy for folds.
    ///
    /// # Reference
    /// [Kim2014] §4.
    #[must_use]
    pub const fn paper(corners: [u32; 8]) -> Self {
        Self {
            corners: Corners::Given(corners),
            boundary: BoundaryOptions::PAPER,
            fairing: 0,
            weights: VolumeWeights::Literal,
            folds: FoldOptions::Counted,
            smoothing: Smoothing::NONE,
        }
    }

    pub(super) fn check(&self) -> Result<(), VolumeError> {
        if let Corners::Found(search) = &self.corners {
            search.check()?;
        }
        if let FoldOptions::Unfolded { least, .. } = self.folds {
            number("least", least, 0.0..1.0, "from 0 to 1")?;
        }
        number("progress", self.smoothing.progress, 0.0..1.0, "from 0 to 1")
    }
}

impl Search {
    fn check(&self) -> Result<(), VolumeError> {
        for (name, values) in [
            ("turns", &self.turns),
            ("evenness", &self.evenness),
            ("avoid_concave", &self.avoid_concave),
        ] {
            if values.is_empty() {
                return Err(VolumeError::Number {
                    name,
                    value: f64::NAN,
                    range: "at least once",
                });
            }
            for &value in values {
                let least = if name == "turns" { f64::MIN } else { 0.0 };
                number(
                    name,
                    value,
                    least..f64::MAX,
                    "that is finite and not negative",
                )?;
            }
        }
        number("tries", self.tries.into(), 1.0..1e9, "from 1")
    }
}

fn number(
    name: &'static str,
    value: f64,
    allowed: std::ops::Range<f64>,
    range: &'static str,
) -> Result<(), VolumeError> {
    if allowed.contains(&value) {
        return Ok(());
    }
    Err(VolumeError::Number { name, value, range })
}
