//! Runs of Powell-Sabin splines: from a surface with normals to one spline through all its vertices.

mod evaluate;
mod measure;
mod pictures;
mod write;

use std::collections::BTreeMap;

use msplines_common::mesh::TriangleMesh;
use msplines_common::metrics::{unit_cube_error, vertex_error};
use msplines_common::progress::{Observer, Outcome};
use msplines_common::{Point3, Vector3};
use msplines_conformal::{AtlasReport, SurfaceAtlas};
use msplines_powell_sabin::surface::{Filled, SurfaceReport};
use msplines_powell_sabin::{PowellSabinSurface, SurfaceFit, VertexCondition, fit_surface};
use serde_json::{Value, json};

use super::{RunOutput, conformal, enter, prepared};
use crate::case::{Case, Data, Input, Method, PowellSabinMethod, Task};
use crate::clock::{PhaseClock, process_usage};
use crate::error::{PowellSabinError, RunError};
use crate::fit::following;
use crate::input::{LoadedInput, load, vertex_normals};
use crate::measure::to_reference;
use crate::record::Record;
use crate::spline_file::{SplineFile, StoredDomain, StoredMesh, StoredSpline};
use write::Written;

pub(super) use evaluate::evaluate;

/// Random points at which jumps and folds are looked for.
const SAMPLES: usize = 20_000;
/// Most segments along a side of a face.
const MOST_SEGMENTS: u32 = 64;
/// Segments along a side of a face in pictures.
const SHOWN_SEGMENTS: u32 = 4;

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

fn run(
    case: &Case,
    method: &PowellSabinMethod,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    check(case, method)?;
    let input = prepared(load(&case.input, clock)?, case)?;
    let normals = vertex_normals(&input)?;
    enter("domain", clock, observer);
    let choice = (method.form.as_ref(), &method.puncture[..]);
    let found = conformal::atlas(&input, choice, case.seed, observer)?;
    let conditions = conditions(&input, &found, &normals.normals);
    enter("fit", clock, observer);
    let fit = {
        let mut timed = following(&["fit"], clock, observer);
        fit_surface(&found.atlas, &conditions, &method.surface, &mut timed)
            .map_err(PowellSabinError::from)?
    };
    let spline = SplineFile::new(
        StoredDomain::Embedded {
            mesh: StoredMesh::of(fit.spline.mesh()),
        },
        options(case, method),
        StoredSpline::PowellSabin(Box::new(fit.spline.parts())),
    );
    enter("evaluate", clock, observer);
    // What is measured and written is what is stored.
    let stored = spline.spline.powell_sabin(fit.spline.mesh())?;
    let shown = tessellation(&stored, method.tessellate.unwrap_or(SHOWN_SEGMENTS));
    enter("measure", clock, observer);
    let mut record = record_of(&input, &spline, &stored, case.seed);
    fill_in(&mut record, &input, &found, &fit, &normals.warnings);
    let seed = case.seed;
    let checks = stored.measure(&conditions, seed, SAMPLES);
    record.checks.extend(measure::surface(&checks));
    let at_vertices = write::at_input_vertices(&stored, &found, &input.mesh);
    errors(&mut record, &input, &at_vertices, &found);
    distances(&mut record, case, &input, (&stored, &shown))?;
    enter("write", clock, observer);
    let written = Written {
        file: &spline,
        spline: &stored,
        segments: method.tessellate,
        at_vertices: &at_vertices,
    };
    write::write(&case.outputs, &written)?;
    let mut output = output(record, spline, shown, &at_vertices, &stored, clock);
    output.knots = conformal::zeros(&found.atlas);
    Ok(output)
}

/// Fills in what is known at the end.
fn output(
    mut record: Record,
    file: SplineFile,
    shown: TriangleMesh,
    at_vertices: &TriangleMesh,
    spline: &PowellSabinSurface,
    clock: &mut PhaseClock,
) -> RunOutput {
    clock.leave();
    let points = json!(at_vertices.vertex_count());
    record.checks.insert("evaluated_points".to_owned(), points);
    record.seconds = clock.read();
    record.peak_rss_bytes = process_usage().peak_rss_bytes;
    RunOutput {
        record,
        spline: Some(file),
        values: coordinates(&shown),
        mesh: shown,
        names: ["x", "y", "z"].map(str::to_owned).to_vec(),
        fields: Vec::new(),
        knots: Vec::new(),
        frames: Vec::new(),
        companions: pictures::companions(spline),
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

/// What the surface does at each vertex of the atlas: it interpolates those of the input.
fn conditions(
    input: &LoadedInput,
    found: &SurfaceAtlas,
    normals: &[Vector3<f64>],
) -> Vec<VertexCondition> {
    let origins = found.origins.iter().copied();
    let added = found.atlas.mesh().positions().iter().copied();
    let condition = |place: (Option<u32>, Point3<f64>)| match place {
        (Some(vertex), _) => VertexCondition::Interpolate {
            position: input.mesh.positions()[vertex as usize],
            normal: normals[vertex as usize],
        },
        // Added vertices lie on the facets; what is free at them is the normal.
        (None, position) => VertexCondition::Position { position },
    };
    origins.zip(added).map(condition).collect()
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

/// Fills in what the atlas and the fit say.
fn fill_in(
    record: &mut Record,
    input: &LoadedInput,
    found: &SurfaceAtlas,
    fit: &SurfaceFit,
    about_normals: &[String],
) {
    let report = &fit.report;
    record.outcome = report.regular.outcome;
    record.checks = checks(&found.report, report);
    let added = found.report.added_vertices;
    record.warnings = input
        .warnings
        .iter()
        .chain(about_normals)
        .cloned()
        .collect();
    if added > 0 {
        record.warnings.push(format!(
            "the mesh was too coarse for its atlas: {added} vertices were added on its faces, whose normals are free"
        ));
    }
    record
        .warnings
        .extend(report.warnings.iter().map(ToString::to_string));
    if record.outcome != Outcome::Converged {
        let left = report.regular.violations_after;
        record.warnings.push(format!(
            "the repair of orientations ended with {left} vertices inside out"
        ));
    }
}

fn checks(atlas: &AtlasReport, report: &SurfaceReport) -> BTreeMap<String, Value> {
    let filled = |which: fn(&Filled) -> bool| {
        json!(
            report
                .holes
                .iter()
                .filter(|hole| which(&hole.filled))
                .count()
        )
    };
    let named = [
        ("genus", json!(atlas.genus)),
        ("zeros", json!(atlas.zeros)),
        ("flips", json!(atlas.flips)),
        ("conformal_k_mean", json!(atlas.distortion.angle_mean)),
        ("conformal_k_p50", json!(atlas.distortion.angle_p50)),
        ("added_vertices", json!(atlas.added_vertices)),
        ("violations_before", json!(report.regular.violations_before)),
        ("repair_rounds", json!(report.regular.repair_rounds)),
        ("residual", json!(report.regular.residual)),
        ("unknowns", json!(report.regular.unknowns)),
        ("holes", json!(report.holes.len())),
        (
            "smooth_caps",
            filled(|f| matches!(f, Filled::Smooth { .. })),
        ),
        (
            "minimal_caps",
            filled(|f| matches!(f, Filled::Minimal { .. })),
        ),
    ];
    named.map(|(name, value)| (name.to_owned(), value)).into()
}

/// Fills in the errors at those vertices of the input that the surface has.
fn errors(
    record: &mut Record,
    input: &LoadedInput,
    at_vertices: &TriangleMesh,
    found: &SurfaceAtlas,
) {
    let known: Vec<usize> = found
        .origins
        .iter()
        .flatten()
        .map(|&v| v as usize)
        .collect();
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
    let tessellation = spline.tessellate(segments);
    let mesh = TriangleMesh::build(tessellation.positions, tessellation.faces);
    mesh.expect("faces of a manifold split alike are one")
}

fn coordinates(mesh: &TriangleMesh) -> Vec<f64> {
    mesh.positions()
        .iter()
        .flat_map(|p| [p.x, p.y, p.z])
        .collect()
}
