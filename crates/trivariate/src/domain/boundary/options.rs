//! What can be chosen about the map of a surface.

use serde::{Deserialize, Serialize};

use super::error::BoundaryError;

/// Options of [`map`](super::map()).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BoundaryOptions {
    /// How far the borders of the patches may move.
    pub border: Border,
    /// Weights of the harmonic maps of patches with fixed borders.
    pub weights: PatchWeights,
    /// How paths are laid.
    pub routing: RoutingOptions,
}

/// How far the borders of the six patches may move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Border {
    /// They are fixed by arc length: no triangle can fold.
    Fixed,
    /// From there on, they slide along the edges of the cube while the distortion of all patches
    /// together falls; a step that folds a triangle is refused.
    Sliding {
        /// Most evaluations of the distortion.
        evaluations: u32,
    },
    /// They are free: harmonic across patches, only the corners are fixed. Triangles may fold, and
    /// straddle the edges of the cube.
    Free,
}

/// Weights of the harmonic maps of patches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PatchWeights {
    /// Cotangents, and in a patch that they fold positive ones instead.
    #[default]
    Cotangent,
    /// Cotangents, small and negative ones replaced: every vertex is a convex combination of its
    /// neighbours.
    Convex,
}

/// How the twelve paths are laid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RoutingOptions {
    /// How much longer concave ground counts; 0 takes shortest paths.
    pub avoid_concave: f64,
    /// How much longer ground next to another path counts.
    pub repulsion: f64,
    /// Where that has fallen to a third, in edges.
    pub reach: f64,
    /// How often all paths are laid anew, each away from the others.
    pub sweeps: u32,
}

impl Default for RoutingOptions {
    fn default() -> Self {
        Self {
            avoid_concave: 0.0,
            repulsion: 8.0,
            reach: 4.0,
            sweeps: 4,
        }
    }
}

impl Default for BoundaryOptions {
    fn default() -> Self {
        Self {
            border: Border::Fixed,
            weights: PatchWeights::default(),
            routing: RoutingOptions::default(),
        }
    }
}

impl BoundaryOptions {
    /// The settings of the paper: shortest paths, and one map that is harmonic across patches.
    ///
    /// # Reference
    /// [Kim2014] §4.1.
    pub const PAPER: Self = Self {
        border: Border::Free,
        weights: PatchWeights::Cotangent,
        routing: RoutingOptions {
            avoid_concave: 0.0,
            repulsion: 0.0,
            reach: 4.0,
            sweeps: 0,
        },
    };

    pub(super) fn check(&self) -> Result<(), BoundaryError> {
        let RoutingOptions {
            avoid_concave,
            repulsion,
            reach,
            ..
        } = self.routing;
        for (name, value, least) in [
            ("avoid_concave", avoid_concave, 0.0),
            ("repulsion", repulsion, 0.0),
            ("reach", reach, f64::MIN_POSITIVE),
        ] {
            if !(value >= least && value.is_finite()) {
                let range = if least > 0.0 {
                    "above 0"
                } else {
                    "not below 0"
                };
                return Err(BoundaryError::Number { name, value, range });
            }
        }
        Ok(())
    }
}
