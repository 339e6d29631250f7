//! Runs of T-splines: from a surface to cylinders, and to one spline over them that approximates it.

mod edits;
mod evaluate;
mod measure;
mod net;
pub(crate) mod pictures;
mod poles;
mod tiles;
mod write;

use msplines_common::Point3;
use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::Observer;
use msplines_t_spline::domain::DomainOptions;
use msplines_t_spline::fit::FittedSurface;
use msplines_t_spline::{Domain, FitOptions, Stop, TSplineSurface};
use serde_json::{Value, json};

use super::{RunOutput, enter, prepared, steps};
use crate::case::{Case, Form, TSplineMethod};
use crate::clock::PhaseClock;
use crate::error::{RunError, TSplineError};
use crate::fit::following;
use crate::input::{LoadedInput, load};
use crate::record::Record;
use crate::spline_file::{SplineFile, StoredSpline, StoredTSpline};
use poles::{Poles, Wanted};
use write::{AtVertices, Written};

pub use edits::TSplineChanges;
pub(super) use evaluate::evaluate;

/// What refusals call these splines.
const SPLINE: &str = "a T-spline";

/// Runs a case whose method is a T-spline.
pub(super) fn run(
    case: &Case,
    method: &TSplineMethod,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    check(case, method)?;
    let input = prepared(load(&case.input, clock)?, case)?;
    enter("domain", clock, observer);
    let wanted = {
        let mut timed = following(&["domain"], clock, observer);
        Wanted::of(&input.mesh, &method.puncture, &mut timed)?
    };
    let domain = domain(case, method, &input, &wanted.vertices, clock, observer)?;
    let poles = Poles::of(&domain, &wanted);
    enter("fit", clock, observer);
    let fit = fitted(domain, method, &input, clock, observer)?;
    let stored = StoredTSpline::of(&fit.surface, &method.fit.caps, &fit.levels, &input.mesh);
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
    record.outcome = fit.report.outcome;
    record.warnings.extend(input.warnings.iter().cloned());
    record.warnings.extend(poles.warnings);
    record.checks.extend(measure::surface(&surface, case.seed));
    record
        .checks
        .extend(measure::boundary(&input.mesh, &at_vertices));
    record.check("rounds", fit.report.rounds);
    record.check("levels", levels);
    let meshes = [&input.mesh, &at_vertices.mesh];
    steps::distances(&mut record, case, meshes, || {
        measure::distance_to(&surface, &input.mesh, case.seed)
    })?;
    if let Some(distance) = record.distance {
        record.check("hausdorff", distance.max);
    }
    enter("write", clock, observer);
    let written = Written {
        file: &file,
        surface: &surface,
        segments: method.tessellate,
        at_vertices: &at_vertices.mesh,
    };
    write::write(&case.outputs, &written)?;
    let marks = marks(&surface, &at_vertices);
    let mut output = output(record, file, at_vertices, marks, clock);
    if method.pictures {
        pictures::add(&mut output, &surface, &fit.levels, &input.mesh);
    }
    Ok(output)
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
        pole_form: msplines_conformal::poles::PoleChoice::optimal(case.seed),
        snap: method.snap,
    };
    let mut timed = following(&["domain"], clock, observer);
    let domain = Domain::of_surface(&input.mesh, &options, &mut timed);
    Ok(domain?)
}

/// Fits a surface; a tolerance is a share of the longest side of the bounding box.
fn fitted(
    domain: Domain,
    method: &TSplineMethod,
    input: &LoadedInput,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<FittedSurface, RunError> {
    let [low, high] = input.mesh.bounding_box();
    let options = FitOptions {
        stop: match method.fit.stop {
            Stop::Tolerance(share) => Stop::Tolerance(share * (high - low).max()),
            other @ Stop::ControlPoints(_) => other,
        },
        ..method.fit
    };
    let mut timed = following(&["fit"], clock, observer);
    let sampling = &method.face_samples;
    let found = TSplineSurface::fit(domain, &input.mesh, sampling, &options, &mut timed);
    Ok(found?)
}

/// Tasks, data and options that mean nothing here are refused, and outputs before any work.
fn check(case: &Case, method: &TSplineMethod) -> Result<(), RunError> {
    steps::check_plain_fit(case, SPLINE)?;
    if let Stop::Tolerance(given) = method.fit.stop
        && !(given > 0.0 && given.is_finite())
    {
        return Err(TSplineError::Tolerance { given }.into());
    }
    method.face_samples.check().map_err(TSplineError::from)?;
    write::check(&case.outputs, method.tessellate)
}

fn options(case: &Case, method: &TSplineMethod, poles: &[u32]) -> Value {
    let mut options = json!(method);
    options["form"] = json!(method.form.clone().unwrap_or(Form::Integer));
    options["puncture"] = json!(poles);
    options["refine"] = json!(case.refine);
    steps::options(case, options)
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
    Record {
        dofs: 3 * surface.spline().space().unknowns() as u64,
        domain_bytes: steps::triangle_bytes(mesh) + vectors as u64,
        ..steps::record(file, &input.facts, seed)
    }
}

/// Fills in the errors at the vertices of the input.
fn errors(record: &mut Record, input: &LoadedInput, at_vertices: &AtVertices) {
    let known = |mesh: &TriangleMesh| -> Vec<Point3<f64>> {
        let vertices = at_vertices.known.iter();
        vertices.map(|&v| mesh.positions()[v as usize]).collect()
    };
    let (fitted, data) = (known(&at_vertices.mesh), known(&input.mesh));
    steps::errors(record, [&fitted, &data], &input.mesh);
    if let Some(error) = record.error_unit_cube {
        record.check("rms_unit_cube", error.rms);
        record.check("max_unit_cube", error.max);
        record.check("error_unit_cube", error.max);
    }
    let unmeasured = input.mesh.vertex_count() - at_vertices.known.len();
    record.check("unmeasured_vertices", unmeasured);
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
    let mesh = at_vertices.mesh;
    record.check("evaluated_points", mesh.vertex_count());
    steps::finish(&mut record, clock);
    RunOutput {
        knots: marks,
        ..RunOutput::of_surface(record, Some(file), mesh)
    }
}

/// The surface as triangles.
fn tessellation(surface: &TSplineSurface, segments: u32) -> Result<TriangleMesh, RunError> {
    let found = surface.tessellate(segments).map_err(TSplineError::from)?;
    let mesh = TriangleMesh::build(found.positions, found.faces);
    Ok(mesh.map_err(TSplineError::from)?)
}
