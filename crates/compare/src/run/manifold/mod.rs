//! Runs of sparse manifolds: from a control mesh or a scan to charts, and what they are compared with.

pub(super) mod chart;
mod control;
mod fields;
pub(super) mod network;
mod scan;

use std::path::PathBuf;

use msplines_common::Point3;
use msplines_common::mesh::{TriangleMesh, VertexAttribute};
use msplines_common::metrics::{SurfaceTree, VertexError, distance, vertex_error};
use msplines_common::progress::Observer;
use msplines_sparse_manifold::{Fit, Report, SparseManifold, Tessellation, Tessellator, fit_to};
use rayon::prelude::*;
use serde_json::{Value, json};

use super::{Evaluation, RunOutput, check_finite, enter, steps};
use crate::case::{Case, Data, DomainStorage, Input, SparseManifoldMethod, Task};
use crate::clock::PhaseClock;
use crate::error::RunError;
use crate::fit::following;
use crate::input::file_name;
use crate::output::{check_outputs, coordinates, write_positions};
use crate::record::{Checks, InputFacts, Record, named};
use crate::spline_file::{SplineFile, StoredDomain, StoredManifold, StoredPolygons, StoredSpline};
use control::Control;
pub(crate) use control::creases_file;
use fields::companions;

/// Points drawn from each surface when their distance is measured.
const SAMPLES: usize = 100_000;

/// Cells along the side of a face on which surfaces are compared.
const DENSE_CELLS: u32 = 16;

/// A surface beside the spline, for pictures.
#[derive(Clone, Debug)]
pub struct Companion {
    /// Name of its files.
    pub name: &'static str,
    /// The surface; absent for the spline itself, which has a file of its own.
    pub mesh: Option<TriangleMesh>,
    /// Edges of the control mesh on it, as pairs of vertices.
    pub edges: Vec<[u32; 2]>,
    /// Those of them that are sharp.
    pub creases: Vec<[u32; 2]>,
    /// Numbers at its vertices.
    pub fields: Vec<VertexAttribute>,
}

impl Companion {
    /// Returns a surface beside the spline without anything.
    pub(super) fn bare(name: &'static str) -> Self {
        Self {
            name,
            mesh: None,
            edges: Vec::new(),
            creases: Vec::new(),
            fields: Vec::new(),
        }
    }
}

/// Runs a case whose method is a sparse manifold.
pub(super) fn run(
    case: &Case,
    method: &SparseManifoldMethod,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    check(case)?;
    let problem = match method.scan {
        None => control::load(&case.input, method, clock)?,
        Some(vertices) => scan::load(case, method, vertices, clock)?,
    };
    enter("domain", clock, observer);
    let control = &problem.control;
    let fit = fitted(&problem, method, clock, observer)?;
    let spline = SplineFile::new(
        domain(case, &problem),
        options(case, method),
        StoredSpline::SparseManifold(StoredManifold::of(&fit.spline)),
    );
    // What is measured and written is what is stored.
    let stored = spline
        .spline
        .manifold("evaluation")?
        .restore(&control.mesh)?;
    enter("evaluate", clock, observer);
    let surface = Tessellator::build(&stored, method.cells.max(1)).surface(&stored);
    let mesh = triangles(&surface)?;
    enter("measure", clock, observer);
    let measured = problem.measure(&stored)?;
    let mut record = record(case.seed, &problem.facts, &spline, &stored);
    record.outcome = fit.report.outcome;
    record.checks = checks(&fit.report, &stored, control, &measured);
    record.check("evaluated_points", mesh.vertex_count());
    record.error = Some(measured.error);
    if let Some(scan) = &problem.scan {
        record.distance = Some(distance(scan, &mesh, SAMPLES, case.seed)?);
    }
    let fields = fields::fields(&stored, control, &surface, method)?;
    enter("write", clock, observer);
    write(&case.outputs, &spline, &mesh, &fields)?;
    steps::finish(&mut record, clock);
    record.warnings = problem.warnings.clone();
    Ok(RunOutput {
        companions: companions(&problem, &stored, &mesh, method),
        fields,
        ..RunOutput::of_surface(record, Some(spline), mesh)
    })
}

fn fitted(
    problem: &Problem,
    method: &SparseManifoldMethod,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<Fit, RunError> {
    let mut timed = following(&["fit"], clock, observer);
    let (mesh, sharpness) = (&problem.control.mesh, &problem.control.sharpness);
    let observations = &problem.observations;
    Ok(fit_to(
        mesh,
        sharpness,
        observations,
        &method.options,
        &mut timed,
    )?)
}

/// Evaluates a stored manifold on a grid of `2^rounds` cells a side in every face.
pub(super) fn evaluate(
    evaluation: &Evaluation,
    spline: SplineFile,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    if evaluation.sum.is_some() || !evaluation.shifts.is_empty() {
        return Err(RunError::Task {
            task: "control points or sums",
            method: spline.spline.method(),
        });
    }
    let mesh = control::domain_of(&spline, evaluation)?;
    enter("evaluate", clock, observer);
    let stored = spline.spline.manifold("evaluation")?.restore(&mesh)?;
    let surface = Tessellator::build(&stored, 1 << evaluation.subdivide).surface(&stored);
    let triangles = triangles(&surface)?;
    enter("write", clock, observer);
    write(&evaluation.outputs, &spline, &triangles, &[])?;
    let facts = facts(&mesh, file_name(&evaluation.spline), control::digest(&mesh));
    let mut record = record(evaluation.seed, &facts, &spline, &stored);
    record.check("evaluated_points", triangles.vertex_count());
    steps::finish(&mut record, clock);
    Ok(RunOutput::of_surface(record, Some(spline), triangles))
}

/// Writes a surface, or its spline, to every output.
fn write(
    outputs: &[PathBuf],
    spline: &SplineFile,
    mesh: &TriangleMesh,
    fields: &[VertexAttribute],
) -> Result<(), RunError> {
    let mut outputs = outputs.iter();
    outputs.try_for_each(|path| write_positions(path, spline, mesh, fields))
}

/// What is fitted and what it is compared with.
pub(crate) struct Problem {
    pub(crate) control: Control,
    pub(crate) observations: msplines_sparse_manifold::Observations,
    /// The surface that was scanned, where the control mesh comes from one.
    pub(crate) scan: Option<TriangleMesh>,
    pub(crate) facts: InputFacts,
    pub(crate) warnings: Vec<String>,
}

/// How far a surface is from what it approximates, also between the observations.
struct Measured {
    error: VertexError,
    /// In mean lengths of control edges.
    rms: f64,
    max: f64,
}

impl Problem {
    fn measure(&self, spline: &SparseManifold) -> Result<Measured, RunError> {
        let mesh = &self.control.mesh;
        let edge = mesh.mean_edge_length();
        let tessellator = Tessellator::build(spline, DENSE_CELLS);
        let faces: Vec<Vec<[f64; 3]>> = (0..mesh.face_count() as u32)
            .into_par_iter()
            .map(|face| tessellator.face(spline, face))
            .collect();
        let found: Vec<Point3<f64>> = faces.into_iter().flatten().map(Point3::from).collect();
        let target = match &self.scan {
            None => self.control.limit_points(),
            Some(scan) => scan::closest(scan, &SurfaceTree::build(scan), &found),
        };
        let scale = match &self.scan {
            Some(scan) => scan.diagonal(),
            None => mesh.diagonal(),
        };
        let error = vertex_error(&coordinates(&found), &coordinates(&target), 3, scale);
        let error = error.map_err(|e| RunError::Input {
            file: self.facts.file.clone(),
            reason: e.to_string(),
        })?;
        let kind = if self.scan.is_some() {
            "samples"
        } else {
            "limit_surface"
        };
        Ok(Measured {
            rms: error.rms * scale / edge,
            max: error.max * scale / edge,
            error: VertexError {
                kind: kind.to_owned(),
                ..error
            },
        })
    }
}

/// Outputs that could not be written later are refused before any work, and tasks and data that only
/// other methods have.
fn check(case: &Case) -> Result<(), RunError> {
    check_outputs(&case.outputs)?;
    let refused = |task| {
        Err(RunError::Task {
            task,
            method: case.method.name(),
        })
    };
    match (&case.task, &case.data) {
        (Task::Fit, Data::Positions) => {}
        (Task::Fit, _) => return refused("data other than positions"),
        _ => return refused("task beyond a fit"),
    }
    if case.double_cover || case.refine > 0 {
        return refused("cover or refinement of its input");
    }
    Ok(())
}

/// Returns a tessellation as a mesh.
///
/// # Errors
/// A point that is not finite.
fn triangles(surface: &Tessellation) -> Result<TriangleMesh, RunError> {
    check_finite(&coordinates(&surface.positions), 3)?;
    steps::tessellation(surface.positions.clone(), surface.triangles.clone())
}

fn domain(case: &Case, problem: &Problem) -> StoredDomain {
    let untouched = problem.scan.is_none() && !problem.control.refined;
    match (&case.input, case.domain) {
        (Input::File { repair, .. }, DomainStorage::Digest) if untouched => StoredDomain::Digest {
            sha256: problem.facts.sha256.clone(),
            repair: *repair,
        },
        _ => StoredDomain::Polygons {
            polygons: StoredPolygons::of(&problem.control.mesh),
        },
    }
}

fn options(case: &Case, method: &SparseManifoldMethod) -> Value {
    let mut options = json!(method.options);
    options["rules"] = json!(method.rules);
    options["creases"] = json!(method.creases);
    options["polygons"] = json!(method.polygons);
    options["cells"] = json!(method.cells);
    options["scan"] = json!(method.scan);
    steps::options(case, options)
}

fn checks(
    report: &Report,
    spline: &SparseManifold,
    control: &Control,
    measured: &Measured,
) -> Checks {
    let [edges, corners, darts] = control.sharp_counts();
    named([
        ("e_fit", json!(report.e_fit.last())),
        ("e_fit_start", json!(report.e_fit.first())),
        ("observations", json!(report.observations)),
        ("dense_rms", json!(measured.rms)),
        ("dense_max", json!(measured.max)),
        ("c0_atoms_crease", json!(report.c0_atoms_crease)),
        ("c0_atoms_smooth", json!(report.c0_atoms_smooth)),
        ("charts", json!(spline.mesh().vertex_count())),
        ("sweeps", json!(report.sweeps)),
        ("frozen_sweeps", json!(report.frozen_sweeps)),
        ("crease_edges", json!(edges)),
        ("sharp_corners", json!(corners)),
        ("darts", json!(darts)),
    ])
}

fn record(seed: u64, facts: &InputFacts, spline: &SplineFile, stored: &SparseManifold) -> Record {
    Record {
        dofs: stored.coefficient_count() as u64,
        domain_bytes: steps::polygon_bytes(stored.mesh()),
        ..steps::record(spline, facts, seed)
    }
}

/// Returns what a record says about a control mesh.
fn facts(
    mesh: &msplines_common::mesh::polygon::PolygonMesh,
    file: String,
    sha256: String,
) -> InputFacts {
    let topology = mesh.topology();
    let loops = topology.boundary_loops().len() as i64;
    let (_, components) = topology.components();
    let handles = (2 - topology.euler_characteristic() - loops) / 2;
    InputFacts {
        file,
        sha256,
        kind: crate::record::InputKind::Polygons,
        vertices: mesh.vertex_count() as u64,
        faces: mesh.face_count() as u64,
        cells: 0,
        genus: (components == 1).then_some(handles.max(0) as u64),
        boundary_loops: loops as u64,
    }
}
