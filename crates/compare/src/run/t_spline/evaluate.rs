//! T-splines in files, evaluated again.

use msplines_common::Point3;
use msplines_common::progress::Observer;
use serde_json::json;

use super::edits;
use super::write::{AtVertices, Written, check, write};
use super::{SPLINE, errors, marks, output, record_of};
use crate::clock::PhaseClock;
use crate::error::{RunError, SplineFileError};
use crate::input::load_domain;
use crate::run::{Evaluation, RunOutput, enter};
use crate::spline_file::{LARGEST, SplineFile, StoredSpline};

/// Evaluates a stored surface and writes it.
pub(in crate::run) fn evaluate(
    evaluation: &Evaluation,
    file: SplineFile,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    if !evaluation.changes.is_empty() {
        let remedy = "give --move, --control or --pull";
        return Err(RunError::without(SPLINE, "control triangles", remedy));
    }
    evaluation.check_tessellated(SPLINE)?;
    let segments = evaluation.cells.map(|cells| cells as u32);
    check(&evaluation.outputs, segments)?;
    let changes = &evaluation.t_spline;
    changes.check_list()?;
    let input = load_domain(&file, evaluation.mesh.as_deref(), &evaluation.spline, clock)?;
    enter("evaluate", clock, observer);
    let mut file = edits::at_level(file, changes.level, &input.mesh)?;
    let mut surface = file.spline.t_spline(&input.mesh)?;
    let mut at_vertices = AtVertices::of(&surface, &input.mesh);
    let far = |p: &Point3<f64>| !p.iter().all(|x| x.abs() <= LARGEST);
    if let Some(index) = at_vertices.mesh.positions().iter().position(far) {
        let what = "point";
        return Err(SplineFileError::NotFinite { what, index }.into());
    }
    let mut checks = Vec::new();
    if !changes.moves_nothing() {
        let edited = edits::edited(file, &surface, changes)?;
        let after = AtVertices::of(&edited.surface, &input.mesh);
        checks.extend(edited.checks(&at_vertices.mesh, &after.mesh));
        (file, surface, at_vertices) = (edited.file, edited.surface, after);
    }
    enter("write", clock, observer);
    if let Some(path) = &changes.list {
        edits::write_list(path, &surface)?;
    }
    let written = Written {
        file: &file,
        surface: &surface,
        segments,
        at_vertices: &at_vertices.mesh,
    };
    write(&evaluation.outputs, &written)?;
    let mut record = record_of(&input, &file, &surface, evaluation.seed);
    // A changed surface is no fit of its domain.
    if checks.is_empty() {
        errors(&mut record, &input, &at_vertices);
    }
    record.checks.extend(checks);
    if let StoredSpline::TSpline(stored) = &file.spline {
        let levels = json!(stored.level_count());
        record.checks.insert("levels".to_owned(), levels);
    }
    let marks = marks(&surface, &at_vertices);
    Ok(output(record, file, at_vertices, marks, clock))
}
