//! What a search for cycles may be told, and what it tells.

use super::super::error::NetworkError;

/// How cycles are found. Points are those of the network, counted from 0.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CycleOptions {
    /// Searches from disturbed costs; the one of least energy counts.
    pub restarts: u32,
    /// Seed of the disturbances.
    pub seed: u64,
    /// Standard deviation of the disturbance of the last restart; the first has none.
    pub noise: f64,
    /// The Euler characteristic of the whole surface, if known; the search ends where it is met.
    pub expected_euler: Option<i64>,
    /// A cycle of more corners than this, all of them passed straight by one curve, is a hole.
    pub patch_corners: usize,
    /// Patches given by hand, each as the points around it, junctions at least; they replace the
    /// search. Arcs with one patch only are the boundary.
    pub cycles: Vec<Vec<u32>>,
    /// Cycles that are patches, each by points that no other cycle passes all of.
    pub fill: Vec<Vec<u32>>,
    /// Cycles that are holes, likewise.
    pub hole: Vec<Vec<u32>>,
}

impl Default for CycleOptions {
    fn default() -> Self {
        Self::STANDARD
    }
}

impl CycleOptions {
    pub(in super::super) const STANDARD: Self = Self {
        restarts: 16,
        seed: 0,
        noise: 0.15,
        expected_euler: None,
        patch_corners: 8,
        cycles: Vec::new(),
        fill: Vec::new(),
        hole: Vec::new(),
    };

    pub(super) fn check(&self) -> Result<(), NetworkError> {
        if (0.0..=1.0).contains(&self.noise) {
            Ok(())
        } else {
            Err(NetworkError::Noise { noise: self.noise })
        }
    }
}

/// How cycles were found, and what they are.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct CycleReport {
    /// The energy, 0 for given cycles. Lower is more likely; differences only mean anything.
    pub energy: f64,
    /// Searches made.
    pub restarts: u32,
    /// Number of patches.
    pub patches: usize,
    /// Number of holes.
    pub holes: usize,
    /// Euler characteristic of every connected component, holes left out.
    pub euler: Vec<i64>,
    /// What the caller should look at.
    pub warnings: Vec<String>,
}
