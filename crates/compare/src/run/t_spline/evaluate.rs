//! T-splines in files, evaluated again.

use msplines_common::progress::Observer;

use super::write::{AtVertices, Written, check, write};
use super::{errors, marks, output, record_of};
use crate::clock::PhaseClock;
use crate::error::{RunError, TSplineError};
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
    let refused = |what, remedy| Err(TSplineError::FitOnly { what, remedy }.into());
    if evaluation.sum.is_some() || !evaluation.shifts.is_empty() || !evaluation.changes.is_empty() {
        return refused("sums and moves of knots", "leave them out");
    }
    if evaluation.at.is_some() || !evaluation.moved.is_empty() || evaluation.subdivide > 0 {
        return refused(
            "parameters and subdivision",
            "leave them out, or give --tessellate",
        );
    }
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
