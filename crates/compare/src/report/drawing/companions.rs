//! Surfaces beside the spline of a row, and the lines on them, as its run left them.

use std::path::Path;

use msplines_common::mesh::{TriangleMesh, VertexAttribute};
use msplines_io::read_npy;

use crate::input::read_surface;
use crate::output::{CREASE_LINES, EDGE_LINES, companion_lines, companion_surface};

/// Lines along the edges of a control mesh, as pairs of vertices of a surface.
#[derive(Default)]
pub(super) struct Lines {
    pub(super) edges: Vec<[u32; 2]>,
    /// Those that are sharp.
    pub(super) creases: Vec<[u32; 2]>,
}

/// A control mesh and what is approximated.
pub(super) struct Companions {
    /// The control mesh.
    pub(super) control: (TriangleMesh, Lines),
    /// The surface that the spline approximates.
    pub(super) target: Option<(TriangleMesh, Lines)>,
    /// Lines on the spline.
    pub(super) spline: Lines,
}

impl Companions {
    /// Returns what the folder of a row holds.
    pub(super) fn load(files: &Path) -> Result<Self, String> {
        Ok(Self {
            control: surface(files, "control")?,
            target: surface(files, "target").ok(),
            spline: lines(files, "spline")?,
        })
    }
}

/// A surface that carries numbers.
pub(super) struct FieldMesh {
    pub(super) mesh: TriangleMesh,
    pub(super) lines: Lines,
    pub(super) attributes: Vec<VertexAttribute>,
}

impl FieldMesh {
    /// Returns a surface in the folder of a row.
    pub(super) fn load(files: &Path, name: &str) -> Result<Self, String> {
        let read = read_surface(&files.join(companion_surface(name)));
        let (mesh, attributes) = read.map_err(|e| e.to_string())?;
        Ok(Self {
            mesh,
            lines: lines(files, name)?,
            attributes,
        })
    }
}

/// The surfaces beside the spline of a solid, or of an interpolant.
pub(super) struct SolidSurfaces {
    /// The input.
    pub(super) input: FieldMesh,
    /// The solid cut open, where the cut leaves something.
    pub(super) cut: Option<FieldMesh>,
    /// Lines on the boundary of the spline.
    pub(super) spline: Lines,
    /// Control triangles, where there are any.
    pub(super) control: Option<FieldMesh>,
    /// The domain with its faces split, where that is kept.
    pub(super) refinement: Option<FieldMesh>,
    /// Two charts in the plane, where they are kept.
    pub(super) charts: Option<FieldMesh>,
}

impl SolidSurfaces {
    /// Returns what the folder of a row holds.
    pub(super) fn load(files: &Path) -> Result<Self, String> {
        let field_mesh = |name: &str| FieldMesh::load(files, name);
        Ok(Self {
            input: field_mesh("input")?,
            cut: field_mesh("cut").ok(),
            spline: lines(files, "spline")?,
            control: field_mesh("control").ok(),
            refinement: field_mesh("refinement").ok(),
            charts: field_mesh("charts").ok(),
        })
    }
}

fn surface(files: &Path, name: &str) -> Result<(TriangleMesh, Lines), String> {
    let read = read_surface(&files.join(companion_surface(name)));
    let (mesh, _) = read.map_err(|e| e.to_string())?;
    Ok((mesh, lines(files, name)?))
}

fn lines(files: &Path, name: &str) -> Result<Lines, String> {
    let pairs = |kind: &str| -> Result<Vec<[u32; 2]>, String> {
        let array =
            read_npy(&files.join(companion_lines(name, kind))).map_err(|e| e.to_string())?;
        let pairs = array.values.chunks_exact(2);
        Ok(pairs.map(|pair| [pair[0] as u32, pair[1] as u32]).collect())
    };
    Ok(Lines {
        edges: pairs(EDGE_LINES)?,
        creases: pairs(CREASE_LINES)?,
    })
}
