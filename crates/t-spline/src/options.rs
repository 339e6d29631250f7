//! What can be chosen about a fit.

use serde::{Deserialize, Serialize};

use crate::caps::CapOptions;
use crate::tmesh::Grading;

/// When a fit has control points enough.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stop {
    /// As many as there may be.
    ControlPoints(usize),
    /// As soon as no measured sample is further off than this length.
    Tolerance(f64),
}

/// Whether samples move over the cylinders to the nearest points of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Correction {
    /// They stay where the form has them.
    Off,
    /// They move.
    On {
        /// Steps after every refinement.
        steps: u32,
        /// Share of the control points from which on they do.
        from: f64,
        /// Steps at the end.
        last: u32,
    },
}

/// How the systems of a fit are solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Solver {
    /// By a sparse Cholesky factorisation.
    #[default]
    Factorisation,
    /// By conjugate gradients on the system scaled to a diagonal of ones, as the paper does.
    ConjugateGradients {
        /// Residual over right-hand side at which it is solved.
        tolerance: f64,
        /// Most steps.
        steps: u32,
    },
}

/// How densely a surface is sampled for a fit: all its vertices and poles are taken, and faces that are too
/// large for the number of control points are sampled inside.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Sampling {
    /// Samples wanted per control point of the budget, 0 to [`Sampling::MOST_PER_CONTROL_POINT`]; with a
    /// tolerance faces are sampled as densely as vertices lie on average. 0 leaves it at vertices and poles.
    pub per_control_point: f64,
}

/// How a fit refines.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Refinement {
    /// Faces that the T-mesh begins with, about.
    pub start: usize,
    /// Share of the faces that are split in a round.
    pub share: f64,
    /// Faces are ranked by the sums of errors to this power.
    pub exponent: f64,
    /// How many times more a face must bend in one direction than in the other to be split in that one
    /// only.
    pub ratio: f64,
    /// Bounds on shapes and sizes.
    pub grading: Grading,
}

/// Options of [`fit`](crate::fit::fit).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FitOptions {
    /// When to stop.
    pub stop: Stop,
    /// Weight of the thin plate, relative to that of the samples.
    pub fairness: f64,
    /// How to solve.
    pub solver: Solver,
    /// Whether samples move.
    pub correction: Correction,
    /// How to refine.
    pub refinement: Refinement,
    /// The caps.
    pub caps: CapOptions,
}

impl Default for Correction {
    fn default() -> Self {
        Self::On {
            steps: 2,
            from: 0.5,
            last: 40,
        }
    }
}

impl Default for Sampling {
    fn default() -> Self {
        Self {
            per_control_point: 8.0,
        }
    }
}

impl Default for Refinement {
    fn default() -> Self {
        Self {
            start: 60,
            share: 0.03,
            exponent: 3.0,
            ratio: 2.5,
            grading: Grading::default(),
        }
    }
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            stop: Stop::ControlPoints(2000),
            fairness: 1e-7,
            solver: Solver::default(),
            correction: Correction::default(),
            refinement: Refinement::default(),
            caps: CapOptions::default(),
        }
    }
}
