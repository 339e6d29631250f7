//! From a solid to a file.

use std::io::{self, Write};
use std::path::Path;

use nalgebra::Point3;

use crate::WriteError;
use crate::format::extension;
use crate::output::{check_positions, write_atomically};
use crate::vtu;

/// A mesh of a solid to write.
#[derive(Clone, Copy, Debug)]
pub struct Volume<'a> {
    /// Vertex positions.
    pub positions: &'a [Point3<f64>],
    /// Cells.
    pub cells: VolumeCells<'a>,
    /// Data of vertices.
    pub point_data: &'a [Field<'a>],
    /// Data of cells.
    pub cell_data: &'a [Field<'a>],
}

/// Cells of one kind, by zero-based vertices.
#[derive(Clone, Copy, Debug)]
pub enum VolumeCells<'a> {
    /// Tetrahedra, positively oriented.
    Tetrahedra(&'a [[u32; 4]]),
    /// Hexahedra: a face counter-clockwise as seen from inside, and the opposite face alike.
    Hexahedra(&'a [[u32; 8]]),
    /// Bézier hexahedra, whose vertices are control points.
    BezierHexahedra {
        /// Degree along all directions.
        degree: usize,
        /// Control points of one cell after those of another, each in the order of VTK.
        points: &'a [u32],
    },
}

/// Numbers at vertices or cells.
#[derive(Clone, Copy, Debug)]
pub struct Field<'a> {
    /// Its name.
    pub name: &'a str,
    /// Numbers of each vertex or cell: 1 for scalars, 3 for vectors, 9 for matrices.
    pub components: usize,
    /// All numbers, those of a vertex or cell one after another.
    pub values: &'a [f64],
}

impl<'a> VolumeCells<'a> {
    /// Returns the number of cells.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Self::Tetrahedra(cells) => cells.len(),
            Self::Hexahedra(cells) => cells.len(),
            Self::BezierHexahedra { points, .. } => points.len() / self.corners(),
        }
    }

    /// Returns the number of vertices of each cell.
    #[must_use]
    pub fn corners(&self) -> usize {
        match self {
            Self::Tetrahedra(_) => 4,
            Self::Hexahedra(_) => 8,
            Self::BezierHexahedra { degree, .. } => (degree + 1).pow(3),
        }
    }

    /// Returns the vertices of all cells, one cell after another.
    #[must_use]
    pub fn vertices(&self) -> &'a [u32] {
        match self {
            Self::Tetrahedra(cells) => cells.as_flattened(),
            Self::Hexahedra(cells) => cells.as_flattened(),
            Self::BezierHexahedra { points, .. } => points,
        }
    }
}

/// Writes a solid as Medit `.mesh`, Gmsh `.msh` (4.1, text) or VTK `.vtu`, as the extension of `path`
/// asks for. Medit holds no data of vertices and cells; they are left out. Only VTK has Bézier cells.
///
/// The file is written beside `path` and renamed; on an error nothing is left behind. The same solid
/// gives the same bytes, and numbers come back exactly.
///
/// # Errors
/// The extension is unknown, the file cannot be written, or the solid is not fit to be: an index out
/// of range, a number that is not finite, control points that do not fill whole cells, a field of
/// another length or without a name of its own.
pub fn write_volume(path: &Path, volume: &Volume<'_>) -> Result<(), WriteError> {
    check(volume)?;
    let is_bezier = matches!(volume.cells, VolumeCells::BezierHexahedra { .. });
    match extension(path).as_deref() {
        Some("mesh" | "msh") if is_bezier => Err(WriteError::BezierFormat {
            path: path.to_owned(),
        }),
        Some("mesh") => write_atomically(path, |to| write_medit(volume, to)),
        Some("msh") => write_atomically(path, |to| write_gmsh(volume, to)),
        Some("vtu") => write_atomically(path, |to| vtu::write_volume(volume, to)),
        _ => Err(WriteError::UnknownVolumeFormat {
            path: path.to_owned(),
        }),
    }
}

fn check(volume: &Volume<'_>) -> Result<(), WriteError> {
    let vertices = volume.positions.len();
    let corners = volume.cells.vertices();
    let per_cell = volume.cells.corners();
    if !corners.len().is_multiple_of(per_cell) {
        return Err(WriteError::BezierPoints {
            points: corners.len(),
            per_cell,
        });
    }
    if let Some(place) = corners.iter().position(|&v| v as usize >= vertices) {
        return Err(WriteError::CellIndexOutOfRange {
            cell: place / per_cell,
            vertex: corners[place],
            vertices,
        });
    }
    check_positions(volume.positions)?;
    check_fields(volume.point_data, vertices)?;
    check_fields(volume.cell_data, volume.cells.count())
}

/// Refuses fields that have not their number of finite values for each of `count` vertices or cells,
/// or no names of their own.
pub(crate) fn check_fields(fields: &[Field<'_>], count: usize) -> Result<(), WriteError> {
    let mut numbered = fields.iter().enumerate();
    numbered.try_for_each(|(i, field)| check_field(field, &fields[..i], count))
}

fn check_field(field: &Field<'_>, before: &[Field<'_>], count: usize) -> Result<(), WriteError> {
    let name = || field.name.to_owned();
    let taken = before.iter().any(|other| other.name == field.name);
    let is_odd = |c: char| c.is_whitespace() || c.is_control() || c == '"';
    if taken || matches!(field.name, "" | "x" | "y" | "z") || field.name.chars().any(is_odd) {
        return Err(WriteError::AttributeName { name: name() });
    }
    if field.components == 0 || field.values.len() != field.components.saturating_mul(count) {
        return Err(WriteError::FieldLength {
            name: name(),
            values: field.values.len(),
            components: field.components,
            count,
        });
    }
    match field.values.iter().position(|value| !value.is_finite()) {
        Some(place) => Err(WriteError::NotFinite {
            name: name(),
            vertex: place / field.components,
        }),
        None => Ok(()),
    }
}

fn write_medit(volume: &Volume<'_>, to: &mut dyn Write) -> io::Result<()> {
    writeln!(to, "MeshVersionFormatted 2\nDimension 3\nVertices")?;
    writeln!(to, "{}", volume.positions.len())?;
    for p in volume.positions {
        writeln!(to, "{:?} {:?} {:?} 0", p.x, p.y, p.z)?;
    }
    let keyword = match volume.cells {
        VolumeCells::Tetrahedra(_) => "Tetrahedra",
        VolumeCells::Hexahedra(_) | VolumeCells::BezierHexahedra { .. } => "Hexahedra",
    };
    writeln!(to, "{keyword}\n{}", volume.cells.count())?;
    for corners in volume.cells.vertices().chunks(volume.cells.corners()) {
        for corner in corners {
            write!(to, "{} ", u64::from(*corner) + 1)?;
        }
        writeln!(to, "0")?;
    }
    writeln!(to, "End")
}

fn write_gmsh(volume: &Volume<'_>, to: &mut dyn Write) -> io::Result<()> {
    let (vertices, cells) = (volume.positions.len(), volume.cells.count());
    let kind = match volume.cells {
        VolumeCells::Tetrahedra(_) => 4,
        VolumeCells::Hexahedra(_) | VolumeCells::BezierHexahedra { .. } => 5,
    };
    writeln!(to, "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes")?;
    writeln!(to, "1 {vertices} 1 {vertices}\n3 1 0 {vertices}")?;
    for tag in 1..=vertices {
        writeln!(to, "{tag}")?;
    }
    for p in volume.positions {
        writeln!(to, "{:?} {:?} {:?}", p.x, p.y, p.z)?;
    }
    writeln!(
        to,
        "$EndNodes\n$Elements\n1 {cells} 1 {cells}\n3 1 {kind} {cells}"
    )?;
    for (cell, corners) in volume
        .cells
        .vertices()
        .chunks(volume.cells.corners())
        .enumerate()
    {
        write!(to, "{}", cell + 1)?;
        for corner in corners {
            write!(to, " {}", u64::from(*corner) + 1)?;
        }
        writeln!(to)?;
    }
    writeln!(to, "$EndElements")?;
    for (section, fields) in [
        ("NodeData", volume.point_data),
        ("ElementData", volume.cell_data),
    ] {
        for field in fields {
            write_gmsh_field(section, field, to)?;
        }
    }
    Ok(())
}

/// Writes a view: its name, its time, and step, components and number of rows.
fn write_gmsh_field(section: &str, field: &Field<'_>, to: &mut dyn Write) -> io::Result<()> {
    // Gmsh knows scalars, vectors and matrices; others are filled up with zeros.
    let width = [1, 3, 9].into_iter().find(|&n| n >= field.components);
    let width = width.unwrap_or(field.components);
    let rows = field.values.len() / field.components;
    writeln!(
        to,
        "${section}\n1\n\"{}\"\n1\n0\n3\n0\n{width}\n{rows}",
        field.name
    )?;
    for (row, values) in field.values.chunks(field.components).enumerate() {
        write!(to, "{}", row + 1)?;
        for column in 0..width {
            write!(to, " {:?}", values.get(column).copied().unwrap_or(0.0))?;
        }
        writeln!(to)?;
    }
    writeln!(to, "$End{section}")
}
