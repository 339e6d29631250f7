//! Which format a file is in.

use std::fmt;
use std::path::Path;

use crate::{npy, off, ply, stl, volume};

/// A format that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// Geomview OFF.
    Off,
    /// Stanford PLY.
    Ply,
    /// Stereolithography STL.
    Stl,
    /// NumPy's array, which is no mesh.
    Npy,
    /// Text of a curve network, which is no mesh.
    Curves,
    /// Scalable vector graphics: a curve network in the plane, which is no mesh.
    Svg,
    /// Creases of a control mesh.
    Creases,
    /// Medit's tetrahedra.
    Medit,
    /// Gmsh's tetrahedra.
    Gmsh,
    /// Tetrahedra in VTK's legacy file of an unstructured grid.
    Vtk,
    /// Tetrahedra in VTK's XML file of an unstructured grid.
    Vtu,
    /// TetGen's tetrahedra, in two files.
    TetGen,
}

impl Format {
    /// Returns the format of a file with these bytes and this name: by content where the format
    /// has a mark of its own, else by extension.
    #[must_use]
    pub fn detect(path: &Path, bytes: &[u8]) -> Option<Self> {
        if ply::has_magic(bytes) {
            Some(Self::Ply)
        } else if off::has_magic(bytes) {
            Some(Self::Off)
        } else if npy::has_magic(bytes) {
            Some(Self::Npy)
        } else if volume::is_vtk(bytes) {
            Some(Self::Vtk)
        } else if volume::is_vtu(bytes) {
            Some(Self::Vtu)
        } else if volume::is_medit(bytes) {
            Some(Self::Medit)
        } else if volume::is_gmsh(bytes) {
            Some(Self::Gmsh)
        } else if stl::has_magic(bytes) {
            Some(Self::Stl)
        } else {
            Self::from_extension(path)
        }
    }

    fn from_extension(path: &Path) -> Option<Self> {
        match extension(path)?.as_str() {
            "obj" => Some(Self::Obj),
            "off" | "coff" | "noff" => Some(Self::Off),
            "ply" => Some(Self::Ply),
            "stl" => Some(Self::Stl),
            "curves" => Some(Self::Curves),
            "svg" => Some(Self::Svg),
            "creases" => Some(Self::Creases),
            "mesh" | "meshb" => Some(Self::Medit),
            "msh" => Some(Self::Gmsh),
            "vtk" => Some(Self::Vtk),
            "vtu" => Some(Self::Vtu),
            "node" | "ele" => Some(Self::TetGen),
            _ => None,
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Obj => "OBJ",
            Self::Off => "OFF",
            Self::Ply => "PLY",
            Self::Stl => "STL",
            Self::Npy => "npy",
            Self::Curves => "curve network",
            Self::Svg => "SVG",
            Self::Creases => "creases",
            Self::Medit => "Medit",
            Self::Gmsh => "Gmsh",
            Self::Vtk => "VTK",
            Self::Vtu => "VTU",
            Self::TetGen => "TetGen",
        })
    }
}

/// Returns the extension in lower case, without its dot.
pub(crate) fn extension(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}
