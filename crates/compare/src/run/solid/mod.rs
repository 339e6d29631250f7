//! Runs of trivariate splines: from a solid over the cube to its spline, and what is known about it.

mod boundary;
mod cylinder;
mod deform;
mod evaluate;
mod measure;
mod pictures;
mod tetgen;
mod write;

use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::Observer;
use msplines_trivariate::domain::mesher::Crossings;
use msplines_trivariate::fit::least_squares;
use msplines_trivariate::options::Fitting;
use msplines_trivariate::solid::{self, SolidFit};
use msplines_trivariate::spline::MOST_SPANS;
use msplines_trivariate::{FitError, TrivariateSpline};
use serde_json::{Value, json};

use super::{RunOutput, enter};
use crate::case::{Case, Data, Filler, Input, Method, SolidMap, Task, TrivariateMethod};
use crate::clock::{PhaseClock, process_usage};
use crate::error::{RunError, TrivariateError};
use crate::fit::following;
use crate::input::solid::{Given, load_solid};
use crate::measure::to_reference;
use crate::record::{InputFacts, Record};
use crate::spline_file::{SplineFile, StoredCube, StoredDomain, StoredSpline, StoredTrivariate};
use boundary::CubeSurface;
use write::Written;

pub(super) use evaluate::evaluate;

/// Most cells in each direction of a sampling.
const MOST_CELLS: usize = 200;
/// Most squares along an edge of the cube.
const MOST_SQUARES: usize = 1024;

/// Runs a case whose method is a trivariate spline; nothing for another one.
pub(super) fn asked(
    case: &Case,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Option<Result<RunOutput, RunError>> {
    match &case.method {
        Method::Trivariate(method) => Some(run(case, method, clock, observer)),
        _ => None,
    }
}

fn run(
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
    (record.error, record.error_unit_cube) = measure::vertex_errors(fitted, &parameters, &surface);
    distances(&mut record, case, &stored, (&surface, &mesh))?;
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
    clock.leave();
    record.warnings.splice(0..0, input.warnings);
    finish(&mut record, &mesh, clock);
    Ok(output(record, spline, mesh, fields, companions))
}

/// Returns the method with crossings of the surface mended, where the case mends its input.
fn mended(case: &Case, method: &TrivariateMethod) -> TrivariateMethod {
    let mut method = method.clone();
    if matches!(case.input, Input::File { repair: true, .. }) {
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
    let fit = solid::fit(solid, &method.options, &mut timed);
    Ok(fit.map_err(TrivariateError::from)?)
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
    record.checks.insert("filler".to_owned(), json!(filler));
    record.warnings = warnings;
    certificate.volume
}

/// Fills in the distances between surfaces that are asked for.
fn distances(
    record: &mut Record,
    case: &Case,
    stored: &TrivariateSpline,
    (surface, mesh): (&TriangleMesh, &TriangleMesh),
) -> Result<(), RunError> {
    if case.measure_distance {
        let found = measure::surface_distance(stored, surface, case.seed)?;
        record.distance = Some(found);
    }
    if let Some(path) = &case.reference {
        let values = coordinates(mesh);
        let found = to_reference(path, surface, mesh, &values, case.seed)?;
        record.checks.extend(found);
    }
    Ok(())
}

/// Tasks, data and options that mean nothing here are refused.
fn check(case: &Case, method: &TrivariateMethod) -> Result<(), RunError> {
    let refused = |what, remedy| Err(TrivariateError::SurfaceOnly { what, remedy }.into());
    if case.task != Task::Fit {
        return refused("task beyond a fit", "leave it out");
    }
    if case.data != Data::Positions {
        return refused("data other than positions", "leave them out");
    }
    if case.double_cover || case.refine > 0 || case.subdivide > 0 {
        return refused("cover or subdivision of its input", "leave them out");
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
    Err(TrivariateError::Solid(error.into()).into())
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
    options["data"] = json!(case.data);
    options["seed"] = json!(case.seed);
    options["repair"] = json!(matches!(case.input, Input::File { repair: true, .. }));
    options
}

fn record(seed: u64, facts: &InputFacts, spline: &SplineFile, stored: &TrivariateSpline) -> Record {
    let options = spline.options.clone();
    Record {
        dofs: 3 * stored.points().len() as u64,
        ..Record::start(spline.spline.method(), facts.clone(), options, seed)
    }
}

/// Fills in what is known at the end.
fn finish(record: &mut Record, mesh: &TriangleMesh, clock: &mut PhaseClock) {
    let points = json!(mesh.vertex_count());
    record.checks.insert("evaluated_points".to_owned(), points);
    record.seconds = clock.read();
    record.peak_rss_bytes = process_usage().peak_rss_bytes;
}

fn coordinates(mesh: &TriangleMesh) -> Vec<f64> {
    mesh.positions()
        .iter()
        .flat_map(|p| [p.x, p.y, p.z])
        .collect()
}

fn output(
    record: Record,
    spline: SplineFile,
    mesh: TriangleMesh,
    fields: Vec<msplines_common::mesh::VertexAttribute>,
    companions: Vec<super::Companion>,
) -> RunOutput {
    RunOutput {
        record,
        spline: Some(spline),
        values: coordinates(&mesh),
        mesh,
        names: ["x", "y", "z"].map(str::to_owned).to_vec(),
        fields,
        knots: Vec::new(),
        frames: Vec::new(),
        companions,
        texture: None,
    }
}
