//! Runs of T-splines: from a surface to cylinders, and to one spline over them that approximates it.

mod edits;
mod evaluate;
mod measure;
mod poles;
mod write;

use std::sync::Arc;

use msplines_common::Point3;
use msplines_common::mesh::TriangleMesh;
use msplines_common::metrics::{unit_cube_error, vertex_error};
use msplines_common::progress::Observer;
use msplines_t_spline::domain::DomainOptions;
use msplines_t_spline::fit::Fit;
use msplines_t_spline::{Domain, FitOptions, Sample, Stop, TSplineSurface};
use serde_json::{Value, json};

use super::{RunOutput, enter, prepared};
use crate::case::{Case, Data, Form, Input, Method, TSplineMethod, Task};
use crate::clock::{PhaseClock, process_usage};
use crate::error::{RunError, TSplineError};
use crate::fit::following;
use crate::input::{LoadedInput, load};
use crate::measure::to_reference;
use crate::record::Record;
use crate::spline_file::{SplineFile, StoredSpline, StoredTSpline};
use poles::Poles;
use write::{AtVertices, Written};

pub use edits::TSplineChanges;
pub(super) use evaluate::evaluate;

/// Most segments along a side of a face.
const MOST_SEGMENTS: u32 = 64;

/// Runs a case whose method is a T-spline; nothing for another one.
pub(super) fn asked(
    case: &Case,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Option<Result<RunOutput, RunError>> {
    match &case.method {
        Method::TSpline(method) => Some(run(case, method, clock, observer)),
        _ => None,
    }
}

fn run(
    case: &Case,
    method: &TSplineMethod,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    check(case, method)?;
    let input = prepared(load(&case.input, clock)?, case)?;
    enter("domain", clock, observer);
    let poles = Poles::of(&input.mesh, &method.puncture)?;
    let domain = domain(case, method, &input, &poles.vertices, clock, observer)?;
    enter("fit", clock, observer);
    let fit = fitted(&domain, method, &input, clock, observer)?;
    let report = fit.report;
    let vertices = domain.mesh().vertex_count();
    let shifts = fit.samples[..vertices].iter().map(|s| s.shift).collect();
    let surface = TSplineSurface::new(domain, shifts, fit.spline);
    let stored = StoredTSpline::of(&surface, &method.fit.caps, &fit.levels, &input.mesh);
    let levels = stored.level_count();
    let file = SplineFile::new(
        super::domain(case, &input),
        options(case, method, &poles.vertices),
        StoredSpline::TSpline(Box::new(stored)),
    );
    enter("evaluate", clock, observer);
    // What is measured and written is what is stored.
    let surface = file.spline.t_spline(&input.mesh)?;
    let at_vertices = AtVertices::of(&surface, &input.mesh);
    enter("measure", clock, observer);
    let mut record = record_of(&input, &file, &surface, case.seed);
    errors(&mut record, &input, &at_vertices);
    record.outcome = report.outcome;
    record.warnings.extend(input.warnings.iter().cloned());
    record.warnings.extend(poles.warning);
    record.checks.extend(measure::surface(&surface, case.seed));
    record
        .checks
        .insert("rounds".to_owned(), json!(report.rounds));
    record.checks.insert("levels".to_owned(), json!(levels));
    distances(&mut record, case, &input, &surface, &at_vertices)?;
    enter("write", clock, observer);
    let written = Written {
        file: &file,
        surface: &surface,
        segments: method.tessellate,
        at_vertices: &at_vertices.mesh,
    };
    write::write(&case.outputs, &written)?;
    let marks = marks(&surface, &at_vertices);
    Ok(output(record, file, at_vertices, marks, clock))
}

/// Cuts the input into cylinders.
fn domain(
    case: &Case,
    method: &TSplineMethod,
    input: &LoadedInput,
    poles: &[u32],
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<Domain, RunError> {
    let form = method.form.clone().unwrap_or(Form::Integer);
    let options = DomainOptions {
        form: form.choice(case.seed),
        poles: poles.to_vec(),
        pole_form: msplines_conformal::poles::PoleChoice::Optimal { seed: case.seed },
        snap: method.snap,
    };
    let mut timed = following(&["domain"], clock, observer);
    let domain = Domain::of_surface(&input.mesh, &options, &mut timed);
    Ok(domain.map_err(TSplineError::from)?)
}

/// Fits a surface to the vertices of the domain and to the poles.
fn fitted(
    domain: &Domain,
    method: &TSplineMethod,
    input: &LoadedInput,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<Fit, RunError> {
    let [low, high] = input.mesh.bounding_box();
    let options = FitOptions {
        stop: match method.fit.stop {
            Stop::Tolerance(share) => Stop::Tolerance(share * (high - low).max()),
            other @ Stop::ControlPoints(_) => other,
        },
        ..method.fit
    };
    let mut samples = TSplineSurface::samples(domain);
    samples.extend(domain.poles().iter().map(|pole| Sample {
        movable: false,
        ..Sample::vertex(pole.at, input.mesh.positions()[pole.vertex as usize])
    }));
    let complex = Arc::new(domain.complex().clone());
    let mut timed = following(&["fit"], clock, observer);
    let fit = msplines_t_spline::fit(&complex, &samples, &options, &mut timed);
    Ok(fit.map_err(TSplineError::from)?)
}

/// Tasks, data and options that mean nothing here are refused, and outputs before any work.
fn check(case: &Case, method: &TSplineMethod) -> Result<(), RunError> {
    let refused = |what, remedy| Err(TSplineError::FitOnly { what, remedy }.into());
    if case.task != Task::Fit {
        return refused("task beyond a fit", "leave it out");
    }
    if case.data != Data::Positions {
        return refused("data other than positions", "leave them out");
    }
    if case.double_cover || case.subdivide > 0 {
        return refused("cover or subdivision of its input", "leave them out");
    }
    if let Stop::Tolerance(given) = method.fit.stop
        && !(given > 0.0 && given.is_finite())
    {
        return Err(TSplineError::Tolerance { given }.into());
    }
    write::check(&case.outputs, method.tessellate)
}

fn options(case: &Case, method: &TSplineMethod, poles: &[u32]) -> Value {
    let mut options = json!(method);
    options["form"] = json!(method.form.clone().unwrap_or(Form::Integer));
    options["puncture"] = json!(poles);
    options["data"] = json!(case.data);
    options["seed"] = json!(case.seed);
    options["refine"] = json!(case.refine);
    options["repair"] = json!(matches!(case.input, Input::File { repair: true, .. }));
    options
}

/// Returns what a record says of a surface alone.
fn record_of(
    input: &LoadedInput,
    file: &SplineFile,
    surface: &TSplineSurface,
    seed: u64,
) -> Record {
    let mesh = surface.domain().mesh();
    let vectors = 48 * mesh.face_count() + 16 * mesh.vertex_count();
    let options = file.options.clone();
    Record {
        dofs: 3 * surface.spline().space().unknowns() as u64,
        domain_bytes: (24 * mesh.vertex_count() + 12 * mesh.face_count() + vectors) as u64,
        ..Record::start(file.spline.method(), input.facts.clone(), options, seed)
    }
}

/// Fills in the errors at the vertices of the input.
fn errors(record: &mut Record, input: &LoadedInput, at_vertices: &AtVertices) {
    let pick = |mesh: &TriangleMesh| -> Vec<f64> {
        let points = at_vertices
            .known
            .iter()
            .map(|&v| mesh.positions()[v as usize]);
        points.flat_map(|p| [p.x, p.y, p.z]).collect()
    };
    let (fitted, data) = (pick(&at_vertices.mesh), pick(&input.mesh));
    let [low, high] = input.mesh.bounding_box();
    record.error = vertex_error(&fitted, &data, 3, input.mesh.diagonal()).ok();
    record.error_unit_cube = unit_cube_error(&fitted, &data, (high - low).max()).ok();
    if let Some(error) = record.error_unit_cube {
        let checks = &mut record.checks;
        checks.insert("rms_unit_cube".to_owned(), json!(error.rms));
        checks.insert("max_unit_cube".to_owned(), json!(error.max));
        checks.insert("error_unit_cube".to_owned(), json!(error.max));
    }
    let unmeasured = input.mesh.vertex_count() - at_vertices.known.len();
    let checks = &mut record.checks;
    checks.insert("unmeasured_vertices".to_owned(), json!(unmeasured));
}

/// Fills in the distances between surfaces that are asked for.
fn distances(
    record: &mut Record,
    case: &Case,
    input: &LoadedInput,
    surface: &TSplineSurface,
    at_vertices: &AtVertices,
) -> Result<(), RunError> {
    if case.measure_distance {
        let found = measure::distance_to(surface, &input.mesh, case.seed)?;
        let checks = &mut record.checks;
        checks.insert("hausdorff".to_owned(), json!(found.max));
        record.distance = Some(found);
    }
    if let Some(path) = &case.reference {
        let mesh = &at_vertices.mesh;
        let values = coordinates(mesh);
        let measured = to_reference(path, &input.mesh, mesh, &values, case.seed)?;
        record.checks.extend(measured);
    }
    Ok(())
}

/// The zeros and poles on the surface.
fn marks(surface: &TSplineSurface, at_vertices: &AtVertices) -> Vec<Point3<f64>> {
    let domain = surface.domain();
    let zeros = domain.zeros().iter();
    let zeros = zeros.filter_map(|zero| domain.origins()[zero.vertex as usize]);
    let poles = domain.poles().into_iter().map(|pole| pole.vertex);
    let position = |v: u32| at_vertices.mesh.positions()[v as usize];
    zeros.chain(poles).map(position).collect()
}

/// Fills in what is known at the end.
fn output(
    mut record: Record,
    file: SplineFile,
    at_vertices: AtVertices,
    marks: Vec<Point3<f64>>,
    clock: &mut PhaseClock,
) -> RunOutput {
    clock.leave();
    let mesh = at_vertices.mesh;
    let points = json!(mesh.vertex_count());
    record.checks.insert("evaluated_points".to_owned(), points);
    record.seconds = clock.read();
    record.peak_rss_bytes = process_usage().peak_rss_bytes;
    RunOutput {
        record,
        spline: Some(file),
        values: coordinates(&mesh),
        mesh,
        names: ["x", "y", "z"].map(str::to_owned).to_vec(),
        fields: Vec::new(),
        knots: marks,
        frames: Vec::new(),
        companions: Vec::new(),
        texture: None,
    }
}

/// The surface as triangles.
fn tessellation(surface: &TSplineSurface, segments: u32) -> Result<TriangleMesh, RunError> {
    let found = surface.tessellate(segments).map_err(TSplineError::from)?;
    let mesh = TriangleMesh::build(found.positions, found.faces);
    Ok(mesh.map_err(TSplineError::from)?)
}

fn coordinates(mesh: &TriangleMesh) -> Vec<f64> {
    mesh.positions()
        .iter()
        .flat_map(|p| [p.x, p.y, p.z])
        .collect()
}
