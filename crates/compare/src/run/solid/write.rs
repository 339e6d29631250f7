//! Solids in files, by their extensions.

use std::path::{Path, PathBuf};

use msplines_common::Point3;
use msplines_common::bspline::vtk_hexahedron_order;
use msplines_common::mesh::{TriangleMesh, VertexAttribute};
use msplines_io::{Field, Volume, VolumeCells, WriteError, write_atomically, write_volume};
use msplines_trivariate::TrivariateSpline;
use msplines_trivariate::export::gismo_xml;
use msplines_trivariate::measure::hexahedra;

use crate::error::{RunError, TrivariateError};
use crate::output::{check_folder, extension, is_array, write_array, write_positions};
use crate::spline_file::SplineFile;

/// Extensions of what holds the spline, its boundary, or the solid.
const FORMATS: [&str; 9] = [
    "json", "npy", "ply", "obj", "glb", "vtu", "xml", "msh", "mesh",
];
/// Extension of points as text.
const TEXT: &str = "csv";
/// End of the name of a file of hexahedra, where Bézier cells would be written otherwise.
const HEXAHEDRA: &str = ".hex.vtu";
/// Control points along the side of a cubic Bézier cell, less the one that neighbours share.
const STEP: usize = 3;

/// What is written of a solid.
pub(super) struct Written<'a> {
    pub(super) file: &'a SplineFile,
    pub(super) spline: &'a TrivariateSpline,
    /// Cells along the side of a span.
    pub(super) cells: usize,
    pub(super) boundary: &'a TriangleMesh,
    pub(super) fields: &'a [VertexAttribute],
}

/// Checks before any work that every output has a known format and a folder.
pub(super) fn check(outputs: &[PathBuf]) -> Result<(), RunError> {
    for path in outputs {
        if !FORMATS.contains(&extension(path).as_str()) {
            return Err(TrivariateError::Output { path: path.clone() }.into());
        }
        check_folder(path)?;
    }
    Ok(())
}

/// Checks that outputs can hold single points.
pub(super) fn check_points(outputs: &[PathBuf]) -> Result<(), RunError> {
    for path in outputs {
        if !is_array(path) && extension(path) != TEXT {
            return Err(TrivariateError::PointOutput { path: path.clone() }.into());
        }
        check_folder(path)?;
    }
    Ok(())
}

/// Writes a solid to every output.
pub(super) fn write(outputs: &[PathBuf], solid: &Written<'_>) -> Result<(), RunError> {
    outputs.iter().try_for_each(|path| write_one(path, solid))
}

fn write_one(path: &Path, solid: &Written<'_>) -> Result<(), RunError> {
    let name = path.to_string_lossy().to_ascii_lowercase();
    match extension(path).as_str() {
        "vtu" if !name.ends_with(HEXAHEDRA) => write_bezier(path, solid.spline),
        "vtu" | "msh" | "mesh" => write_hexahedra(path, solid),
        "xml" => {
            let text = gismo_xml(solid.spline);
            write_atomically(path, |to| to.write_all(text.as_bytes()))
        }
        _ => return write_positions(path, solid.file, solid.boundary, solid.fields),
    }
    .map_err(RunError::unwritten(path))
}

fn write_hexahedra(path: &Path, solid: &Written<'_>) -> Result<(), WriteError> {
    let mesh = hexahedra(solid.spline, solid.spline.spans() * solid.cells);
    let volume = Volume {
        positions: &mesh.points,
        cells: VolumeCells::Hexahedra(&mesh.cells),
        point_data: &[],
        cell_data: &[Field {
            name: "scaled_jacobian",
            components: 1,
            values: &mesh.scaled_jacobians,
        }],
    };
    write_volume(path, &volume)
}

/// Writes one Bézier cell for each span; neighbours share control points.
fn write_bezier(path: &Path, spline: &TrivariateSpline) -> Result<(), WriteError> {
    let spans = spline.spans();
    let side = STEP * spans + 1;
    let cells = spline.bezier_cells();
    let per_cell = (STEP + 1).pow(3);
    let order = vtk_hexahedron_order([STEP; 3]);
    let mut positions = vec![Point3::origin(); side.pow(3)];
    let mut points = Vec::with_capacity(per_cell * spans.pow(3));
    for (cell, bezier) in cells.points().chunks_exact(per_cell).enumerate() {
        let span = [cell % spans, cell / spans % spans, cell / (spans * spans)];
        let place = |local: usize| {
            let width = STEP + 1;
            let local = [
                local % width,
                local / width % width,
                local / (width * width),
            ];
            let [i, j, k] = std::array::from_fn(|d| STEP * span[d] + local[d]);
            i + side * (j + side * k)
        };
        for (local, point) in bezier.iter().enumerate() {
            positions[place(local)] = *point;
        }
        points.extend(order.iter().map(|&local| place(local) as u32));
    }
    let cells = VolumeCells::BezierHexahedra {
        degree: STEP,
        points: &points,
    };
    let volume = Volume {
        positions: &positions,
        cells,
        point_data: &[],
        cell_data: &[],
    };
    write_volume(path, &volume)
}

/// Names of the columns of [`write_points`].
const COLUMNS: [&str; 12] = [
    "x", "y", "z", "x_u", "y_u", "z_u", "x_v", "y_v", "z_v", "x_w", "y_w", "z_w",
];

/// Writes rows of a point and its three first derivatives.
pub(super) fn write_points(outputs: &[PathBuf], rows: &[[f64; 12]]) -> Result<(), RunError> {
    for path in outputs {
        if is_array(path) {
            write_array(path, vec![rows.len(), 12], rows.as_flattened().to_vec())?;
            continue;
        }
        let written = write_atomically(path, |to| {
            writeln!(to, "{}", COLUMNS.join(","))?;
            for row in rows {
                let numbers = row.map(|x| format!("{x:?}"));
                writeln!(to, "{}", numbers.join(","))?;
            }
            Ok(())
        });
        written.map_err(RunError::unwritten(path))?;
    }
    Ok(())
}
