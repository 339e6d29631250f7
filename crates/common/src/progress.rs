//! One observer for progress bars, histories, time limits and cancelling.

use std::ops::ControlFlow;

/// A step of a running computation, as its observer sees it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// Name of the phase, one of those in a run record: `domain`, `select`, `fit`, `evaluate`, ...
    pub phase: &'static str,
    /// Work done in this phase, in the units of `total`.
    pub done: u64,
    /// Work of this phase as far as it is known; 0 where it is not.
    pub total: u64,
    /// Present value of what is minimised, where there is one.
    pub objective: Option<f64>,
}

impl Progress {
    /// Returns a step of `phase` with `done` of `total` units finished.
    #[must_use]
    pub fn new(phase: &'static str, done: u64, total: u64) -> Self {
        Self {
            phase,
            done,
            total,
            objective: None,
        }
    }

    /// Returns the same step with the present value of the objective.
    #[must_use]
    pub fn with_objective(mut self, objective: f64) -> Self {
        self.objective = Some(objective);
        self
    }
}

/// Called between steps; [`ControlFlow::Break`] asks for the best result so far.
pub type Observer<'a> = dyn FnMut(&Progress) -> ControlFlow<()> + 'a;

/// Returns an observer that never interrupts.
pub fn unobserved() -> impl FnMut(&Progress) -> ControlFlow<()> {
    |_| ControlFlow::Continue(())
}

/// How an iterative computation ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The stopping rule of the method was met.
    Converged,
    /// No step improved the objective any more, before the stopping rule was met.
    Stalled,
    /// The allowed number of iterations was used up.
    MaxIterations,
    /// The observer asked to stop; the result is the best one until then.
    Stopped,
}
