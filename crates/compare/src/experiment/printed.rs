//! What a row is compared with: printed values, and our own of before.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// What a paper prints. Errors are fractions, times seconds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Printed {
    /// Vertices of the paper's mesh.
    pub vertices: Option<u64>,
    /// Mean error over the vertices.
    pub error: Option<f64>,
    /// Peak signal-to-noise ratio in decibels.
    pub psnr_db: Option<f64>,
    /// Knot optimisation.
    pub select_seconds: Option<f64>,
    /// Fit at the chosen knots.
    pub fit_seconds: Option<f64>,
    /// Evaluation.
    pub evaluate_seconds: Option<f64>,
    /// From start to end.
    pub total_seconds: Option<f64>,
    /// Iterations of the knot optimisation.
    pub iterations: Option<u32>,
    /// Values of the method, by their names in `checks` of a record; shown beside ours where a column has
    /// them, and never judged.
    #[serde(default)]
    pub checks: BTreeMap<String, f64>,
}

/// Our own value of a row, against regression.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recorded {
    /// Mean error over the vertices.
    pub error: f64,
    /// How far it may get worse, as a fraction.
    pub tolerance: f64,
}
