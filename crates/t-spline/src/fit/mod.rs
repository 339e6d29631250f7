//! The fit: a T-mesh refined where the surface is far from the samples, until it has control points enough.
//!
//! Every round solves one least-squares system for all control points and coefficients of caps, moves the
//! samples towards the nearest points of the surface, and splits the leaves with the largest sums of
//! errors to a power. The last split takes just as many leaves as the budget allows; the samples of the
//! surface after it move some more.
//!
//! # Reference
//! [He2006] §3.3. Deviations: the paper splits every leaf with an error above the tolerance, which costs
//! several times the control points at equal error; samples stay where the form has them there.

mod correction;
mod error;
mod fairness;
mod marking;
mod refine;
mod samples;
mod surface;
mod system;
mod task;
#[cfg(test)]
mod tests;

use std::ops::ControlFlow;
use std::sync::Arc;

use msplines_common::Vector3;
use msplines_common::evaluate::Order;
use msplines_common::progress::{Observer, Outcome, Progress};
use serde::{Deserialize, Serialize};

pub use crate::options::{Correction, FitOptions, Refinement, Sampling, Solver, Stop};
pub use error::FitError;
pub use samples::Sample;
pub use surface::FittedSurface;

use crate::complex::CylinderComplex;
use crate::space::{Rows, TSplineSpace};
use crate::spline::{SurfaceSamples, TSpline};
use crate::tmesh::TMesh;
use samples::Sorted;
use system::System;

/// A tolerance that the largest error exceeds by less than this is tried for by moving samples before
/// more leaves are split.
const WITHIN_REACH: f64 = 1.2;

/// A surface and how it was found.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The surface.
    pub spline: TSpline,
    /// The samples, in the order given, where they are now.
    pub samples: Vec<Sample>,
    /// All surfaces on the way, the last one included.
    pub levels: Vec<Level>,
    /// How the fit ended.
    pub report: FitReport,
}

/// One surface on the way.
#[derive(Clone, Debug)]
pub struct Level {
    /// The surface.
    pub spline: TSpline,
    /// Its errors at the measured samples.
    pub errors: Errors,
}

/// Errors at the measured samples, as lengths.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Root of their mean square.
    pub rms: f64,
    /// The largest.
    pub max: f64,
}

/// How a fit ended.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FitReport {
    /// `Converged` at the budget or within the tolerance; `Stalled` if none of the worst leaves can be
    /// split any more; `Stopped` if the observer broke off.
    pub outcome: Outcome,
    /// Rounds.
    pub rounds: u32,
    /// Control points and coefficients of caps.
    pub unknowns: usize,
    /// Errors at the end.
    pub errors: Errors,
}

/// Fits a surface to samples; [`TSplineSurface::fit`](crate::TSplineSurface::fit) does so to those of a whole
/// mesh.
///
/// `observer` sees the phase `fit` with the root mean square error as its objective; a break ends with
/// the surface that was reached. The cost of a round is that of the rows of all samples and a sparse
/// factorisation.
///
/// # Reference
/// [He2006] §3.3, Eq. (3).
///
/// # Errors
/// Samples, budgets or options that are no task; a complex that carries no T-mesh.
pub fn fit(
    complex: &Arc<CylinderComplex>,
    samples: &[Sample],
    options: &FitOptions,
    observer: &mut Observer<'_>,
) -> Result<Fit, FitError> {
    task::check(complex, samples, options)?;
    let grids = task::grids(complex, samples, options.refinement.start);
    let mesh = TMesh::build(complex, &grids)?;
    let centre = task::centre(samples);
    let centred: Vec<Sample> = samples
        .iter()
        .map(|s| Sample {
            position: s.position - centre,
            ..*s
        })
        .collect();
    let mut state = State::new(mesh, &centred, options)?;
    let outcome = state.run(observer)?;
    let errors = state.errors();
    Ok(state.finish(outcome, errors, centre))
}

struct State<'a> {
    options: &'a FitOptions,
    sorted: Sorted,
    rows: Rows,
    spline: TSpline,
    levels: Vec<Level>,
    rounds: u32,
}

impl<'a> State<'a> {
    fn new(mesh: TMesh, samples: &[Sample], options: &'a FitOptions) -> Result<Self, FitError> {
        let sorted = Sorted::new(samples, &mesh);
        let space = Arc::new(TSplineSpace::build(mesh, &options.caps)?);
        let least = space.unknowns();
        if let Stop::ControlPoints(given) = options.stop
            && given < least
        {
            return Err(FitError::Budget { given, least });
        }
        let control = vec![Vector3::zeros(); least];
        Ok(Self {
            options,
            sorted,
            rows: Rows::default(),
            spline: TSpline::new(space, control),
            levels: Vec::new(),
            rounds: 0,
        })
    }

    fn run(&mut self, observer: &mut Observer<'_>) -> Result<Outcome, FitError> {
        loop {
            if let Some(outcome) = self.round(observer)? {
                return Ok(outcome);
            }
        }
    }

    /// One round; how the fit ended, if it did.
    fn round(&mut self, observer: &mut Observer<'_>) -> Result<Option<Outcome>, FitError> {
        let mut system = self.solve(None)?;
        for _ in 0..self.steps() {
            system = self.correct(system)?;
        }
        self.rounds += 1;
        let mut stopped = self.tell(observer).is_break();
        if !stopped && !self.is_within(1.0) && self.is_within(WITHIN_REACH) {
            (system, stopped) = self.polish(system, observer)?;
        }
        let next = if stopped {
            Err(Outcome::Stopped)
        } else {
            self.next()
        };
        if matches!(next, Err(outcome) if outcome != Outcome::Stopped) && !self.is_within(1.0) {
            (_, stopped) = self.polish(system, observer)?;
        }
        self.levels.push(Level {
            spline: self.spline.clone(),
            errors: self.errors(),
        });
        match next {
            _ if stopped => Ok(Some(Outcome::Stopped)),
            Err(_) if self.is_within(1.0) => Ok(Some(Outcome::Converged)),
            Err(outcome) => Ok(Some(outcome)),
            Ok(space) => {
                self.sorted.sort(space.mesh());
                let control = vec![Vector3::zeros(); space.unknowns()];
                self.spline = TSpline::new(Arc::new(space), control);
                Ok(None)
            }
        }
    }

    /// Steps of correction between two refinements.
    fn steps(&self) -> u32 {
        let Correction::On { steps, from, .. } = self.options.correction else {
            return 0;
        };
        let begun = match self.options.stop {
            Stop::ControlPoints(most) => {
                self.spline.space().unknowns() as f64 >= from * most as f64
            }
            Stop::Tolerance(_) => self.rounds > 0,
        };
        if begun { steps } else { 0 }
    }

    /// Moves the samples once and fits the control points to them.
    fn correct(&mut self, system: System) -> Result<System, FitError> {
        correction::correct(&self.spline, &mut self.sorted, &self.rows);
        self.sorted.sort(self.spline.space().mesh());
        self.solve(Some(system))
    }

    /// Moves the samples of a surface that is not refined, or need not be, until it is within the
    /// tolerance; whether the observer broke off.
    fn polish(
        &mut self,
        mut system: System,
        observer: &mut Observer<'_>,
    ) -> Result<(System, bool), FitError> {
        let steps = match self.options.correction {
            Correction::On { last, .. } => last,
            Correction::Off => 0,
        };
        for _ in 0..steps {
            system = self.correct(system)?;
            if self.is_within(1.0) {
                break;
            }
            if self.tell(observer).is_break() {
                return Ok((system, true));
            }
        }
        Ok((system, false))
    }

    /// Whether there is a tolerance, and no error is larger than so many times it.
    fn is_within(&self, times: f64) -> bool {
        match self.options.stop {
            Stop::Tolerance(length) => self.errors().max <= times * length,
            Stop::ControlPoints(_) => false,
        }
    }

    fn tell(&self, observer: &mut Observer<'_>) -> ControlFlow<()> {
        let total = match self.options.stop {
            Stop::ControlPoints(most) => most,
            Stop::Tolerance(_) => 0,
        };
        let unknowns = self.spline.space().unknowns();
        let step = Progress::new("fit", unknowns as u64, total as u64);
        observer(&step.with_objective(self.errors().rms))
    }

    /// Fits the control points to the samples where they are.
    fn solve(&mut self, system: Option<System>) -> Result<System, FitError> {
        let space = Arc::clone(self.spline.space());
        space.rows_into(&self.sorted.points, Order::First, &mut self.rows);
        let kept = system.filter(|s| s.holds(&self.sorted, &self.rows));
        let mut system = kept.unwrap_or_else(|| {
            System::build(&space, &self.sorted, &self.rows, self.options.fairness)
        });
        let control = system
            .solve(&self.sorted, &self.rows, self.options.solver)
            .map_err(|reason| FitError::Solve {
                unknowns: space.unknowns(),
                reason: reason.to_string(),
            })?;
        self.spline = TSpline::new(space, control);
        Ok(system)
    }

    fn distances(&self) -> Vec<f64> {
        let mut found = SurfaceSamples::default();
        self.spline.apply(&self.rows, Order::Value, &mut found);
        let pairs = self.sorted.samples.iter().zip(&found.positions);
        pairs.map(|(s, p)| (s.position - p).norm()).collect()
    }

    fn errors(&self) -> Errors {
        let (mut sum, mut count, mut max) = (0.0, 0_usize, 0.0_f64);
        let distances = self.distances();
        let measured = self
            .sorted
            .samples
            .iter()
            .zip(&distances)
            .filter(|(s, _)| s.measured);
        for (_, distance) in measured {
            sum += distance * distance;
            count += 1;
            max = max.max(*distance);
        }
        Errors {
            rms: (sum / count.max(1) as f64).sqrt(),
            max,
        }
    }

    fn finish(self, outcome: Outcome, errors: Errors, centre: Vector3<f64>) -> Fit {
        let back = |spline: &TSpline| translated(spline, centre);
        Fit {
            report: FitReport {
                outcome,
                rounds: self.rounds,
                unknowns: self.spline.space().unknowns(),
                errors,
            },
            samples: {
                let mut samples = self.sorted.restored();
                samples.iter_mut().for_each(|s| s.position += centre);
                samples
            },
            levels: self
                .levels
                .iter()
                .map(|l| Level {
                    spline: back(&l.spline),
                    errors: l.errors,
                })
                .collect(),
            spline: back(&self.spline),
        }
    }
}

/// Returns a surface moved by a vector: control points, and the constants of caps.
fn translated(spline: &TSpline, by: Vector3<f64>) -> TSpline {
    let space = spline.space();
    let functions = space.functions().len();
    let mut control = spline.control().to_vec();
    control[..functions].iter_mut().for_each(|c| *c += by);
    for cap in space.caps().caps() {
        control[functions + cap.offset as usize] += by;
    }
    TSpline::new(Arc::clone(space), control)
}
