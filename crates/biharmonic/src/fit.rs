//! Fitting: knots chosen or given, then the least-squares spline with these knots.

use std::sync::Arc;

use msplines_common::linalg::{CgReport, FactorError, Mat};
use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::{Observer, Outcome, Progress};
use serde::{Deserialize, Serialize};

use crate::gram::{Gram, Sight};
use crate::knot_values::KnotValues;
use crate::select::{Selected, Trial, select, select_cross_validated};
use crate::target::{Centred, Target};
use crate::{BiharmonicSpline, FitError, KnotChoice, Options, Space};

/// Share by which the squared error of the final fit may exceed its minimum. The mean error is exact
/// to five digits far earlier; this makes the spline itself the same to 1e-4 of that error.
const FIT_EXCESS: f64 = 1e-8;

/// Iterations allowed to the final fit.
const FIT_ITERATIONS: u32 = 400;

/// Iterations after which it gets a better preconditioner. Well-spread knots take 10; clustered ones
/// hundreds.
const SHORT_SIGHTED: u32 = 40;

/// A spline and how it came about.
#[derive(Debug)]
pub struct Fit {
    /// The spline.
    pub spline: BiharmonicSpline,
    /// How the fit went.
    pub report: Report,
}

/// How a fit went.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// How it ended.
    pub outcome: Outcome,
    /// Iterations of conjugate gradients of the final fit.
    pub iterations: u32,
    /// Relative residual of its normal equations.
    pub residual: f64,
    /// Rounds of elimination.
    pub eliminations: u32,
    /// Rounds of exchange, and how many of them were kept.
    pub exchanges: [u32; 2],
    /// Rounds of polish, and how many of them were kept.
    pub polish_rounds: [u32; 2],
    /// Rounds of the l1 selection.
    pub l1_rounds: u32,
    /// Numbers of knots that cross-validation tried, from many to few, with their scores.
    pub cross_validation: Vec<Trial>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Fits a spline to data at the vertices, with or without weights.
///
/// Any number of components is fitted at once with common knots. The cost is that of a few dozen
/// sparse factorisations and solves: about 25 CPU seconds for 100,000 vertices.
///
/// The observer sees the phases `domain`, `select` and `fit`. When it breaks, the knots found until
/// then are fitted, and the outcome is [`Outcome::Stopped`].
///
/// # Reference
/// [Hou2017] Alg. 2, Eq. (11). Deviation: knots by backward elimination and exchange.
///
/// # Errors
/// Knots or data that do not fit the mesh, or a mesh that is not connected or degenerate.
pub fn fit<'a>(
    mesh: &TriangleMesh,
    target: impl Into<Target<'a>>,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Fit, FitError> {
    let stopped = observer(&Progress::new("domain", 0, 1)).is_break();
    let creases = options.creases.on(mesh)?;
    checked_choice(mesh.vertex_count(), &options.knots)?;
    let target = Centred::check(mesh.vertex_count(), &target.into())?;
    let domain = Arc::new(mesh.clone());
    let KnotChoice::At(points) = &options.knots else {
        let space = Space::with_creases(domain, options.laplacian, creases)?;
        return fit_centred(&Arc::new(space), &target, options, stopped, observer);
    };
    let (space, vertices) = Space::with_points(domain, points, options.laplacian, &creases)?;
    check_apart(&vertices)?;
    let options = Options {
        knots: KnotChoice::Given(vertices),
        ..options.clone()
    };
    let target = target.on(&space);
    fit_centred(&Arc::new(space), &target, &options, stopped, observer)
}

/// Fits a spline in a space that is there already, to data with weights.
///
/// As [`fit`], but what depends on the mesh alone is shared with all other fits in this space. The
/// Laplacian, the creases and the points that can be knots are those of the space, whatever
/// `options` say.
///
/// # Reference
/// [Hou2017] Alg. 2, Eq. (11), Eq. (13). Deviation: knots by backward elimination and exchange.
///
/// # Errors
/// Knots, data or weights that do not fit the mesh.
pub fn fit_in<'a>(
    space: &Arc<Space>,
    target: impl Into<Target<'a>>,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Fit, FitError> {
    let stopped = observer(&Progress::new("domain", 0, 1)).is_break();
    let target = Centred::check(space.domain().vertex_count(), &target.into())?.on(space);
    fit_centred(space, &target, options, stopped, observer)
}

fn fit_centred(
    space: &Arc<Space>,
    target: &Centred,
    options: &Options,
    mut stopped: bool,
    observer: &mut Observer<'_>,
) -> Result<Fit, FitError> {
    let vertices = space.mesh().vertex_count();
    let given = checked_choice(vertices, &options.knots)?;
    if target.counted() < given.count() {
        return Err(FitError::TooFewWeights {
            weighted: target.counted(),
            knots: given.count(),
        });
    }
    if given.count() == vertices {
        let knots = (0..vertices as u32).collect();
        return Ok(Fit {
            spline: BiharmonicSpline::of_vertex_values(space, knots, &target.data, &target.mean),
            report: Report::direct(),
        });
    }
    prepare(space)?;
    stopped |= observer(&Progress::new("domain", 1, 1)).is_break();
    let selected = match given {
        Given::Knots(knots) => Selected::given(space, target, knots, stopped)?,
        Given::Count(count) => select(space, target, count, options, stopped, observer)?,
        Given::Points => return Err(FitError::PointsOutsideSpace),
        Given::CrossValidated => select_cross_validated(space, target, options, stopped, observer)?,
    };
    let mut warnings = selected.warnings;
    let (system, gram) = (selected.system, selected.gram);
    let _ = observer(&Progress::new("fit", 0, 1));
    let start = selected.fitted.as_ref().unwrap_or(&target.data);
    let (f, report) = fit_closely(space, &system, target, start, &gram)?;
    let _ = observer(&Progress::new("fit", 1, 1));
    if !report.converged {
        warnings.push(format!(
            "the fit stopped at a relative residual of {:.1e} after {} iterations; the knots are badly clustered",
            report.residual, report.iterations
        ));
    }
    let outcome = match (selected.outcome, report.converged) {
        (Outcome::Stopped, _) => Outcome::Stopped,
        (_, false) => Outcome::MaxIterations,
        (other, true) => other,
    };
    let knots = system.knots().to_vec();
    Ok(Fit {
        spline: BiharmonicSpline::of_vertex_values(space, knots, &f, &target.mean),
        report: Report {
            outcome,
            iterations: report.iterations,
            residual: report.residual,
            eliminations: selected.eliminations,
            exchanges: selected.exchanges,
            polish_rounds: selected.polish_rounds,
            l1_rounds: selected.l1_rounds,
            cross_validation: selected.cross_validation,
            warnings,
        },
    })
}

/// Orders and analyses the bi-Laplacian, and beside it the Laplacian, which the spline is evaluated
/// with: each of the two dissections leaves all cores but one idle.
fn prepare(space: &Space) -> Result<(), FitError> {
    if !space.creases().is_empty() {
        return space.bilaplacian().map(drop);
    }
    // A Laplacian that cannot be factored is an error of the evaluation.
    let (ready, _) = rayon::join(
        || space.bilaplacian().map(drop),
        || space.poisson().map(drop),
    );
    ready
}

/// Returns the spline with the knots of a system that is nearest to the target.
///
/// `gram` sees one ring; where knots cluster along edges of the data that is not enough, and another
/// takes its place.
pub(crate) fn fit_closely(
    space: &Space,
    system: &KnotValues<'_>,
    target: &Centred,
    start: &Mat<f64>,
    gram: &Gram,
) -> Result<(Mat<f64>, CgReport), FactorError> {
    let (f, report) = system.least_squares(target, start, gram, FIT_EXCESS, SHORT_SIGHTED);
    if report.converged {
        return Ok((f, report));
    }
    let gram = Gram::on(space, system, target, Sight::TwoRings)?;
    let (f, mut report) = system.least_squares(target, &f, &gram, FIT_EXCESS, FIT_ITERATIONS);
    report.iterations += SHORT_SIGHTED;
    Ok((f, report))
}

/// Checks that no two points have become the same vertex.
fn check_apart(vertices: &[u32]) -> Result<(), FitError> {
    let mut order: Vec<usize> = (0..vertices.len()).collect();
    order.sort_by_key(|&point| (vertices[point], point));
    let same = |pair: &&[usize]| vertices[pair[0]] == vertices[pair[1]];
    match order.windows(2).find(same) {
        Some(&[first, second]) => Err(FitError::CoincidentKnots { first, second }),
        _ => Ok(()),
    }
}

impl Report {
    fn direct() -> Self {
        Self {
            outcome: Outcome::Converged,
            iterations: 0,
            residual: 0.0,
            eliminations: 0,
            exchanges: [0, 0],
            polish_rounds: [0, 0],
            l1_rounds: 0,
            cross_validation: Vec::new(),
            warnings: Vec::new(),
        }
    }
}

enum Given {
    Knots(Vec<u32>),
    Count(usize),
    CrossValidated,
    Points,
}

impl Given {
    /// Returns the number of knots as far as it is known.
    fn count(&self) -> usize {
        match self {
            Self::Knots(knots) => knots.len(),
            Self::Count(count) => *count,
            Self::CrossValidated | Self::Points => 1,
        }
    }
}

fn checked_choice(vertices: usize, choice: &KnotChoice) -> Result<Given, FitError> {
    match choice {
        KnotChoice::All => Ok(Given::Knots((0..vertices as u32).collect())),
        KnotChoice::CrossValidated => Ok(Given::CrossValidated),
        // Only a fit that builds the space itself can split faces.
        KnotChoice::At(points) => {
            checked_count(vertices, points.len().min(vertices))?;
            Ok(Given::Points)
        }
        KnotChoice::Optimised { count } => {
            checked_count(vertices, *count)?;
            if *count == vertices {
                return Ok(Given::Knots((0..vertices as u32).collect()));
            }
            Ok(Given::Count(*count))
        }
        KnotChoice::Given(knots) => Ok(Given::Knots(checked_knots(vertices, knots)?)),
    }
}

/// Returns given knots, at least one, in ascending order.
pub(crate) fn checked_knots(vertices: usize, knots: &[u32]) -> Result<Vec<u32>, FitError> {
    checked_count(vertices, knots.len())?;
    ascending(vertices, knots)
}

/// Returns vertices in ascending order, if they exist and none is named twice.
pub(crate) fn ascending(vertices: usize, knots: &[u32]) -> Result<Vec<u32>, FitError> {
    for (index, &vertex) in knots.iter().enumerate() {
        if vertex as usize >= vertices {
            return Err(FitError::NoSuchKnot {
                index,
                vertex,
                vertices,
            });
        }
    }
    let mut sorted = knots.to_vec();
    sorted.sort_unstable();
    if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(FitError::RepeatedKnot { vertex: pair[0] });
    }
    Ok(sorted)
}

fn checked_count(vertices: usize, knots: usize) -> Result<(), FitError> {
    if knots == 0 || knots > vertices {
        return Err(FitError::KnotCount { knots, vertices });
    }
    Ok(())
}
