//! Powell-Sabin splines in files, by their extensions.

use std::path::{Path, PathBuf};

use msplines_common::Point3;
use msplines_common::evaluate::{Order, Samples, SurfaceSpline};
use msplines_common::mesh::{SurfacePoint, TriangleMesh};
use msplines_io::{Surface, write_cells, write_surface};
use msplines_powell_sabin::PowellSabinSurface;

use crate::error::RunError;
use crate::output::{extension, write_positions};
use crate::spline_file::SplineFile;

/// What can be written.
pub(super) struct Written<'a> {
    /// The spline file.
    pub(super) file: &'a SplineFile,
    /// The surface.
    pub(super) spline: &'a PowellSabinSurface,
    /// Segments along a side of a face; points at the vertices where absent.
    pub(super) segments: Option<u32>,
    /// The surface at the vertices of the input.
    pub(super) at_vertices: &'a TriangleMesh,
}

/// Returns the surface at the vertices of the input, joined by its faces; where stars were removed, at
/// those of the atlas that are left, joined by the faces of the atlas.
pub(super) fn at_input_vertices(
    spline: &PowellSabinSurface,
    origins: &[Option<u32>],
    input: &TriangleMesh,
) -> TriangleMesh {
    let known = origins.iter().flatten().count();
    let positions = vertex_positions(spline);
    if known == input.vertex_count() {
        return input.with_positions(positions[..known].to_vec());
    }
    spline.mesh().with_positions(positions)
}

/// The surface at the vertices of its domain; where a hole is open, the vertex of the domain.
pub(super) fn vertex_positions(spline: &PowellSabinSurface) -> Vec<Point3<f64>> {
    let topology = spline.mesh().topology();
    let mut samples = Samples::default();
    let mut position = |vertex: u32| {
        // A rim vertex lies on faces of its hole too, which may be open.
        let places = topology.outgoing(vertex).map(|half_edge| {
            let mut at = [0.0; 3];
            at[(half_edge % 3) as usize] = 1.0;
            SurfacePoint {
                face: half_edge / 3,
                at,
            }
        });
        for place in places {
            if let Ok(prepared) = spline.prepare(&[place], Order::Value) {
                prepared.evaluate(&mut samples);
                return Point3::from_slice(&samples.values);
            }
        }
        spline.mesh().positions()[vertex as usize]
    };
    let vertices = 0..spline.mesh().vertex_count() as u32;
    vertices.map(&mut position).collect()
}

/// Writes a surface to every output: exact cells, a tessellation with normals, points at the vertices
/// of the input, or the spline itself.
pub(super) fn write(outputs: &[PathBuf], written: &Written<'_>) -> Result<(), RunError> {
    outputs.iter().try_for_each(|path| write_one(path, written))
}

fn write_one(path: &Path, written: &Written<'_>) -> Result<(), RunError> {
    match (extension(path).as_str(), written.segments) {
        ("vtu", _) => {
            let cells = written
                .spline
                .bezier_cells(PowellSabinSurface::CELL_TOLERANCE);
            write_cells(path, &cells.cells, &[], &[])
        }
        ("json" | "npy", _) | (_, None) => {
            return write_positions(path, written.file, written.at_vertices, &[]);
        }
        (_, Some(segments)) => {
            let tessellation = written.spline.tessellate(segments);
            let surface = Surface {
                positions: &tessellation.positions,
                faces: &tessellation.faces,
                normals: Some(&tessellation.normals),
                ..Surface::default()
            };
            write_surface(path, &surface)
        }
    }
    .map_err(RunError::unwritten(path))
}
