//! From a file to a soup.

use std::fs;
use std::path::Path;

use msplines_common::mesh::PolygonSoup;
use nalgebra::Point3;

use crate::{Format, ReadError, curves, npy, obj, off, ply, stl, volume};

/// Returns the positions, polygons and vertex attributes of a file, in file order.
///
/// The format is told by the content, then by the extension. Nothing about the mesh is checked.
/// Takes the file's size in memory beside the result.
///
/// # Errors
/// The file cannot be read, is in no known format, breaks the rules of its format, ends early, or
/// holds no vertices or no faces.
pub fn read_soup(path: &Path) -> Result<PolygonSoup, ReadError> {
    parse_soup(path, &bytes_of(path)?)
}

/// Returns the vertex positions of a file, in file order; it may hold points and no faces.
///
/// # Errors
/// As [`read_soup`], but for the faces.
pub fn read_points(path: &Path) -> Result<Vec<Point3<f64>>, ReadError> {
    parse_points(path, &bytes_of(path)?)
}

/// Returns what [`read_points`] does for a file with these bytes; `path` names it in errors.
///
/// # Errors
/// As [`read_points`].
pub fn parse_points(path: &Path, bytes: &[u8]) -> Result<Vec<Point3<f64>>, ReadError> {
    let (_, soup) = parse_any(path, bytes)?;
    Ok(soup.positions)
}

/// Returns the content of a file.
pub(crate) fn bytes_of(path: &Path) -> Result<Vec<u8>, ReadError> {
    fs::read(path).map_err(|source| ReadError::Open {
        path: path.to_owned(),
        source,
    })
}

/// Returns what [`read_soup`] does for a file with these bytes; `path` names it in errors.
///
/// # Errors
/// As [`read_soup`].
pub fn parse_soup(path: &Path, bytes: &[u8]) -> Result<PolygonSoup, ReadError> {
    let (format, soup) = parse_any(path, bytes)?;
    if soup.face_count() == 0 {
        return Err(ReadError::NoFaces {
            path: path.to_owned(),
            format,
            vertices: soup.positions.len(),
        });
    }
    Ok(soup)
}

/// Returns what a file holds, and in which format, if it holds vertices.
fn parse_any(path: &Path, bytes: &[u8]) -> Result<(Format, PolygonSoup), ReadError> {
    if bytes.is_empty() {
        return Err(ReadError::Empty {
            path: path.to_owned(),
        });
    }
    let Some(format) = Format::detect(path, bytes) else {
        return Err(ReadError::UnknownFormat {
            path: path.to_owned(),
        });
    };
    let parsed = match format {
        Format::Obj => obj::parse(bytes),
        Format::Off => off::parse(bytes),
        Format::Ply => ply::parse(bytes),
        Format::Stl => stl::parse(bytes),
        Format::Npy => Err(npy::no_mesh()),
        Format::Curves | Format::Svg | Format::Creases => Err(curves::no_mesh(format)),
        Format::Medit | Format::Gmsh | Format::Vtk | Format::Vtu | Format::TetGen => {
            Err(volume::no_surface())
        }
    };
    let soup = parsed.map_err(|fault| fault.in_file(path.to_owned(), format))?;
    check_size(path, format, &soup)?;
    Ok((format, soup))
}

fn check_size(path: &Path, format: Format, soup: &PolygonSoup) -> Result<(), ReadError> {
    let path = || path.to_owned();
    let (vertices, corners) = (soup.positions.len(), soup.face_vertices.len());
    if vertices == 0 {
        return Err(ReadError::NoVertices {
            path: path(),
            format,
        });
    }
    if vertices >= u32::MAX as usize || corners >= u32::MAX as usize {
        return Err(ReadError::TooLarge {
            path: path(),
            format,
            vertices,
            corners,
        });
    }
    Ok(())
}
