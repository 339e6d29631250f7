//! Meshes of solids: tetrahedra in, tetrahedra and hexahedra out.
//!
//! The parsers are our own, on the text helpers of this crate, `quick-xml` and `flate2`. Of the
//! libraries, `mshio` reads version 4.1 of Gmsh's format only and had its last release in 2020;
//! `vtkio` has no stable release in years, takes header counts at their word and tells no line; for
//! Medit and TetGen there is none that is kept. The tests of this crate hold what other programs write.

mod cells;
mod cursor;
mod gmsh;
mod medit;
mod tetgen;
mod vtk;
mod vtu;
mod write;

use std::path::{Path, PathBuf};

use msplines_common::mesh::tet::TetSoup;

use crate::error::{Fault, Place};
use crate::read::bytes_of;
use crate::{Format, ReadError};

pub(crate) use vtk::has_magic as is_vtk;
pub(crate) use vtu::has_magic as is_vtu;
pub(crate) use write::check_fields;
pub use write::{Field, Volume, VolumeCells, write_volume};

/// Returns the vertices and tetrahedra of a file, in file order.
///
/// Reads Medit `.mesh` (text), Gmsh `.msh` 2.2 and 4.1 (text and binary), VTK `.vtk` (text and
/// binary) and `.vtu` (text, base64, appended, zlib), and TetGen's pair of `.node` and `.ele`, of which either names
/// both. The format is told by the content, then by the extension. Cells of lower dimension are left
/// out. Nothing about the mesh is checked. Takes a few times the file's size in memory.
///
/// # Errors
/// The file cannot be read, is in none of these formats, breaks the rules of its format, ends early,
/// or holds no tetrahedra, or other solid cells beside them.
pub fn read_tets(path: &Path) -> Result<TetSoup, ReadError> {
    let bytes = bytes_of(path)?;
    if format_of(path, &bytes)? != Format::TetGen {
        return parse_tets(path, &bytes);
    }
    let [node, ele] = ["node", "ele"].map(|extension| path.with_extension(extension));
    parse_tetgen((&node, &bytes_of(&node)?), (&ele, &bytes_of(&ele)?))
}

/// Returns what [`read_tets`] does for a file with these bytes; `path` names it in errors.
///
/// # Errors
/// As [`read_tets`]; one file of TetGen's pair alone is refused, see [`parse_tetgen`].
pub fn parse_tets(path: &Path, bytes: &[u8]) -> Result<TetSoup, ReadError> {
    let format = format_of(path, bytes)?;
    let parsed = match format {
        Format::Medit => medit::parse(bytes),
        Format::Gmsh => gmsh::parse(bytes),
        Format::Vtk => vtk::parse(bytes),
        Format::Vtu => vtu::parse(bytes),
        Format::TetGen => Err(Fault::Unsupported {
            place: Place::Line(1),
            feature: "one file of TetGen's pair alone".to_owned(),
            remedy: "give the .node and the .ele file together",
        }),
        _ => Err(Fault::Unsupported {
            place: Place::Line(1),
            feature: "a surface or another kind of file in place of a solid".to_owned(),
            remedy: "give tetrahedra as .mesh, .msh, .vtk, .vtu or .node with .ele",
        }),
    };
    checked(path, format, parsed)
}

/// Returns what [`read_tets`] does for the `.node` and the `.ele` file with these bytes.
///
/// # Errors
/// As [`read_tets`].
pub fn parse_tetgen(node: (&Path, &[u8]), ele: (&Path, &[u8])) -> Result<TetSoup, ReadError> {
    let format = Format::TetGen;
    let nodes = tetgen::parse_nodes(node.1);
    let nodes = nodes.map_err(|fault| fault.in_file(node.0.to_owned(), format))?;
    checked(ele.0, format, tetgen::parse_cells(ele.1, nodes))
}

/// Returns the refusal of a mesh of a solid where a surface is expected.
pub(crate) fn no_surface() -> Fault {
    Fault::Unsupported {
        place: Place::Line(1),
        feature: "a solid in place of a surface".to_owned(),
        remedy: "give a surface as OBJ, OFF, PLY or STL, or read it as tetrahedra",
    }
}

fn format_of(path: &Path, bytes: &[u8]) -> Result<Format, ReadError> {
    let path_buf = || path.to_owned();
    if bytes.is_empty() {
        return Err(ReadError::Empty { path: path_buf() });
    }
    Format::detect(path, bytes).ok_or_else(|| ReadError::NotSolid { path: path_buf() })
}

fn checked(
    path: &Path,
    format: Format,
    parsed: Result<TetSoup, Fault>,
) -> Result<TetSoup, ReadError> {
    let path = || -> PathBuf { path.to_owned() };
    let soup = parsed.map_err(|fault| fault.in_file(path(), format))?;
    let (vertices, cells) = (soup.positions.len(), soup.cells.len());
    if cells == 0 {
        return Err(ReadError::NoCells {
            path: path(),
            format,
            vertices,
        });
    }
    if vertices >= u32::MAX as usize || cells >= (u32::MAX / 6) as usize {
        return Err(ReadError::TooLarge {
            path: path(),
            format,
            vertices,
            corners: 4 * cells,
        });
    }
    Ok(soup)
}

/// Returns whether a file starts like a Medit file, text or binary.
pub(crate) fn is_medit(bytes: &[u8]) -> bool {
    medit::has_magic(bytes)
}

/// Returns whether a file starts like a Gmsh file.
pub(crate) fn is_gmsh(bytes: &[u8]) -> bool {
    gmsh::has_magic(bytes)
}
