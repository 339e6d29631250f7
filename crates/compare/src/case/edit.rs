//! Control points that a run moves after its fit.

use serde::{Deserialize, Serialize};

/// Control points that are moved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Edit {
    /// The moves, all at once.
    pub moves: Vec<Move>,
    /// Whether what the spline leaves of the data is added to the result.
    pub keep_detail: bool,
}

/// Control points around a place that are moved together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Move {
    /// The place, as fractions of the sides of the bounding box.
    pub at: [f64; 3],
    /// By how much, as fractions of the diagonal of the bounding box.
    pub by: [f64; 3],
    /// Distance within which control points move, as a fraction of the diagonal; the nearest one
    /// always does.
    pub within: f64,
}
