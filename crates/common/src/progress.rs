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

/// The observer asked to stop before there was anything to give.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("stopped before there was a result; allow more time")]
pub struct Stopped;

/// The stages of a computation that has no result before its end.
///
/// # Examples
/// ```
/// use msplines_common::progress::{Stages, unobserved};
///
/// let mut observer = unobserved();
/// let mut stages = Stages::new("domain", 2, &mut observer);
/// stages.enter()?;
/// stages.enter()?;
/// # Ok::<(), msplines_common::progress::Stopped>(())
/// ```
pub struct Stages<'a, 'o> {
    phase: &'static str,
    done: u64,
    total: u64,
    observer: &'a mut Observer<'o>,
}

impl<'a, 'o> Stages<'a, 'o> {
    /// Returns the stages of a phase, none of them done; `total` is 0 where their number is not known.
    pub fn new(phase: &'static str, total: u64, observer: &'a mut Observer<'o>) -> Self {
        Self {
            phase,
            done: 0,
            total,
            observer,
        }
    }

    /// Enters the next stage.
    ///
    /// # Errors
    /// The observer asks to stop.
    pub fn enter(&mut self) -> Result<(), Stopped> {
        let step = Progress::new(self.phase, self.done, self.total);
        self.done += 1;
        match (self.observer)(&step) {
            ControlFlow::Break(()) => Err(Stopped),
            ControlFlow::Continue(()) => Ok(()),
        }
    }
}

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
