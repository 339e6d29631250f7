//! Trivariate splines in files: evaluated, and with control points moved.

use std::path::Path;

use msplines_common::Point3;
use msplines_common::progress::Observer;
use msplines_trivariate::TrivariateSpline;
use msplines_trivariate::validity;
use rayon::prelude::*;

use super::boundary::CubeSurface;
use super::write::{self, Written};
use super::{SPLINE, measure, pictures, record, squares};
use crate::arrays::read_rows;
use crate::clock::PhaseClock;
use crate::error::{RunError, SplineFileError, TrivariateError};
use crate::input::file_name;
use crate::run::{Evaluation, RunOutput, enter, steps};
use crate::spline_file::{SplineFile, StoredDomain, StoredSpline, StoredTrivariate};

/// Cells along the side of a span where neither the command nor the file says how many.
const CELLS: usize = 4;

/// Evaluates a stored solid, after control points have been moved, and writes it.
pub(in crate::run) fn evaluate(
    evaluation: &Evaluation,
    mut file: SplineFile,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    check(evaluation)?;
    let StoredDomain::Cube { cube } = &file.domain else {
        return Err(SplineFileError::NoCube.into());
    };
    let facts = cube.facts(file_name(&evaluation.spline));
    let mut spline = file.spline.trivariate("evaluation")?.restore()?;
    if !evaluation.moved.is_empty() {
        spline = moved(&spline, &evaluation.moved)?;
        file.spline = StoredSpline::Trivariate(StoredTrivariate::of(&spline));
    }
    enter("evaluate", clock, observer);
    let of_file = file.options["cells"].as_u64().map(|cells| cells as usize);
    let cells = evaluation.cells.or(of_file).unwrap_or(CELLS).clamp(1, 64);
    let squares = squares(&spline, cells);
    let mesh = CubeSurface::new(squares).of(&spline)?;
    let points = match &evaluation.at {
        Some(path) => Some(at_parameters(&spline, path)?),
        None => None,
    };
    enter("measure", clock, observer);
    let mut record = record(evaluation.seed, &facts, &file, &spline);
    let (certificate, checks, warnings) = measure::folds(&spline, &validity::Options::default());
    (record.checks, record.warnings) = (checks, warnings);
    record.check("moved_points", evaluation.moved.len());
    let fields = pictures::boundary_fields(&spline, squares, certificate.volume, None);
    enter("write", clock, observer);
    match &points {
        Some(rows) => write::write_points(&evaluation.outputs, rows)?,
        None => {
            let written = Written {
                file: &file,
                spline: &spline,
                cells,
                boundary: &mesh,
                fields: &fields,
            };
            write::write(&evaluation.outputs, &written)?;
        }
    }
    let count = points.map_or(mesh.vertex_count(), |rows| rows.len());
    record.check("evaluated_points", count);
    steps::finish(&mut record, clock);
    Ok(RunOutput {
        fields,
        ..RunOutput::of_surface(record, Some(file), mesh)
    })
}

/// What only surfaces have is refused, and outputs before any work.
fn check(evaluation: &Evaluation) -> Result<(), RunError> {
    let refused = |what, remedy| Err(RunError::without(SPLINE, what, remedy));
    if !evaluation.shifts.is_empty() {
        let remedy = "move its control points with `msplines deform`";
        return refused("control points of a surface", remedy);
    }
    if evaluation.sum.is_some() {
        return refused("sums", "give biharmonic splines");
    }
    if evaluation.subdivide > 0 {
        let remedy = "give --tessellate for the cells along the side of a span";
        return refused("midpoint subdivision", remedy);
    }
    match &evaluation.at {
        Some(_) => write::check_points(&evaluation.outputs),
        None => write::check(&evaluation.outputs),
    }
}

fn moved(
    spline: &TrivariateSpline,
    moves: &[([usize; 3], [f64; 3])],
) -> Result<TrivariateSpline, RunError> {
    let moves: Vec<_> = moves
        .iter()
        .map(|&(index, to)| (index, Point3::from(to)))
        .collect();
    Ok(spline.with_moved(&moves).map_err(TrivariateError::Move)?)
}

/// Returns points and first derivatives at the parameters in a file.
fn at_parameters(spline: &TrivariateSpline, path: &Path) -> Result<Vec<[f64; 12]>, RunError> {
    let refused = |reason: String| RunError::Array {
        option: "--at",
        file: file_name(path),
        reason,
    };
    let mut parameters: Vec<[f64; 3]> = Vec::new();
    for (row, numbers) in read_rows(path, "--at")?.into_iter().enumerate() {
        let inside = numbers.iter().all(|x| (0.0..=1.0).contains(x));
        match <[f64; 3]>::try_from(numbers) {
            Ok(parameter) if inside => parameters.push(parameter),
            _ => {
                return Err(refused(format!(
                    "row {row} is no parameter; give three numbers u v w from 0 to 1"
                )));
            }
        }
    }
    let row = |&at: &[f64; 3]| {
        let jet = spline.jet(at);
        let vectors = [jet.value.coords, jet.first[0], jet.first[1], jet.first[2]];
        std::array::from_fn(|i| vectors[i / 3][i % 3])
    };
    Ok(parameters.par_iter().map(row).collect())
}
