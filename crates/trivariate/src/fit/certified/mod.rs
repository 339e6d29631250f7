//! Least squares whose solid is proved not to fold.
//!
//! # Notation
//! Added to the squared distances are squared hinges `(1 - v / δ)²` of the volumes `v` of sampled
//! elements and of the Bernstein coefficients `v` of the determinant. Both are divided by what they would be
//! if the edges around them had right angles, or by their mean where that is less: a margin against
//! the mean alone would tear small spans along the edges of the cube into fins.
//! Cells and spans are watched that are within a few margins, and looked for anew every few evaluations:
//! what is not watched would fold unseen. Each round lowers the energy over all control points or, where
//! what is still wrong sits in few places, over those around it; then the weights of what is wrong and
//! of its neighbours grow. Weights that grew everywhere would make every later descent slow.
//!
//! A solid with a smooth boundary has no determinant along the twelve edges of the cube: two of its
//! derivatives there are opposite. The fit turns them towards each other just enough: the tiny
//! crease is measured in [`Report::creases`].

mod creases;
mod descent;
mod elements;
mod energy;
mod hinges;
mod local;
#[cfg(test)]
mod tests;

use std::ops::ControlFlow;

use msplines_common::Point3;
use msplines_common::progress::{Observer, Outcome, Progress};

pub use creases::{Creases, creases};

use self::descent::{Limits, descend};
use self::energy::Energy;
use self::hinges::{Hinges, Parts};
use self::local::Local;
use super::least_squares::{self, Problem, System, check, residuals, to_spline};
use crate::error::FitError;
use crate::measure::degenerate;
pub use crate::options::Certified as Options;
use crate::samples::VolumeSamples;
use crate::spline::TrivariateSpline;
use crate::validity::{Certificate, certify};

/// Descents around what is wrong before all is looked at again.
const MENDING_ROUNDS: u32 = 5;

/// Evaluations between two looks at what is to be watched.
const STRIDE: u32 = 20;

/// Decrease of a step, against the energy, below which a round ends.
const RESTING: f64 = 1e-4;

/// The same when nothing is wrong any more.
const POLISHED: f64 = 1e-5;

/// Least mean squared distance that weights are measured by, against the squared diagonal.
const LEAST_SQUARE: f64 = 1e-12;

/// A certified fit.
#[derive(Clone, Debug, PartialEq)]
pub struct CertifiedFit {
    /// The solid.
    pub spline: TrivariateSpline,
    /// The least-squares solid it started from.
    pub start: TrivariateSpline,
    /// What is proved of the solid.
    pub certificate: Certificate,
    /// How it went.
    pub report: Report,
}

/// How a certified fit went.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// `Converged` where all spans are certified and all elements positive; `MaxIterations` where
    /// rounds or evaluations were used up.
    pub outcome: Outcome,
    /// Levels of the least squares before it.
    pub levels: Vec<least_squares::Level>,
    /// Spans certified at the start.
    pub certified_before: usize,
    /// Degenerate elements of each sampling at the start.
    pub degenerate_before: Vec<usize>,
    /// Degenerate elements of each sampling in the end.
    pub degenerate: Vec<usize>,
    /// Weighted root mean square of the distances of the samples in the end.
    pub rms: f64,
    /// Largest distance of a sample in the end.
    pub max: f64,
    /// Rounds of hinges.
    pub rounds: u32,
    /// Evaluations of energy and gradient.
    pub evaluations: u32,
    /// Evaluations around what was still wrong, all else at rest.
    pub local_evaluations: u32,
    /// Angles along the twelve edges.
    pub creases: Creases,
}

/// Returns a least-squares solid whose determinant is proved positive on the whole cube and whose
/// sampled elements are positive, if rounds suffice; the report says whether they did.
///
/// # Reference
/// [Kim2014] §6, Table 1. Deviation: the paper reports that no element of two samplings is degenerate;
/// here that is enforced, and the determinant as well.
///
/// # Errors
/// As [`least_squares::fit`]; options out of range; samples that turn the solid inside out.
pub fn fit(
    samples: &VolumeSamples,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<CertifiedFit, FitError> {
    check_options(options)?;
    let spans = check(samples, &options.least_squares)?;
    let mut problem = Problem::start(samples, &options.least_squares);
    let (levels, n, system) = climb(samples, &mut problem, &spans, observer);
    let start = problem.spline();
    let before = State::of(&start, options);
    if before.certificate.volume <= 0.0 {
        return Err(FitError::InsideOut {
            volume: before.certificate.volume,
        });
    }
    let mut enforce = Enforce {
        options,
        problem: &problem,
        spans: n,
        stopped: n < options.least_squares.finest,
        rounds: 0,
        evaluations: 0,
        local_evaluations: 0,
    };
    let x = enforce.run(samples, &system, before.certificate.volume, observer);
    let spline = to_spline(n, &x, problem.centre());
    let after = State::of(&spline, options);
    let (rms, max) = residuals(samples, &spline);
    let outcome = match (after.is_good(), enforce.stopped) {
        (true, _) => Outcome::Converged,
        (false, true) => Outcome::Stopped,
        (false, false) => Outcome::MaxIterations,
    };
    let report = Report {
        outcome,
        levels,
        certified_before: before.certificate.certified,
        degenerate_before: before.degenerate,
        degenerate: after.degenerate,
        rms,
        max,
        rounds: enforce.rounds,
        evaluations: enforce.evaluations,
        local_evaluations: enforce.local_evaluations,
        creases: creases(&spline),
    };
    Ok(CertifiedFit {
        spline,
        start,
        certificate: after.certificate,
        report,
    })
}

/// Least squares through all levels, or until the observer asks to stop: their reports, and the equations
/// of the last one with its spans.
fn climb(
    samples: &VolumeSamples,
    problem: &mut Problem<'_>,
    spans: &[usize],
    observer: &mut Observer<'_>,
) -> (Vec<least_squares::Level>, usize, System) {
    let mut levels = Vec::new();
    loop {
        let n = spans[levels.len()];
        let (system, report) = problem.solve(n);
        let (rms, max) = residuals(samples, &problem.spline());
        levels.push(least_squares::Level {
            spans: n,
            rms,
            max,
            iterations: report.iterations,
            residual: report.residual,
        });
        let progress = Progress::new("fit", levels.len() as u64, spans.len() as u64);
        let stop = observer(&progress.with_objective(rms)) == ControlFlow::Break(());
        if stop || levels.len() == spans.len() {
            return (levels, n, system);
        }
    }
}

fn check_options(options: &Options) -> Result<(), FitError> {
    let positive = [
        ("margin", options.margin),
        ("element_weight", options.element_weight),
        ("coefficient_weight", options.coefficient_weight),
        ("growth", options.growth - 1.0),
    ];
    for (name, value) in positive {
        if !(value > 0.0 && value.is_finite()) {
            let range = if name == "growth" {
                "above 1"
            } else {
                "above 0"
            };
            return Err(FitError::Number { name, value, range });
        }
    }
    if let Some(&cells) = options.samplings.iter().find(|k| !(1..=200).contains(*k)) {
        return Err(FitError::Number {
            name: "samplings",
            value: cells as f64,
            range: "of cells from 1 to 200",
        });
    }
    Ok(())
}

/// What is proved and counted of a solid.
struct State {
    certificate: Certificate,
    degenerate: Vec<usize>,
}

impl State {
    fn of(spline: &TrivariateSpline, options: &Options) -> Self {
        let samplings = options.samplings.iter();
        Self {
            certificate: certify(spline, &options.certificate),
            degenerate: samplings.map(|&k| degenerate(spline, k)).collect(),
        }
    }

    fn is_good(&self) -> bool {
        self.certificate.holds() && self.degenerate.iter().all(|&count| count == 0)
    }
}

/// Rounds of hinges.
struct Enforce<'a> {
    options: &'a Options,
    problem: &'a Problem<'a>,
    spans: usize,
    stopped: bool,
    rounds: u32,
    evaluations: u32,
    local_evaluations: u32,
}

impl Enforce<'_> {
    /// Control points after all rounds.
    fn run(
        &mut self,
        samples: &VolumeSamples,
        system: &System,
        volume: f64,
        observer: &mut Observer<'_>,
    ) -> Vec<f64> {
        let options = self.options;
        let mut x = self.problem.values().to_vec();
        let mut energy = self.energy(samples, system, volume);
        let all = energy.hinges.all();
        energy.hinges.watch(&x, &all);
        let mut bad = energy.hinges.bad(&x, options);
        let mut stalled = 0;
        while !bad.is_empty() && !self.stopped && self.rounds < options.rounds {
            self.rounds += 1;
            let before = bad.len();
            x = match Local::around(&bad, (self.rounds, stalled), &mut energy, x) {
                Ok(mut local) => self.mend(&mut local),
                Err(x) => self.descend_everywhere(&mut energy, &all, x),
            };
            energy.hinges.watch(&x, &all);
            bad = energy.hinges.bad(&x, options);
            stalled += u32::from(bad.len() >= before);
            energy.hinges.reinforce(&bad, options.growth);
            let progress = Progress::new("fit", self.rounds.into(), options.rounds.into());
            let stop = observer(&progress.with_objective(bad.len() as f64));
            self.stopped = !bad.is_empty() && stop == ControlFlow::Break(());
        }
        if bad.is_empty() && self.rounds > 0 {
            self.polish(&mut energy, &all, &mut x);
        }
        x
    }

    /// Goes on from where nothing is wrong, to places where nothing is wrong either: rounds end early,
    /// with thin spikes at corners that the samples have not pulled back yet.
    fn polish(&mut self, energy: &mut Energy<'_>, all: &Parts, x: &mut Vec<f64>) {
        let mut left = self.options.polishing;
        while left > 0 {
            let limits = Limits {
                evaluations: left.min(STRIDE),
                tolerance: POLISHED,
            };
            let mut next = x.clone();
            let (end, used) = descend(energy, &mut next, limits);
            self.evaluations += used;
            left = left.saturating_sub(used);
            energy.hinges.watch(&next, all);
            let bad = energy.hinges.bad(&next, self.options);
            if !bad.is_empty() {
                energy.hinges.reinforce(&bad, self.options.growth);
                continue;
            }
            *x = next;
            if end != descent::End::Evaluations {
                break;
            }
        }
    }

    /// Moves all control points.
    fn descend_everywhere(
        &mut self,
        energy: &mut Energy<'_>,
        all: &Parts,
        mut x: Vec<f64>,
    ) -> Vec<f64> {
        let mut left = self.options.evaluations;
        while left > 0 {
            let limits = Limits {
                evaluations: left.min(STRIDE),
                tolerance: RESTING,
            };
            let (end, used) = descend(energy, &mut x, limits);
            self.evaluations += used;
            left = left.saturating_sub(used);
            energy.hinges.watch(&x, all);
            if end != descent::End::Evaluations {
                break;
            }
        }
        x
    }

    /// Moves a few control points until nothing near them is wrong, or a few rounds are over.
    fn mend(&mut self, local: &mut Local<'_>) -> Vec<f64> {
        let parts = local.parts();
        let mut values = local.values();
        for _ in 0..MENDING_ROUNDS {
            let limits = Limits {
                evaluations: self.options.evaluations,
                tolerance: RESTING,
            };
            let (_, used) = descend(local, &mut values, limits);
            self.local_evaluations += used;
            let x = local.whole(&values);
            local.hinges.watch(&x, &parts);
            let bad = local.hinges.bad(&x, self.options);
            if bad.is_empty() {
                break;
            }
            local.hinges.reinforce(&bad, self.options.growth);
        }
        local.whole(&values)
    }

    /// The energy of a round, whose weights are measured by the squares at the start.
    fn energy<'a>(&self, samples: &VolumeSamples, system: &'a System, volume: f64) -> Energy<'a> {
        let start = (samples.points()[0], samples.points()[0]);
        let grow = |(low, high): (Point3<f64>, Point3<f64>), p| (low.inf(p), high.sup(p));
        let (low, high) = samples.points().iter().fold(start, grow);
        let scale = samples.total_weight() * (high - low).norm_squared();
        let constant = self.problem.constant();
        let squares = system.equations.energy(self.problem.values(), constant) / scale;
        let unit = squares.max(LEAST_SQUARE);
        Energy {
            system,
            scale,
            constant,
            hinges: Hinges::build(self.spans, volume, self.options, unit),
        }
    }
}
