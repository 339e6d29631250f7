//! Powell-Sabin splines in files, evaluated again.

use msplines_common::progress::Observer;

use super::edits;
use super::write::{Written, check, vertex_positions, write};
use super::{MOST_SEGMENTS, SHOWN_SEGMENTS, output, record_of};
use crate::clock::PhaseClock;
use crate::error::{PowellSabinError, RunError};
use crate::input::load_domain;
use crate::run::{Evaluation, RunOutput, enter};
use crate::spline_file::{SplineFile, StoredDomain, StoredMesh, StoredSpline};

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
    let mut spline = file.spline.powell_sabin(&input.mesh)?;
    let (mut file, mut checks) = (file, Vec::new());
    if !evaluation.changes.is_empty() {
        let edited = edits::edited(&spline, &evaluation.changes)?;
        (spline, checks) = (edited.surface, edited.checks);
        let mesh = StoredMesh::of(spline.mesh());
        let stored = StoredSpline::PowellSabin(Box::new(spline.parts()));
        file = SplineFile::new(StoredDomain::Embedded { mesh }, file.options, stored);
    }
    let at_vertices = spline.mesh().with_positions(vertex_positions(&spline));
    let shown = spline.tessellate(segments.unwrap_or(SHOWN_SEGMENTS));
    enter("write", clock, observer);
    let written = Written {
        file: &file,
        spline: &spline,
        segments,
        at_vertices: &at_vertices,
    };
    write(&evaluation.outputs, &written)?;
    let mut record = record_of(&input, &file, &spline, evaluation.seed);
    record.checks.extend(checks);
    Ok(output(record, file, &shown, &at_vertices, &spline, clock))
}
