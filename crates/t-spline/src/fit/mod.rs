//! The fit: a T-mesh refined where the surface is far from the samples, until it has control points enough.
//!
//! Every round solves one least-squares system for all control points and coefficients of caps, moves the
//! samples towards the nearest points of the surface, and splits the leaves with the largest sums of
//! squared errors. The last round splits just as many as the budget allows.
//!
//! # Reference
//! [He2006] §3.3. Deviations: the paper splits every leaf with an error above the tolerance, which costs
//! several times the control points at equal error; samples stay where the form has them there.

mod correction;
mod error;
mod marking;
mod samples;
mod system;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use msplines_common::Vector3;
use msplines_common::evaluate::Order;
use msplines_common::progress::{Observer, Outcome, Progress};
use serde::{Deserialize, Serialize};

pub use crate::options::{Correction, FitOptions, Refinement, Stop};
pub use error::FitError;
pub use samples::Sample;

use crate::caps::{CapKind, Caps};
use crate::complex::CylinderComplex;
use crate::space::{Rows, TSplineSpace};
use crate::spline::{SurfaceSamples, TSpline};
use crate::tmesh::{Grid, TMesh};
use samples::Sorted;
use system::System;

/// Rounds after which no fit goes on.
const MOST_ROUNDS: u32 = 200;

/// How many times more than elsewhere errors in a cap may be, as roots of mean squares.
const WORSE_CAP: f64 = 1.5;
/// Samples that a cap keeps at least, and the share of its largest radius.
const FEWEST: usize = 40;
const NARROWEST: f64 = 0.3;

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
    /// `Converged` at the budget or within the tolerance; `Stalled` if no leaf can be split any more;
    /// `Stopped` if the observer broke off.
    pub outcome: Outcome,
    /// Rounds.
    pub rounds: u32,
    /// Control points and coefficients of caps.
    pub unknowns: usize,
    /// Errors at the end.
    pub errors: Errors,
}

/// Fits a surface to samples.
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
    check(samples, options)?;
    let grids = grids(complex, samples, options.refinement.start);
    let mesh = TMesh::build(complex, &grids)?;
    let centre = centre(samples);
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
            let done = self.round(observer)?;
            self.rounds += 1;
            if let Some(outcome) = done {
                return Ok(outcome);
            }
        }
    }

    /// One round; how the fit ended, if it did.
    fn round(&mut self, observer: &mut Observer<'_>) -> Result<Option<Outcome>, FitError> {
        let mut system = self.solve(None)?;
        let unknowns = self.spline.space().unknowns();
        let full = match self.options.stop {
            Stop::ControlPoints(most) => self.next(most).is_none(),
            Stop::Tolerance(_) => false,
        };
        for _ in 0..self.steps(unknowns, full) {
            correction::correct(&self.spline, &mut self.sorted, &self.rows);
            self.sorted.sort(self.spline.space().mesh());
            system = self.solve(Some(system))?;
        }
        let errors = self.errors();
        self.levels.push(Level {
            spline: self.spline.clone(),
            errors,
        });
        let total = match self.options.stop {
            Stop::ControlPoints(most) => most,
            Stop::Tolerance(_) => 0,
        };
        let step = Progress::new("fit", unknowns as u64, total as u64).with_objective(errors.rms);
        if observer(&step).is_break() {
            return Ok(Some(Outcome::Stopped));
        }
        let most = match self.options.stop {
            _ if full => return Ok(Some(Outcome::Converged)),
            Stop::Tolerance(length) if errors.max <= length => return Ok(Some(Outcome::Converged)),
            Stop::Tolerance(_) => usize::MAX,
            Stop::ControlPoints(most) => most,
        };
        if self.rounds + 1 >= MOST_ROUNDS {
            return Ok(Some(Outcome::MaxIterations));
        }
        let Some(space) = self.next(most) else {
            let full = matches!(self.options.stop, Stop::ControlPoints(_));
            return Ok(Some(if full {
                Outcome::Converged
            } else {
                Outcome::Stalled
            }));
        };
        self.sorted.sort(space.mesh());
        let control = vec![Vector3::zeros(); space.unknowns()];
        self.spline = TSpline::new(Arc::new(space), control);
        Ok(None)
    }

    fn steps(&self, unknowns: usize, full: bool) -> u32 {
        let Correction::On { steps, from, last } = self.options.correction else {
            return 0;
        };
        let begun = match self.options.stop {
            Stop::ControlPoints(most) => unknowns as f64 >= from * most as f64,
            Stop::Tolerance(_) => self.rounds > 0,
        };
        match (full, begun) {
            (true, _) => last,
            (false, true) => steps,
            (false, false) => 0,
        }
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
            .solve(&self.sorted, &self.rows)
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

    /// Returns the next finer space of at most so many unknowns; none if there is none.
    fn next(&self, most: usize) -> Option<TSplineSpace> {
        let refinement = &self.options.refinement;
        let own = self.spline.space();
        let distances = self.distances();
        let ranked = marking::ranked(&self.spline, &self.sorted, &distances, refinement.exponent);
        let wanted = (refinement.share * own.mesh().leaves().len() as f64).ceil() as usize;
        let marked = marking::directed(
            &self.spline,
            &ranked[..wanted.min(ranked.len())],
            refinement,
        );
        let caps = match self.options.stop {
            // Of a coarse surface the caps are the worst part.
            Stop::ControlPoints(most) if 2 * own.unknowns() < most => own.caps().clone(),
            _ => self.narrowed(&distances),
        };
        let refined = |count: usize| {
            let mut mesh = own.mesh().clone();
            let more = mesh.refine(&marked[..count], &refinement.grading);
            (more > 0).then(|| TSplineSpace::with_caps(mesh, caps.clone()))
        };
        let fits = |space: &TSplineSpace| space.unknowns() <= most;
        if let Some(space) = refined(marked.len()).filter(fits) {
            return Some(space);
        }
        // As many of them as may be: the number of unknowns grows with every split.
        let (mut low, mut high) = (0, marked.len());
        let mut best = None;
        while high - low > 1 {
            let middle = low.midpoint(high);
            match refined(middle).filter(fits) {
                Some(space) => (low, best) = (middle, Some(space)),
                None => high = middle,
            }
        }
        best
    }

    /// Returns the caps, those of zeros narrower where a polynomial is further from the samples than the
    /// surface elsewhere.
    fn narrowed(&self, distances: &[f64]) -> Caps {
        let mut caps = self.spline.space().caps().clone();
        let (mut sums, mut counts) = (
            vec![0.0; caps.caps().len() + 1],
            vec![0_usize; caps.caps().len() + 1],
        );
        for (sample, distance) in self.sorted.samples.iter().zip(distances) {
            let place = caps.at(sample.at).map_or(0, |cap| 1 + cap.cap as usize);
            sums[place] += distance * distance;
            counts[place] += 1;
        }
        let mean = |place: usize| sums[place] / counts[place].max(1) as f64;
        let most = (WORSE_CAP * WORSE_CAP) * mean(0);
        for index in 0..caps.caps().len() {
            let cap = caps.caps()[index];
            let narrow = matches!(cap.kind, CapKind::Zero { .. }) && mean(index + 1) > most;
            if narrow && counts[index + 1] > FEWEST && cap.radius > NARROWEST * cap.limit {
                caps.set_radius(index as u32, 0.75 * cap.radius);
            }
        }
        caps
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

/// Returns a base grid for every cylinder, with as many faces as its share of the samples asks for.
fn grids(complex: &CylinderComplex, samples: &[Sample], cells: usize) -> Vec<Grid> {
    let mut shares = vec![0.0; complex.cylinders().len()];
    samples
        .iter()
        .for_each(|s| shares[s.at.cylinder as usize] += s.weight);
    let total: f64 = shares.iter().sum();
    let cylinders = complex.cylinders().iter().zip(&shares);
    cylinders
        .map(|(cylinder, share)| {
            let mut grid = Grid::of_cells(cylinder, (cells as f64 * share / total).max(1.0), 1.0);
            grid.columns = grid.columns.max(LEAST_COLUMNS);
            grid
        })
        .collect()
}

/// Columns that a support needs not to meet itself.
const LEAST_COLUMNS: usize = 4;

fn centre(samples: &[Sample]) -> Vector3<f64> {
    let sum: Vector3<f64> = samples.iter().map(|s| s.position.coords).sum();
    sum / samples.len() as f64
}

fn check(samples: &[Sample], options: &FitOptions) -> Result<(), FitError> {
    if samples.is_empty() {
        return Err(FitError::NoSamples);
    }
    let bad = |s: &Sample| {
        let numbers = [
            s.at.x,
            s.at.y,
            s.position.x,
            s.position.y,
            s.position.z,
            s.weight,
        ];
        numbers.iter().any(|n| !n.is_finite()) || s.weight < 0.0
    };
    if let Some(sample) = samples.iter().position(bad) {
        return Err(FitError::NotFinite { sample });
    }
    if let Stop::Tolerance(given) = options.stop
        && !(given > 0.0 && given.is_finite())
    {
        return Err(FitError::Tolerance { given });
    }
    let Refinement {
        share,
        exponent,
        ratio,
        ..
    } = options.refinement;
    let ranges = [
        ("share", share, "in (0, 1]", share > 0.0 && share <= 1.0),
        (
            "exponent",
            exponent,
            "positive",
            exponent > 0.0 && exponent.is_finite(),
        ),
        ("ratio", ratio, "1 or more", ratio >= 1.0),
        (
            "fairness",
            options.fairness,
            "0 or more",
            options.fairness >= 0.0 && options.fairness.is_finite(),
        ),
    ];
    let wrong = ranges.into_iter().find(|(.., good)| !good);
    wrong.map_or(Ok(()), |(option, given, range, _)| {
        Err(FitError::Option {
            option,
            range,
            given,
        })
    })
}
