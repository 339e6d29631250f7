//! One run: read, fit, evaluate what is stored, measure it, write it, and record it all.

mod conformal;
mod edits;
mod evaluation;
mod frames;
mod layers;
mod manifold;
mod powell_sabin;
mod properties;
mod shared_space;
mod solid;
mod steps;
mod sums;
mod t_spline;

use std::time::Instant;

use msplines_common::Point3;
use msplines_common::mesh::{TriangleMesh, VertexAttribute};
use msplines_common::progress::{Observer, Outcome, Progress};
use serde_json::{Value, json};

use crate::case::{Case, Data, DomainStorage, Input, Method, Task};
use crate::clock::PhaseClock;
use crate::error::RunError;
use crate::fit::{Fitted, fit};
use crate::input::{FitData, LoadedInput, fit_data, load};
use crate::measure::{self, Measured};
use crate::output::{check_outputs, coordinate_names, coordinates, write_outputs};
use crate::record::{Checks, Record};
use crate::spline_file::{LARGEST, SplineFile, StoredDomain, StoredMesh};

pub(crate) use conformal::CHECKERS;
pub use edits::Shift;
pub use evaluation::{Evaluation, evaluate};
pub use frames::ShownFrame;
pub use manifold::Companion;
pub(crate) use manifold::creases_file;
pub use powell_sabin::{Change, ChangeKind};
pub use t_spline::TSplineChanges;
pub(crate) use t_spline::pictures as t_spline_pictures;

/// What a run gives.
#[derive(Clone, Debug)]
pub struct RunOutput {
    /// The record, complete but for files that the caller writes.
    pub record: Record,
    /// The spline in its stored form; none of an atlas.
    pub spline: Option<SplineFile>,
    /// The mesh at whose vertices the spline was evaluated.
    pub mesh: TriangleMesh,
    /// Values of the spline there, `[vertex][component]`, as evaluated from the stored form.
    pub values: Vec<f64>,
    /// Names of the components, `x, y, z` for positions.
    pub names: Vec<String>,
    /// Further numbers at the vertices of the mesh, for pictures.
    pub fields: Vec<VertexAttribute>,
    /// Places of the knots or control vertices on the domain, or of the zeros of an atlas.
    pub knots: Vec<Point3<f64>>,
    /// Frames of an animation that pictures show; the spline and its values are those of the last.
    pub frames: Vec<ShownFrame>,
    /// Further surfaces that pictures show.
    pub companions: Vec<Companion>,
    /// Texture coordinates of the corners of every face of the mesh, where the result is an atlas.
    pub texture: Option<Vec<[[f64; 2]; 3]>>,
}

impl RunOutput {
    /// Returns what a run gives, with nothing beside its values.
    fn new(
        record: Record,
        spline: Option<SplineFile>,
        mesh: TriangleMesh,
        values: Vec<f64>,
        names: Vec<String>,
    ) -> Self {
        Self {
            record,
            spline,
            mesh,
            values,
            names,
            fields: Vec::new(),
            knots: Vec::new(),
            frames: Vec::new(),
            companions: Vec::new(),
            texture: None,
        }
    }

    /// Returns what a run gives whose result is the mesh itself.
    fn of_surface(record: Record, spline: Option<SplineFile>, mesh: TriangleMesh) -> Self {
        let values = coordinates(mesh.positions());
        Self::new(record, spline, mesh, values, coordinate_names())
    }
}

/// Runs a case and writes its outputs.
///
/// The errors in the record are those of the spline in its stored form, evaluated again. A run
/// that `observer` breaks off ends with the best spline so far and says so in its outcome.
///
/// # Errors
/// Input that is refused, a method that cannot take it, or an output that cannot be written.
pub fn run(
    case: &Case,
    process_start: Instant,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    let mut clock = PhaseClock::start(process_start);
    announce("read", observer);
    if let Some(output) = asked(case, &mut clock, observer) {
        return output;
    }
    check_outputs(&case.outputs)?;
    let input = prepared(load(&case.input, &mut clock)?, case)?;
    if let Some(over_time) = frames::asked(case, &input)? {
        return frames::run(case, &over_time, &input, &mut clock, observer);
    }
    let data = fit_data(&case.data, &input)?;
    enter("domain", &mut clock, observer);
    let produced = produce(case, &input, &data, &mut clock, observer)?;
    check_finite(&produced.values, data.dimension)?;
    enter("measure", &mut clock, observer);
    let mut measured = measure::against_data(&input, &data, &produced.compared, &case.data);
    if case.measure_distance && case.data == Data::Positions {
        let found = measure::surface_distance(&produced.fitted.stored, &input.mesh, case.seed)?;
        measured.distance = Some(found);
    }
    let fitted = produced.fitted;
    let mut checks = fitted.checks;
    let (mesh, values) = (produced.mesh, produced.values);
    if let Some(path) = &case.reference {
        let found = measure::to_reference(path, &input.mesh, &mesh, &values, case.seed)?;
        checks.extend(found);
    }
    let options = options(case, &fitted.options);
    let spline = SplineFile::new(domain(case, &input), options, fitted.stored);
    enter("write", &mut clock, observer);
    write_outputs(
        &case.outputs,
        &spline,
        &mesh,
        &values,
        &data.names,
        &produced.fields,
    )?;
    checks.insert("evaluated_points".to_owned(), json!(mesh.vertex_count()));
    let summary = Summary {
        checks,
        outcome: fitted.outcome,
        measured,
        seed: case.seed,
    };
    let mut record = record(&input, &spline, summary, &mut clock);
    record.warnings.extend(fitted.warnings);
    let knots = spline.spline.knot_places(&input.mesh);
    Ok(RunOutput {
        knots,
        fields: produced.fields,
        ..RunOutput::new(record, Some(spline), mesh, values, data.names)
    })
}

/// Runs a case whose method has a run of its own.
fn asked(
    case: &Case,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Option<Result<RunOutput, RunError>> {
    Some(match &case.method {
        Method::Biharmonic(_) | Method::LsMesh { .. } => return None,
        Method::SparseManifold(method) => manifold::run(case, method, clock, observer),
        Method::CurveNetwork(method) => manifold::network::run(case, method, clock, observer),
        Method::Chart(method) => manifold::chart::run(case, method, clock, observer),
        Method::Trivariate(method) => solid::run(case, method, clock, observer),
        Method::Conformal(method) => conformal::run(case, method, clock, observer),
        Method::PowellSabin(method) => powell_sabin::run(case, method, clock, observer),
        Method::TSpline(method) => t_spline::run(case, method, clock, observer),
    })
}

/// Does what the task of a case is.
fn produce(
    case: &Case,
    input: &LoadedInput,
    data: &FitData,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<Produced, RunError> {
    match &case.task {
        Task::Fit => fitted(case, input, data, clock, observer),
        Task::Decompose { layers, factors } => {
            let asked = (layers.as_slice(), factors.as_slice());
            layers::decompose(case, input, data, asked, clock, observer)
        }
        Task::Edit(edit) => edits::edit(case, input, data, edit, clock, observer),
        Task::Properties => properties::measure(case, input, data, clock, observer),
        Task::Frames(_) => unreachable!("frames have a run of their own"),
    }
}

/// Returns the input as the case wants it: refined, or its double cover.
fn prepared(mut input: LoadedInput, case: &Case) -> Result<LoadedInput, RunError> {
    if case.refine > 0 {
        input = input.refined(case.refine);
    }
    if case.double_cover {
        input = input.double_cover()?;
    }
    Ok(input)
}

/// What a task gives, before it is measured and written.
pub(crate) struct Produced {
    /// The spline and how it came about.
    fitted: Fitted,
    /// Where the result is evaluated.
    mesh: TriangleMesh,
    /// The result there.
    values: Vec<f64>,
    /// What is compared with the data, at the vertices of the input and perhaps beyond.
    compared: Vec<f64>,
    /// Further numbers at the vertices of `mesh`, for pictures.
    fields: Vec<VertexAttribute>,
}

/// Fits and evaluates what is stored.
fn fitted(
    case: &Case,
    input: &LoadedInput,
    data: &FitData,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<Produced, RunError> {
    let fitted = fit(case, input, data, clock, observer)?;
    enter("evaluate", clock, observer);
    let (mesh, values) = fitted.stored.evaluate_in(
        fitted.space.as_ref(),
        case.scheme,
        &input.mesh,
        case.subdivide,
    )?;
    Ok(Produced {
        fitted,
        mesh,
        compared: values.clone(),
        values,
        fields: Vec::new(),
    })
}

/// What a record says beyond its input, spline and times.
struct Summary {
    outcome: Outcome,
    checks: Checks,
    measured: Measured,
    seed: u64,
}

/// Returns the options of a spline over triangles together with those of the run.
fn options(case: &Case, method: &Value) -> Value {
    let mut options = steps::options(case, method.clone());
    options["subdivide"] = json!(case.subdivide);
    options["refine"] = json!(case.refine);
    options["double_cover"] = json!(case.double_cover);
    options
}

fn domain(case: &Case, input: &LoadedInput) -> StoredDomain {
    // The digest of a file does not tell what has been made of its mesh.
    let as_read = case.refine == 0 && !case.double_cover;
    match (&case.input, case.domain) {
        (Input::File { repair, .. }, DomainStorage::Digest) if as_read => StoredDomain::Digest {
            sha256: input.facts.sha256.clone(),
            repair: *repair,
        },
        _ => StoredDomain::Embedded {
            mesh: StoredMesh::of(&input.mesh),
        },
    }
}

/// Returns the record of a run whose outputs are written.
fn record(
    input: &LoadedInput,
    spline: &SplineFile,
    summary: Summary,
    clock: &mut PhaseClock,
) -> Record {
    let stored = &spline.spline;
    let mut record = Record {
        outcome: summary.outcome,
        dofs: (stored.knots().len() * stored.dimension()) as u64,
        domain_bytes: steps::triangle_bytes(&input.mesh),
        error: summary.measured.error,
        error_unit_cube: summary.measured.unit_cube,
        distance: summary.measured.distance,
        checks: summary.checks,
        warnings: input.warnings.clone(),
        ..steps::record(spline, &input.facts, summary.seed)
    };
    steps::finish(&mut record, clock);
    record
}

fn check_finite(values: &[f64], dimension: usize) -> Result<(), RunError> {
    match values.iter().position(|x| x.is_nan() || x.abs() > LARGEST) {
        Some(index) => Err(RunError::NotFinite {
            vertex: index / dimension,
        }),
        None => Ok(()),
    }
}

fn enter(phase: &'static str, clock: &mut PhaseClock, observer: &mut Observer<'_>) {
    clock.enter(phase);
    announce(phase, observer);
}

/// Tells the observer of a phase that cannot be broken off.
fn announce(phase: &'static str, observer: &mut Observer<'_>) {
    let _ = observer(&Progress::new(phase, 0, 0));
}
