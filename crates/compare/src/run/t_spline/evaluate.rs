//! T-splines in files, evaluated again.

use msplines_common::progress::Observer;

use super::write::{AtVertices, Written, check, write};
use super::{SPLINE, errors, marks, output, record_of};
use crate::clock::PhaseClock;
use crate::error::RunError;
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
    if !evaluation.changes.is_empty() {
        return Err(Evaluation::no_moves(SPLINE));
    }
    evaluation.check_tessellated(SPLINE)?;
    let segments = evaluation.cells.map(|cells| cells as u32);
    check(&evaluation.outputs, segments)?;
    let input = load_domain(&file, evaluation.mesh.as_deref(), &evaluation.spline, clock)?;
    enter("evaluate", clock, observer);
    let surface = file.spline.t_spline(&input.mesh)?;
    let at_vertices = AtVertices::of(&surface, &input.mesh);
    enter("write", clock, observer);
    let written = Written {
        file: &file,
        surface: &surface,
        segments,
        at_vertices: &at_vertices.mesh,
    };
    write(&evaluation.outputs, &written)?;
    let mut record = record_of(&input, &file, &surface, evaluation.seed);
    errors(&mut record, &input, &at_vertices);
    let marks = marks(&surface, &at_vertices);
    Ok(output(record, file, at_vertices, marks, clock))
}
