//! Powell-Sabin splines in files, evaluated again.

use msplines_common::progress::Observer;
use serde_json::json;

use super::write::{Written, check, vertex_positions, write};
use super::{MOST_SEGMENTS, SHOWN_SEGMENTS, coordinates, pictures, record_of, tessellation};
use crate::clock::{PhaseClock, process_usage};
use crate::error::{PowellSabinError, RunError};
use crate::input::load_domain;
use crate::run::{Evaluation, RunOutput, enter};
use crate::spline_file::SplineFile;

/// Evaluates a stored surface and writes it.
pub(in crate::run) fn evaluate(
    evaluation: &Evaluation,
    file: SplineFile,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    let refused = |what, remedy| Err(PowellSabinError::FitOnly { what, remedy }.into());
    if evaluation.sum.is_some() || !evaluation.shifts.is_empty() {
        return refused("sums and moves of knots", "leave them out");
    }
    if evaluation.at.is_some() || !evaluation.moved.is_empty() || evaluation.subdivide > 0 {
        return refused(
            "parameters and subdivision",
            "leave them out, or give --tessellate",
        );
    }
    let segments = evaluation.cells.map(|cells| cells as u32);
    if let Some(segments) = segments.filter(|n| !(1..=MOST_SEGMENTS).contains(n)) {
        return Err(PowellSabinError::Segments { segments }.into());
    }
    check(&evaluation.outputs)?;
    let input = load_domain(&file, evaluation.mesh.as_deref(), &evaluation.spline, clock)?;
    enter("evaluate", clock, observer);
    let spline = file.spline.powell_sabin(&input.mesh)?;
    let at_vertices = input.mesh.with_positions(vertex_positions(&spline));
    let shown = tessellation(&spline, segments.unwrap_or(SHOWN_SEGMENTS));
    enter("write", clock, observer);
    let written = Written {
        file: &file,
        spline: &spline,
        segments,
        at_vertices: &at_vertices,
    };
    write(&evaluation.outputs, &written)?;
    clock.leave();
    let mut record = record_of(&input, &file, &spline, evaluation.seed);
    let points = json!(at_vertices.vertex_count());
    record.checks.insert("evaluated_points".to_owned(), points);
    record.seconds = clock.read();
    record.peak_rss_bytes = process_usage().peak_rss_bytes;
    Ok(RunOutput {
        record,
        spline: Some(file),
        values: coordinates(&shown),
        mesh: shown,
        names: ["x", "y", "z"].map(str::to_owned).to_vec(),
        fields: Vec::new(),
        knots: Vec::new(),
        frames: Vec::new(),
        companions: pictures::companions(&spline),
        texture: None,
    })
}
