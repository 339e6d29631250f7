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

use msplines_common::Point3;
use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::{Observer, Outcome};
use msplines_powell_sabin::{PowellSabinSurface, Tessellation, VertexCondition};
use serde_json::{Value, json};

use super::{RunOutput, enter, prepared, steps};
use crate::case::{Case, Layout, PowellSabinMethod};
use crate::clock::PhaseClock;
use crate::error::RunError;
use crate::input::{LoadedInput, load};
use crate::output::check_outputs;
use crate::record::{Checks, Record};
use crate::spline_file::{SplineFile, StoredDomain, StoredMesh, StoredSpline};
use write::Written;

pub use edits::{Change, ChangeKind};
pub(super) use evaluate::evaluate;

/// Random points at which jumps and folds are looked for.
const SAMPLES: usize = 20_000;
/// Fewest and most segments along a side of a face in pictures.
const SHOWN_SEGMENTS: u32 = 4;
const MOST_SHOWN_SEGMENTS: u32 = 24;
/// Triangles in pictures, about, between those bounds.
const SHOWN_TRIANGLES: f64 = 400_000.0;

/// What refusals call these splines.
const SPLINE: &str = "a Powell-Sabin spline";

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
    checks: Checks,
    warnings: Vec<String>,
}

/// Runs a case whose method is a Powell-Sabin spline.
pub(super) fn run(
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
    let meshes = [&input.mesh, &triangles(&shown)];
    steps::distances(&mut record, case, meshes, || {
        measure::distance_to(&stored, &input.mesh, case.seed)
    })?;
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
        record.check("rim_angle", angle);
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
    record.check("evaluated_points", at_vertices.vertex_count());
    steps::finish(&mut record, clock);
    RunOutput {
        fields: pictures::normals(&shown.normals),
        companions: pictures::companions(spline, shown),
        ..RunOutput::of_surface(record, Some(file), triangles(shown))
    }
}

/// Tasks, data and options that mean nothing here are refused, and outputs before any work.
fn check(case: &Case, method: &PowellSabinMethod) -> Result<(), RunError> {
    steps::check_plain_fit(case, SPLINE)?;
    if method.basis.is_some() && method.layout != Layout::Plane {
        return Err(RunError::without(
            SPLINE,
            "single basis function over an atlas",
            "give `layout = \"plane\"` with it",
        ));
    }
    steps::check_segments(method.tessellate)?;
    check_outputs(&case.outputs)
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
    options["refine"] = json!(case.refine);
    steps::options(case, options)
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
    Record {
        dofs: stored.dofs() as u64,
        domain_bytes: steps::triangle_bytes(mesh) + vectors as u64,
        ..steps::record(spline, &input.facts, seed)
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
    let pick = |mesh: &TriangleMesh, at: &dyn Fn(usize) -> usize| -> Vec<Point3<f64>> {
        (0..known.len()).map(|i| mesh.positions()[at(i)]).collect()
    };
    let all = known.len() == input.mesh.vertex_count();
    let fitted = pick(at_vertices, &|i| if all { known[i] } else { i });
    let data = pick(&input.mesh, &|i| known[i]);
    steps::errors(record, [&fitted, &data], &input.mesh);
}

/// The surface as triangles.
fn triangles(tessellation: &Tessellation) -> TriangleMesh {
    let mesh = TriangleMesh::build(tessellation.positions.clone(), tessellation.faces.clone());
    mesh.expect("faces of a manifold split alike are one")
}

/// Segments along a side of a face in pictures: more where faces are few and large.
fn segments(spline: &PowellSabinSurface) -> u32 {
    let even = (SHOWN_TRIANGLES / spline.mesh().face_count() as f64).sqrt();
    (even as u32).clamp(SHOWN_SEGMENTS, MOST_SHOWN_SEGMENTS)
}
