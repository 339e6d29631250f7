//! Functions on charts that agree: Algorithm 1.
//!
//! # Notation
//! `r = h - f` are the residuals at the observations, `A_j` the weighted atoms of chart `j` at its
//! samples, `c_j` its coefficients. A chart that takes its turn sees the data `t = r + A_j c_j`, finds
//! new coefficients for them by a pursuit, and changes `r` by `A_j` times the difference.
//!
//! # Reference
//! [Wang2016] Eq. (5), Eq. (6), Eq. (7), Eq. (8), Alg. 1. Deviation: new atoms replace old ones only
//! where they are better than new coefficients of the old ones, so that every turn lowers the error;
//! charts without a common face take their turns side by side.

pub(crate) mod charts;
pub(crate) mod design;
pub(crate) mod frozen;
mod kernels;
pub(crate) mod state;

use msplines_common::mesh::polygon::{PolygonMesh, Rules, Sharpness};
use msplines_common::progress::{Observer, Outcome, Progress};

use crate::dictionary::DictionaryKind;
use crate::domain::{Domain, Star, sharp_charts};
use crate::error::FitError;
use crate::observations::{LimitGrid, Observations};
use crate::options::{Gate, Local, Options, SweepOrder};
use crate::spline::SparseManifold;
use frozen::Frozen;
use state::State;

/// Highest valence that a chart takes: nodes of shape functions, two for each sector, are numbered with
/// 8 bits, and its Gram matrix has the square of the number of atoms.
pub(crate) const MOST_VALENCE: u32 = 120;

/// Most levels of observations: a chart of valence 4 then has 13,689.
const MOST_LEVELS: u32 = 6;

/// Steps of conjugate gradients over which progress is judged.
const RESTING: u32 = 4;

/// A fitted surface, and how the fit went.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The surface.
    pub spline: SparseManifold,
    /// How it came about.
    pub report: Report,
}

/// How a fit went.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// How it ended.
    pub outcome: Outcome,
    /// Sum of squared distances of the observations, after the charts for themselves and after every
    /// sweep.
    pub e_fit: Vec<f64>,
    /// Number of observations.
    pub observations: usize,
    /// Sweeps in which atoms were chosen.
    pub sweeps: u32,
    /// Sweeps with the atoms kept.
    pub frozen_sweeps: u32,
    /// Shape functions of a chart and a coordinate, on average over sharp charts.
    pub c0_atoms_crease: f64,
    /// The same over the other charts.
    pub c0_atoms_smooth: f64,
}

/// Returns the surface that approximates the Catmull-Clark surface of a control mesh.
///
/// # Reference
/// [Wang2016] §4.1.
///
/// # Errors
/// A mesh that is not of quads, options out of range, or positions that are not finite.
pub fn fit(
    mesh: &PolygonMesh,
    sharpness: &Sharpness,
    rules: Rules,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Fit, FitError> {
    check(mesh, options)?;
    let grid = LimitGrid::build(mesh, sharpness, rules, options.levels);
    let observations = grid.observations(mesh.positions());
    fit_to(mesh, sharpness, &observations, options, observer)
}

/// Returns the surface over a control mesh that approximates given points of its grids.
///
/// # Errors
/// As [`fit`]; observations of another mesh.
pub fn fit_to(
    mesh: &PolygonMesh,
    sharpness: &Sharpness,
    observations: &Observations,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Fit, FitError> {
    check(mesh, options)?;
    check_observations(mesh, observations)?;
    let domain = Domain::build(mesh.topology());
    let sharp = sharp_charts(mesh.topology(), sharpness);
    let mut state = State::start(mesh.topology(), domain, &sharp, observations, options);
    check_splines(&state, options)?;
    let report = run(&mut state, &sharp, options, observer);
    let spline = state.spline(mesh, options);
    Ok(Fit { spline, report })
}

pub(crate) fn run(
    state: &mut State,
    sharp: &[bool],
    options: &Options,
    observer: &mut Observer<'_>,
) -> Report {
    let mut report = Report {
        outcome: Outcome::Converged,
        e_fit: vec![state.e_fit()],
        observations: state.residual.len(),
        sweeps: 0,
        frozen_sweeps: 0,
        c0_atoms_crease: 0.0,
        c0_atoms_smooth: 0.0,
    };
    sweep(state, &mut report, options, observer);
    [report.c0_atoms_smooth, report.c0_atoms_crease] = state.shape_counts(sharp);
    report
}

/// Splines are local: where a chart has fewer observations, those between them may be anything. Of
/// polynomials the lower degrees are determined first, and the others left out.
fn check_splines(state: &State, options: &Options) -> Result<(), FitError> {
    if options.local != Local::Spline {
        return Ok(());
    }
    let charts = state.charts.iter();
    let mut counts = charts.map(|chart| (chart.observations.len(), chart.design.atoms));
    match counts.position(|(found, needed)| found < needed) {
        None => Ok(()),
        Some(chart) => Err(FitError::TooFewObservations {
            chart,
            found: state.charts[chart].observations.len(),
            needed: state.charts[chart].design.atoms,
        }),
    }
}

/// Sweeps until one brings too little.
fn sweep(state: &mut State, report: &mut Report, options: &Options, observer: &mut Observer<'_>) {
    let total = u64::from(options.sweeps) + u64::from(options.frozen_sweeps);
    let all: Vec<Vec<u32>> = state.domain.colours().to_vec();
    let mut go_on = |report: &Report| {
        let done = u64::from(report.sweeps + report.frozen_sweeps);
        let e = report.e_fit.last().copied().unwrap_or_default();
        observer(&Progress::new("fit", done, total).with_objective(e)).is_continue()
    };
    for _ in 0..options.sweeps {
        if !go_on(report) {
            report.outcome = Outcome::Stopped;
            return;
        }
        let before = state.clone_functions(options);
        match options.order {
            SweepOrder::GaussSeidel => state.select(&all, options),
            SweepOrder::Jacobi { damping } => state.select_all_at_once(damping, options),
        }
        let e = state.e_fit();
        let last = report.e_fit[report.e_fit.len() - 1];
        if let (Some(before), true) = (before, e >= last) {
            // Algorithm 1 goes on while the error is reduced.
            state.restore(before);
            break;
        }
        report.sweeps += 1;
        report.e_fit.push(e);
        if options.order == SweepOrder::GaussSeidel && last - e <= options.least_progress * last {
            break;
        }
    }
    let mut frozen = Frozen::factor(state, (0..state.charts.len() as u32).collect());
    for _ in 0..options.frozen_sweeps {
        if !go_on(report) {
            report.outcome = Outcome::Stopped;
            return;
        }
        frozen.sweep(state);
        report.frozen_sweeps += 1;
        report.e_fit.push(state.e_fit());
        // Conjugate gradients rest and go on again: one short step says little.
        if report.frozen_sweeps >= RESTING {
            let [before, .., e] = report.e_fit[report.e_fit.len() - 1 - RESTING as usize..] else {
                return;
            };
            if before - e <= options.least_progress * f64::from(RESTING) * before {
                return;
            }
        }
    }
}

pub(crate) fn check(mesh: &PolygonMesh, options: &Options) -> Result<(), FitError> {
    mesh.check_quads()?;
    let levels = options.levels;
    if !(1..=MOST_LEVELS).contains(&levels) {
        return Err(FitError::Levels { levels });
    }
    match options.local {
        Local::Sparse { sparsity: 0, .. } => return Err(FitError::NoAtoms),
        Local::Sparse {
            dictionary: DictionaryKind::Shapes,
            ..
        } if options.gate == Gate::Sharp || !options.smooth_charts.is_empty() => {
            return Err(FitError::EmptyCharts);
        }
        Local::Polynomial {
            degree: Some(degree),
        } if degree > crate::dictionary::DEGREE => return Err(FitError::Degree { degree }),
        _ => {}
    }
    let number = |name, value: f64, ok: bool, range| {
        if ok {
            return Ok(());
        }
        Err(FitError::Number { name, value, range })
    };
    let progress = options.least_progress;
    number(
        "least_progress",
        progress,
        (0.0..1.0).contains(&progress),
        "from 0 to below 1",
    )?;
    if let SweepOrder::Jacobi { damping } = options.order {
        number(
            "damping",
            damping,
            damping > 0.0 && damping <= 1.0,
            "above 0, at most 1",
        )?;
    }
    let charts = mesh.vertex_count();
    if let Some(&chart) = options
        .smooth_charts
        .iter()
        .find(|&&c| c as usize >= charts)
    {
        return Err(FitError::NoSuchChart { chart, charts });
    }
    match first_crowded(mesh) {
        None => Ok(()),
        Some((vertex, valence)) => Err(FitError::Valence {
            vertex,
            valence,
            most: MOST_VALENCE,
        }),
    }
}

/// Returns the first vertex whose star, closed where it lies on the boundary, has more faces than a chart
/// takes, and how many.
pub(crate) fn first_crowded(mesh: &PolygonMesh) -> Option<(u32, u32)> {
    (0..mesh.vertex_count() as u32)
        .map(|vertex| (vertex, Star::of(mesh.topology(), vertex).valence))
        .find(|&(_, valence)| valence > MOST_VALENCE)
}

fn check_observations(mesh: &PolygonMesh, observations: &Observations) -> Result<(), FitError> {
    let side = observations.side();
    let expected = mesh.face_count() * side * side;
    let found = observations.grids.len();
    if found != expected {
        return Err(FitError::WrongLength { found, expected });
    }
    match observations.first_infinite() {
        Some(index) => Err(FitError::NotFinite { index }),
        None => Ok(()),
    }
}
