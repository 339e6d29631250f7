//! Runs of trivariate splines: from a solid over the cube to its spline, and what is known about it.

mod boundary;
mod cylinder;
mod deform;
mod evaluate;
mod measure;
mod pictures;
mod tetgen;
mod write;

use msplines_common::progress::Observer;
use msplines_trivariate::domain::mesher::Crossings;
use msplines_trivariate::fit::least_squares;
use msplines_trivariate::options::Fitting;
use msplines_trivariate::solid::{self, SolidError, SolidFit};
use msplines_trivariate::spline::MOST_SPANS;
use msplines_trivariate::{FitError, TrivariateSpline};
use serde_json::{Value, json};

use super::{RunOutput, enter, steps};
use crate::case::{Case, Filler, Input, SolidMap, TrivariateMethod};
use crate::clock::PhaseClock;
use crate::error::{RunError, TrivariateError};
use crate::fit::following;
use crate::input::solid::{Given, load_solid};
use crate::record::{InputFacts, Record};
use crate::spline_file::{SplineFile, StoredCube, StoredDomain, StoredSpline, StoredTrivariate};
use boundary::CubeSurface;
use write::Written;

pub(super) use evaluate::evaluate;

/// Most cells in each direction of a sampling.
const MOST_CELLS: usize = 200;
/// Most squares along an edge of the cube.
const MOST_SQUARES: usize = 1024;

/// What refusals call these splines.
const SPLINE: &str = "a trivariate spline";

/// Runs a case whose method is a trivariate spline.
pub(super) fn run(
    case: &Case,
    method: &TrivariateMethod,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    check(case, method)?;
    let method = &mended(case, method);
    let input = load_solid(&case.input, clock)?;
    if method.map == SolidMap::Cylinder {
        return cylinder::run(case, method, &input, clock, observer);
    }
    enter("domain", clock, observer);
    let fit = fitted(&input.given, method, clock, observer)?;
    let moved = deform::moved(fit.fitted.spline(), &method.moves, fit.domain.diagonal())?;
    let spline = SplineFile::new(
        StoredDomain::Cube {
            cube: StoredCube::of(&input.facts),
        },
        options(case, method),
        StoredSpline::Trivariate(StoredTrivariate::of(&moved)),
    );
    // What is measured and written is what is stored.
    let stored = spline.spline.trivariate("evaluation")?.restore()?;
    enter("evaluate", clock, observer);
    let squares = squares(&stored, method.cells);
    let mesh = CubeSurface::new(squares).of(&stored)?;
    enter("measure", clock, observer);
    let is_moved = !method.moves.is_empty();
    let fitted = [&stored, fit.fitted.spline()][usize::from(is_moved)];
    let surface = input.given.surface();
    let parameters = fit.domain.surface_parameters(surface.positions());
    let mut record = record(case.seed, &input.facts, &spline, &stored);
    record.outcome = fit.fitted.outcome();
    let mean = measured(&mut record, case, method, &fit, [fitted, &stored]);
    measure::vertex_errors(&mut record, fitted, &parameters, &surface);
    steps::distances(&mut record, case, [&surface, &mesh], || {
        measure::surface_distance(&stored, &surface, case.seed)
    })?;
    let fields = pictures::boundary_fields(&stored, squares, mean, Some(&surface));
    let shown = (squares, method.cut, mean);
    let companions = pictures::companions(&stored, (&surface, &parameters), shown);
    enter("write", clock, observer);
    let written = Written {
        file: &spline,
        spline: &stored,
        cells: method.cells,
        boundary: &mesh,
        fields: &fields,
    };
    write::write(&case.outputs, &written)?;
    record.warnings.splice(0..0, input.warnings);
    record.check("evaluated_points", mesh.vertex_count());
    steps::finish(&mut record, clock);
    Ok(RunOutput {
        fields,
        companions,
        ..RunOutput::of_surface(record, Some(spline), mesh)
    })
}

/// Returns the method with crossings of the surface mended, where the case mends its input.
fn mended(case: &Case, method: &TrivariateMethod) -> TrivariateMethod {
    let mut method = method.clone();
    if case.input.is_mended() {
        method.options.domain.mesher.crossings = Crossings::United;
    }
    method
}

/// Fits the spline; the clock follows the phases that the method reports.
fn fitted(
    given: &Given,
    method: &TrivariateMethod,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<SolidFit, RunError> {
    let mut timed = following(&["domain", "fit"], clock, observer);
    let filled = match (method.filler, given) {
        (Filler::Tetgen, Given::Surface(surface)) => {
            let spacing = method.options.domain.mesher.spacing;
            Some(Given::Cells(tetgen::fill(surface, spacing)?))
        }
        (Filler::Tetgen | Filler::Lattice, _) => None,
    };
    let solid = filled.as_ref().unwrap_or(given).solid();
    Ok(solid::fit(solid, &method.options, &mut timed)?)
}

/// Fills in what is known about the spline, errors of `fitted` and all else of `stored`, which may have been
/// deformed, and returns its mean determinant.
fn measured(
    record: &mut Record,
    case: &Case,
    method: &TrivariateMethod,
    fit: &SolidFit,
    [fitted, stored]: [&TrivariateSpline; 2],
) -> f64 {
    let options = measure::certificate_options(&method.options);
    let (certificate, folds, warnings) = measure::folds(stored, &options);
    record.checks = measure::fit(fit, fitted);
    record.checks.extend(folds);
    record
        .checks
        .extend(measure::elements(stored, &method.validate_at));
    let filler = match (&case.input, method.filler) {
        (Input::Solid(_), _) => None,
        (_, filler) => Some(filler),
    };
    record.check("filler", json!(filler));
    record.warnings = warnings;
    certificate.volume
}

/// Tasks, data and options that mean nothing here are refused.
fn check(case: &Case, method: &TrivariateMethod) -> Result<(), RunError> {
    steps::check_plain_fit(case, SPLINE)?;
    if case.refine > 0 {
        let what = "cover or subdivision of its input";
        return Err(RunError::without(SPLINE, what, "leave them out"));
    }
    let number = |option, value: String, range| {
        Err(TrivariateError::Option {
            option,
            value,
            range,
        }
        .into())
    };
    if let Some(cells) = method
        .validate_at
        .iter()
        .find(|n| !(1..=MOST_CELLS).contains(*n))
    {
        return number("--validate-at", cells.to_string(), "numbers from 1 to 200");
    }
    if !(1..=64).contains(&method.cells) {
        return number(
            "--tessellate",
            method.cells.to_string(),
            "a number from 1 to 64",
        );
    }
    if method.cut.axis > 2 {
        return number(
            "the axis of the cut",
            method.cut.axis.to_string(),
            "0, 1 or 2",
        );
    }
    check_levels(&method.options.fitting)?;
    write::check(&case.outputs)
}

/// Levels are refused here already, before the solid has been mapped.
fn check_levels(fitting: &Fitting) -> Result<(), RunError> {
    let (coarsest, finest, most) = match fitting {
        Fitting::Multilevel(options) => (options.coarsest, options.finest, MOST_SPANS),
        Fitting::LeastSquares(options) => {
            (options.coarsest, options.finest, least_squares::MOST_SPANS)
        }
        Fitting::Certified(options) => {
            let options = &options.least_squares;
            (options.coarsest, options.finest, least_squares::MOST_SPANS)
        }
    };
    let doubled =
        coarsest > 0 && finest.is_multiple_of(coarsest) && (finest / coarsest).is_power_of_two();
    let error = if !doubled {
        FitError::Levels { coarsest, finest }
    } else if finest > most {
        let spans = finest;
        FitError::TooFine { spans, most }
    } else {
        return Ok(());
    };
    Err(SolidError::from(error).into())
}

/// Squares along an edge of the cube, for so many along the side of a span.
fn squares(spline: &TrivariateSpline, cells: usize) -> usize {
    let spans = spline.spans();
    let most = (MOST_SQUARES / spans).max(1);
    spans * cells.min(most)
}

fn options(case: &Case, method: &TrivariateMethod) -> Value {
    let mut options = json!(method.options);
    options["map"] = json!(method.map);
    options["filler"] = json!(method.filler);
    options["validate_at"] = json!(method.validate_at);
    options["cells"] = json!(method.cells);
    options["moves"] = json!(method.moves);
    steps::options(case, options)
}

fn record(seed: u64, facts: &InputFacts, spline: &SplineFile, stored: &TrivariateSpline) -> Record {
    Record {
        dofs: 3 * stored.points().len() as u64,
        ..steps::record(spline, facts, seed)
    }
}
