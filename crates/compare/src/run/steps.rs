//! Steps that runs of several methods share, so that each adds only what is its own.

use msplines_common::Point3;
use msplines_common::mesh::TriangleMesh;
use msplines_common::mesh::polygon::PolygonMesh;
use msplines_common::metrics::{Distance, unit_cube_error, vertex_error};
use serde_json::{Value, json};

use crate::case::{Case, Data, Task};
use crate::clock::{PhaseClock, process_usage};
use crate::error::RunError;
use crate::measure::to_reference;
use crate::output::coordinates;
use crate::record::{InputFacts, Record};
use crate::spline_file::SplineFile;

/// Most segments along a side of a face.
const MOST_SEGMENTS: u32 = 64;

/// Refuses tasks, data and changes of the input beyond a plain fit of positions; `spline` is what the
/// method makes, with its article.
pub(super) fn check_plain_fit(case: &Case, spline: &'static str) -> Result<(), RunError> {
    let (what, remedy) = match case {
        _ if case.task != Task::Fit => ("task beyond a fit", "leave it out"),
        _ if case.data != Data::Positions => ("data other than positions", "leave them out"),
        _ if case.double_cover || case.subdivide > 0 => {
            ("cover or subdivision of its input", "leave them out")
        }
        _ => return Ok(()),
    };
    Err(RunError::without(spline, what, remedy))
}

/// Refuses too few or too many segments along a side of a face.
pub(super) fn check_segments(segments: Option<u32>) -> Result<(), RunError> {
    match segments.filter(|n| !(1..=MOST_SEGMENTS).contains(n)) {
        Some(segments) => Err(RunError::Segments { segments }),
        None => Ok(()),
    }
}

/// Returns the options of a method together with those that every run has.
pub(super) fn options(case: &Case, mut method: Value) -> Value {
    method["data"] = json!(case.data);
    method["seed"] = json!(case.seed);
    method["repair"] = json!(case.input.is_mended());
    method
}

/// Returns the record of a spline that nothing is measured of yet.
pub(super) fn record(file: &SplineFile, input: &InputFacts, seed: u64) -> Record {
    let options = file.options.clone();
    Record::start(file.spline.method(), input.clone(), options, seed)
}

/// Returns what a mesh of triangles costs as a domain: positions and corners.
pub(super) fn triangle_bytes(mesh: &TriangleMesh) -> u64 {
    (24 * mesh.vertex_count() + 12 * mesh.face_count()) as u64
}

/// Returns what a mesh of polygons costs as a domain: positions and corners.
pub(super) fn polygon_bytes(mesh: &PolygonMesh) -> u64 {
    (24 * mesh.vertex_count() + 4 * mesh.topology().half_edge_count()) as u64
}

/// Fills in the errors of points of a spline against those that they approximate, on the scale of the
/// input.
pub(super) fn errors(
    record: &mut Record,
    [fitted, data]: [&[Point3<f64>]; 2],
    input: &TriangleMesh,
) {
    let (fitted, data) = (coordinates(fitted), coordinates(data));
    let [low, high] = input.bounding_box();
    record.error = vertex_error(&fitted, &data, 3, input.diagonal()).ok();
    record.error_unit_cube = unit_cube_error(&fitted, &data, (high - low).max()).ok();
}

/// Fills in the distances that are asked for: to the input, as `measured`, and of the shown surface to
/// that of another file.
pub(super) fn distances(
    record: &mut Record,
    case: &Case,
    [input, shown]: [&TriangleMesh; 2],
    measured: impl FnOnce() -> Result<Distance, RunError>,
) -> Result<(), RunError> {
    if case.measure_distance {
        record.distance = Some(measured()?);
    }
    if let Some(path) = &case.reference {
        let values = coordinates(shown.positions());
        let found = to_reference(path, input, shown, &values, case.seed)?;
        record.checks.extend(found);
    }
    Ok(())
}

/// Returns a tessellation as a mesh.
pub(super) fn tessellation(
    positions: Vec<Point3<f64>>,
    triangles: Vec<[u32; 3]>,
) -> Result<TriangleMesh, RunError> {
    TriangleMesh::build(positions, triangles).map_err(|e| RunError::Input {
        file: "the tessellation".to_owned(),
        reason: e.to_string(),
    })
}

/// Fills in what a run has taken, once its outputs are written.
pub(super) fn finish(record: &mut Record, clock: &mut PhaseClock) {
    clock.leave();
    record.seconds = clock.read();
    record.peak_rss_bytes = process_usage().peak_rss_bytes;
}
