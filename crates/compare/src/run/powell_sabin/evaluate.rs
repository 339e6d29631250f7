//! Powell-Sabin splines in files, evaluated again.

use msplines_common::progress::Observer;

use super::edits;
use super::write::{Written, vertex_positions, write};
use super::{SHOWN_SEGMENTS, SPLINE, output, record_of};
use crate::clock::PhaseClock;
use crate::error::RunError;
use crate::input::load_domain;
use crate::output::check_outputs;
use crate::record::Checks;
use crate::run::{Evaluation, RunOutput, enter, steps};
use crate::spline_file::{SplineFile, StoredDomain, StoredMesh, StoredSpline};

/// Evaluates a stored surface and writes it.
pub(in crate::run) fn evaluate(
    evaluation: &Evaluation,
    file: SplineFile,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    evaluation.check_tessellated(SPLINE)?;
    let segments = evaluation.cells.map(|cells| cells as u32);
    steps::check_segments(segments)?;
    check_outputs(&evaluation.outputs)?;
    let input = load_domain(&file, evaluation.mesh.as_deref(), &evaluation.spline, clock)?;
    enter("evaluate", clock, observer);
    let mut spline = file.spline.powell_sabin(&input.mesh)?;
    let (mut file, mut checks) = (file, Checks::new());
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
