//! From a file to a soup.

use std::fs;
use std::path::Path;

use msplines_common::mesh::PolygonSoup;

use crate::{Format, ReadError, obj, off, ply, stl};

/// Returns the positions, polygons and vertex attributes of a file, in file order.
///
/// The format is told by the content, then by the extension. Nothing about the mesh is checked.
/// Takes the file's size in memory beside the result.
///
/// # Errors
/// The file cannot be read, is in no known format, breaks the rules of its format, ends early, or
/// holds no vertices or no faces.
pub fn read_soup(path: &Path) -> Result<PolygonSoup, ReadError> {
    match fs::read(path) {
        Ok(bytes) => parse_soup(path, &bytes),
        Err(source) => Err(ReadError::Open {
            path: path.to_owned(),
            source,
        }),
    }
}

/// Returns what [`read_soup`] does for a file with these bytes; `path` names it in errors.
///
/// # Errors
/// As [`read_soup`].
pub fn parse_soup(path: &Path, bytes: &[u8]) -> Result<PolygonSoup, ReadError> {
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
    };
    let soup = parsed.map_err(|fault| fault.in_file(path.to_owned(), format))?;
    check_size(path, format, &soup)?;
    Ok(soup)
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
    if soup.face_count() == 0 {
        return Err(ReadError::NoFaces {
            path: path(),
            format,
            vertices,
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
