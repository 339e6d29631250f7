//! T-splines in files, by their extensions.

use std::path::{Path, PathBuf};

use msplines_common::Point3;
use msplines_common::evaluate::Order;
use msplines_common::mesh::TriangleMesh;
use msplines_io::{Surface, write_cells, write_step, write_surface};
use msplines_t_spline::TSplineSurface;
use msplines_t_spline::cells::{CellError, CellOptions, Patchwork};

use super::tessellation;
use crate::error::RunError;
use crate::output::{check_folder, check_outputs, extension, write_positions};
use crate::run::steps;
use crate::spline_file::SplineFile;

/// How far cells of caps may be from the surface, over the diagonal, and their degree: all other cells
/// are exact.
const CELLS: (f64, u8) = (1e-6, 7);
/// The same for shells, which geometric kernels read faster the fewer faces they have.
const SHELL: (f64, u8) = (1e-5, 5);

/// What can be written.
pub(super) struct Written<'a> {
    /// The spline file.
    pub(super) file: &'a SplineFile,
    /// The surface.
    pub(super) surface: &'a TSplineSurface,
    /// Segments along a side of a face; points at the vertices where absent.
    pub(super) segments: Option<u32>,
    /// The surface at the vertices of the input.
    pub(super) at_vertices: &'a TriangleMesh,
}

/// Checks before any work that every output can be written, and the number of segments.
pub(super) fn check(outputs: &[PathBuf], segments: Option<u32>) -> Result<(), RunError> {
    steps::check_segments(segments)?;
    let (shells, others): (Vec<_>, Vec<_>) = outputs.iter().cloned().partition(|p| is_shell(p));
    shells.iter().try_for_each(|path| check_folder(path))?;
    check_outputs(&others)
}

fn is_shell(path: &Path) -> bool {
    ["step", "stp"].contains(&extension(path).as_str())
}

/// Returns the patches of a surface, those of caps within a share of its diagonal.
fn patchwork(surface: &TSplineSurface, (share, degree): (f64, u8)) -> Result<Patchwork, CellError> {
    let [low, high] = surface.domain().mesh().bounding_box();
    let tolerance = share * (high - low).norm();
    let options = CellOptions { tolerance, degree };
    surface.spline().patchwork(&options)
}

/// The surface at the vertices of the input.
pub(super) struct AtVertices {
    /// The faces of the input over the points of the surface; where there are none, over its own vertices.
    pub(super) mesh: TriangleMesh,
    /// Which vertices the surface has.
    pub(super) known: Vec<u32>,
}

impl AtVertices {
    pub(super) fn of(surface: &TSplineSurface, input: &TriangleMesh) -> Self {
        let domain = surface.domain();
        let mut places = surface.vertices();
        let mut names = domain.origins().to_vec();
        for pole in domain.poles() {
            places.push(pole.at);
            names.push(Some(pole.vertex));
        }
        let found = surface.spline().evaluate(&places, Order::Value).positions;
        let mut positions: Vec<Point3<f64>> = input.positions().to_vec();
        let mut known = Vec::with_capacity(positions.len());
        for (name, position) in names.iter().zip(found) {
            if let Some(vertex) = *name {
                positions[vertex as usize] = position;
                known.push(vertex);
            }
        }
        known.sort_unstable();
        known.dedup();
        Self {
            mesh: input.with_positions(positions),
            known,
        }
    }
}

/// Writes a surface to every output: Bézier cells, a shell of patches, a tessellation, points at the
/// vertices of the input, or the spline itself.
pub(super) fn write(outputs: &[PathBuf], written: &Written<'_>) -> Result<(), RunError> {
    outputs.iter().try_for_each(|path| write_one(path, written))
}

fn write_one(path: &Path, written: &Written<'_>) -> Result<(), RunError> {
    match (extension(path).as_str(), written.segments) {
        ("vtu", _) => {
            let patches = patchwork(written.surface, CELLS);
            let cells = patches.and_then(|p| p.cells());
            let cells = cells.map_err(RunError::unwritten(path))?;
            write_cells(path, &cells, &[], &[])
        }
        ("step" | "stp", _) => {
            let patches = patchwork(written.surface, SHELL);
            let shell = patches.and_then(|p| p.shell());
            write_step(path, &shell.map_err(RunError::unwritten(path))?)
        }
        ("json" | "npy", _) | (_, None) => {
            return write_positions(path, written.file, written.at_vertices, &[]);
        }
        (_, Some(segments)) => {
            let mesh = tessellation(written.surface, segments)?;
            let surface = Surface {
                positions: mesh.positions(),
                faces: mesh.faces(),
                ..Surface::default()
            };
            write_surface(path, &surface)
        }
    }
    .map_err(RunError::unwritten(path))
}
