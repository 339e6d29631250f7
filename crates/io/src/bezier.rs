//! From Bézier cells to a file.

use std::path::Path;

use msplines_common::bspline::{BezierCells, CellShape};

use crate::WriteError;
use crate::format::extension;
use crate::output::{check_positions, write_atomically};
use crate::volume::{Field, check_fields};
use crate::vtu;

/// Name by which VTK knows the weights of control points.
const WEIGHTS: &str = "RationalWeights";
/// Name by which VTK knows the degrees of cells along their directions.
const DEGREES: &str = "HigherOrderDegrees";

/// Writes Bézier triangles, quads or hexahedra of any degree as they are, as VTK's `.vtu`.
///
/// The points of the file are the control points in the order of `cells`, in which `point_data` gives
/// each of them its numbers; `cell_data` gives each cell its own, such as the face it lies over. Every
/// cell has its own points, also along edges: neighbours agree there as far as their control points do.
/// Cells may differ in degree: triangles tell it by the number of their points. Weights are written as `RationalWeights`, degrees that differ along the directions of a cell as
/// `HigherOrderDegrees`.
///
/// The file is written beside `path` and renamed; on an error nothing is left behind. The same cells
/// give the same bytes, and numbers come back exactly.
///
/// # Errors
/// The extension is not `.vtu`, the file cannot be written, or the cells are not fit to be: a degree of
/// 0, a number that is not finite, a weight that is not positive, a field of another length or without
/// a name of its own.
pub fn write_cells(
    path: &Path,
    cells: &BezierCells,
    point_data: &[Field<'_>],
    cell_data: &[Field<'_>],
) -> Result<(), WriteError> {
    if extension(path).as_deref() != Some("vtu") {
        let path = path.to_owned();
        return Err(WriteError::BezierFormat { path });
    }
    let directions = match cells.shape() {
        CellShape::Triangles => 1,
        CellShape::Quads => 2,
        CellShape::Hexahedra => 3,
    };
    let runs = cells.runs();
    if runs.iter().any(|run| run.degree[..directions].contains(&0)) {
        return Err(WriteError::BezierDegree);
    }
    check_positions(cells.points())?;
    if let Some(weights) = cells.weights() {
        let is_wrong = |weight: &f64| !(weight.is_finite() && *weight > 0.0);
        if let Some(point) = weights.iter().position(is_wrong) {
            let weight = weights[point];
            return Err(WriteError::BezierWeight { point, weight });
        }
    }
    let weights = cells.weights().map(|values| Field {
        name: WEIGHTS,
        components: 1,
        values,
    });
    let is_even = |degree: [usize; 3]| degree[..directions].iter().all(|&d| d == degree[0]);
    let uneven = runs.iter().any(|run| !is_even(run.degree));
    let told = runs.iter().filter(|_| uneven).flat_map(|run| {
        let degree = |d: usize| {
            if d < directions {
                run.degree[d] as f64
            } else {
                0.0
            }
        };
        [0, 1, 2].map(degree).repeat(run.cells)
    });
    let degrees: Vec<f64> = told.collect();
    let degrees = uneven.then_some(Field {
        name: DEGREES,
        components: 3,
        values: &degrees,
    });
    let point_data: Vec<Field<'_>> = weights
        .into_iter()
        .chain(point_data.iter().copied())
        .collect();
    let cell_data: Vec<Field<'_>> = degrees
        .into_iter()
        .chain(cell_data.iter().copied())
        .collect();
    check_fields(&point_data, cells.points().len())?;
    check_fields(&cell_data, cells.len())?;
    write_atomically(path, |to| {
        vtu::write_bezier(cells, &point_data, &cell_data, to)
    })
}
