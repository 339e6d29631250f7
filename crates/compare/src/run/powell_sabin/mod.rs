//! Runs of Powell-Sabin splines: from a surface with normals to one spline through all its vertices.

mod atlas;
mod charts;
mod edits;
mod evaluate;
mod measure;
mod pictures;
mod plane;
mod reach;
mod write;

use std::collections::BTreeMap;

use msplines_common::Point3;
use msplines_common::mesh::TriangleMesh;
use msplines_common::metrics::{unit_cube_error, vertex_error};
use msplines_common::progress::{Observer, Outcome};
use msplines_powell_sabin::{PowellSabinSurface, Tessellation, VertexCondition};
use serde_json::{Value, json};

use super::{RunOutput, enter, prepared};
use crate::case::{Case, Data, Input, Layout, Method, PowellSabinMethod, Task};
use crate::clock::{PhaseClock, process_usage};
use crate::error::{PowellSabinError, RunError};
use crate::input::{LoadedInput, load};
use crate::measure::to_reference;
use crate::record::Record;
use crate::spline_file::{SplineFile, StoredDomain, StoredMesh, StoredSpline};
use write::Written;

pub use edits::{Change, ChangeKind};
pub(super) use evaluate::evaluate;

/// Random points at which jumps and folds are looked for.
const SAMPLES: usize = 20_000;
/// Most segments along a side of a face.
const MOST_SEGMENTS: u32 = 64;
/// Fewest and most segments along a side of a face in pictures.
const SHOWN_SEGMENTS: u32 = 4;
const MOST_SHOWN_SEGMENTS: u32 = 24;
/// Triangles in pictures, about, between those bounds.
const SHOWN_TRIANGLES: f64 = 400_000.0;

/// Runs a case whose method is a Powell-Sabin spline; nothing for another one.
pub(super) fn asked(
    case: &Case,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Option<Result<RunOutput, RunError>> {
    match &case.method {
        Method::PowellSabin(method) => Some(run(case, method, clock, observer)),
        _ => None,
    }
}

/// A surface, and what is known of it before it is measured.
struct Produced {
    surface: PowellSabinSurface,
    /// What it does at every vertex of its mesh.
    conditions: Vec<VertexCondition>,
    /// The vertex of the input that every vertex of its mesh is; none of those that were added.
    origins: Vec<Option<u32>>,
    /// Places of zeros, or of edits.
    marks: Vec<Point3<f64>>,
    /// Outline of the faces that a basis function lives on.
    molecule: Vec<[u32; 2]>,
    outcome: Outcome,
    checks: BTreeMap<String, Value>,
    warnings: Vec<String>,
}

fn run(
    case: &Case,
    method: &PowellSabinMethod,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    check(case, method)?;
    let input = prepared(load(&case.input, clock)?, case)?;
    enter("domain", clock, observer);
    let mut produced = match (method.layout, &method.basis) {
        (Layout::Atlas, _) => atlas::fitted(&input, case, method, clock, observer)?,
        (Layout::Plane, Some(function)) => plane::basis_function(&input, function)?,
        (Layout::Plane, None) => plane::fitted(&input, method, clock, observer)?,
    };
    if !method.edits.is_empty() {
        edits::apply(&mut produced, &method.edits)?;
    }
    let surface = &produced.surface;
    let spline = SplineFile::new(
        StoredDomain::Embedded {
            mesh: StoredMesh::of(surface.mesh()),
        },
        options(case, method),
        StoredSpline::PowellSabin(Box::new(surface.parts())),
    );
    enter("evaluate", clock, observer);
    // What is measured and written is what is stored.
    let stored = spline.spline.powell_sabin(surface.mesh())?;
    let shown = stored.tessellate(method.tessellate.unwrap_or(segments(&stored)));
    enter("measure", clock, observer);
    let mut record = record_of(&input, &spline, &stored, case.seed);
    fill_in(&mut record, &input, &stored, &mut produced);
    let at_vertices = write::at_input_vertices(&stored, &produced.origins, &input.mesh);
    if method.basis.is_none() {
        errors(&mut record, &input, &at_vertices, &produced.origins);
    }
    distances(&mut record, case, &input, (&stored, &triangles(&shown)))?;
    enter("write", clock, observer);
    let written = Written {
        file: &spline,
        spline: &stored,
        segments: method.tessellate,
        at_vertices: &at_vertices,
    };
    write::write(&case.outputs, &written)?;
    let charts = method
        .charts
        .map(|at| charts::Charts::around(&stored, &shown, at));
    if let Some(charts) = &charts {
        record.checks.extend(charts.checks());
    }
    let mut output = output(record, spline, &shown, &at_vertices, &stored, clock);
    output.knots = produced.marks;
    pictures::add_molecule(&mut output.companions, produced.molecule);
    if method.layout == Layout::Plane {
        output.companions.push(pictures::refinement(&stored));
    }
    if let Some(charts) = charts {
        charts.show(&mut output);
    }
    Ok(output)
}

/// Fills in what is known of a surface before and after it is measured.
fn fill_in(
    record: &mut Record,
    input: &LoadedInput,
    stored: &PowellSabinSurface,
    produced: &mut Produced,
) {
    record.outcome = produced.outcome;
    record.checks.append(&mut produced.checks);
    record.warnings.clone_from(&input.warnings);
    record.warnings.append(&mut produced.warnings);
    let checks = stored.measure(&produced.conditions, record.seed, SAMPLES);
    record.checks.extend(measure::surface(&checks));
    if let Some(angle) = measure::rim_angle(stored) {
        record.checks.insert("rim_angle".to_owned(), json!(angle));
    }
}

/// Fills in what is known at the end.
fn output(
    mut record: Record,
    file: SplineFile,
    shown: &Tessellation,
    at_vertices: &TriangleMesh,
    spline: &PowellSabinSurface,
    clock: &mut PhaseClock,
) -> RunOutput {
    clock.leave();
    let points = json!(at_vertices.vertex_count());
    record.checks.insert("evaluated_points".to_owned(), points);
    record.seconds = clock.read();
    record.peak_rss_bytes = process_usage().peak_rss_bytes;
    let fields = pictures::normals(&shown.normals);
    let companions = pictures::companions(spline, shown);
    let mesh = triangles(shown);
    RunOutput {
        record,
        spline: Some(file),
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

/// Fills in the distances between surfaces that are asked for.
fn distances(
    record: &mut Record,
    case: &Case,
    input: &LoadedInput,
    (stored, shown): (&PowellSabinSurface, &TriangleMesh),
) -> Result<(), RunError> {
    if case.measure_distance {
        record.distance = Some(measure::distance_to(stored, &input.mesh, case.seed)?);
    }
    if let Some(path) = &case.reference {
        let values = coordinates(shown);
        let measured = to_reference(path, &input.mesh, shown, &values, case.seed)?;
        record.checks.extend(measured);
    }
    Ok(())
}

/// Tasks, data and options that mean nothing here are refused, and outputs before any work.
fn check(case: &Case, method: &PowellSabinMethod) -> Result<(), RunError> {
    let refused = |what, remedy| Err(PowellSabinError::FitOnly { what, remedy }.into());
    if case.task != Task::Fit {
        return refused("task beyond a fit", "leave it out");
    }
    if case.data != Data::Positions {
        return refused("data other than positions", "leave them out");
    }
    if case.double_cover || case.subdivide > 0 {
        return refused("cover or subdivision of its input", "leave them out");
    }
    if method.basis.is_some() && method.layout != Layout::Plane {
        return refused(
            "single basis function over an atlas",
            "give `layout = \"plane\"` with it",
        );
    }
    if let Some(segments) = method
        .tessellate
        .filter(|n| !(1..=MOST_SEGMENTS).contains(n))
    {
        return Err(PowellSabinError::Segments { segments }.into());
    }
    write::check(&case.outputs)
}

fn options(case: &Case, method: &PowellSabinMethod) -> Value {
    let mut options = json!(method.surface);
    options["form"] = json!(method.form.clone().unwrap_or_default());
    options["puncture"] = json!(method.puncture);
    options["tessellate"] = json!(method.tessellate);
    options["layout"] = json!(method.layout);
    options["basis"] = json!(method.basis);
    options["charts"] = json!(method.charts);
    options["edits"] = json!(method.edits);
    options["data"] = json!(case.data);
    options["seed"] = json!(case.seed);
    options["refine"] = json!(case.refine);
    options["repair"] = json!(matches!(case.input, Input::File { repair: true, .. }));
    options
}

/// Returns what a record says of a surface alone.
fn record_of(
    input: &LoadedInput,
    spline: &SplineFile,
    stored: &PowellSabinSurface,
    seed: u64,
) -> Record {
    let mesh = stored.mesh();
    let vectors = 48 * mesh.face_count();
    let options = spline.options.clone();
    Record {
        dofs: stored.dofs() as u64,
        domain_bytes: (24 * mesh.vertex_count() + 12 * mesh.face_count() + vectors) as u64,
        ..Record::start(spline.spline.method(), input.facts.clone(), options, seed)
    }
}

/// Fills in the errors at those vertices of the input that the surface has.
fn errors(
    record: &mut Record,
    input: &LoadedInput,
    at_vertices: &TriangleMesh,
    origins: &[Option<u32>],
) {
    let known: Vec<usize> = origins.iter().flatten().map(|&v| v as usize).collect();
    let pick = |mesh: &TriangleMesh, at: &dyn Fn(usize) -> usize| -> Vec<f64> {
        let points = (0..known.len()).map(|i| mesh.positions()[at(i)]);
        points.flat_map(|p| [p.x, p.y, p.z]).collect()
    };
    let all = known.len() == input.mesh.vertex_count();
    let fitted = pick(at_vertices, &|i| if all { known[i] } else { i });
    let data = pick(&input.mesh, &|i| known[i]);
    let [low, high] = input.mesh.bounding_box();
    record.error = vertex_error(&fitted, &data, 3, input.mesh.diagonal()).ok();
    record.error_unit_cube = unit_cube_error(&fitted, &data, (high - low).max()).ok();
}

/// The surface as triangles.
fn tessellation(spline: &PowellSabinSurface, segments: u32) -> TriangleMesh {
    triangles(&spline.tessellate(segments))
}

fn triangles(tessellation: &Tessellation) -> TriangleMesh {
    let mesh = TriangleMesh::build(tessellation.positions.clone(), tessellation.faces.clone());
    mesh.expect("faces of a manifold split alike are one")
}

/// Segments along a side of a face in pictures: more where faces are few and large.
fn segments(spline: &PowellSabinSurface) -> u32 {
    let even = (SHOWN_TRIANGLES / spline.mesh().face_count() as f64).sqrt();
    (even as u32).clamp(SHOWN_SEGMENTS, MOST_SHOWN_SEGMENTS)
}

fn coordinates(mesh: &TriangleMesh) -> Vec<f64> {
    mesh.positions()
        .iter()
        .flat_map(|p| [p.x, p.y, p.z])
        .collect()
}
