//! The pictures of a row about an animation are those of one of its frames.

use std::path::Path;

use msplines_common::mesh::TriangleMesh;
use msplines_io::read_points;

use crate::campaign::RowReport;
use crate::run::ShownFrame;

/// Returns the surface that was fitted in a frame and its spline, on the faces of `domain`; the frame
/// is the one that the files of the row end with where `asked` names none. `None` for a row about a
/// single surface.
pub(super) fn load(
    report: &RowReport,
    asked: Option<usize>,
    files: &Path,
    domain: &TriangleMesh,
) -> Result<Option<[TriangleMesh; 2]>, String> {
    let last = report
        .result
        .record()
        .map(|record| &record.options["frame"]);
    let last = last.and_then(serde_json::Value::as_u64);
    let frame = match (&report.row.over_time, asked, last) {
        (None, ..) => return Ok(None),
        (Some(_), Some(frame), _) => frame,
        (Some(_), None, Some(last)) => last as usize,
        (Some(_), None, None) => return Err("its record names no frame".to_owned()),
    };
    let surface = |name: &String| {
        let positions = read_points(&files.join(name)).map_err(|e| e.to_string())?;
        if positions.len() == domain.vertex_count() {
            Ok(domain.with_positions(positions))
        } else {
            Err(format!(
                "{name} has not one point for every vertex; run the row again with --fresh"
            ))
        }
    };
    let [data, spline] = ShownFrame::files(frame);
    Ok(Some([surface(&data)?, surface(&spline)?]))
}
