//! What several tests of files need.

use std::path::{Path, PathBuf};

use msplines_common::mesh::{PolygonSoup, VertexAttribute};
use msplines_io::{ReadError, Surface, parse_soup, write_surface};
use nalgebra::Point3;
use tempfile::TempDir;

/// Returns a new folder, which goes when dropped, and the path of `name` in it.
pub(crate) fn scratch(name: &str) -> (TempDir, PathBuf) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(name);
    (directory, path)
}

/// Returns the soup of a file with this name and content.
pub(crate) fn soup(name: &str, content: impl AsRef<[u8]>) -> PolygonSoup {
    parse_soup(Path::new(name), content.as_ref()).unwrap()
}

/// Returns why a file with this name and content is refused.
pub(crate) fn refusal(name: &str, content: impl AsRef<[u8]>) -> ReadError {
    parse_soup(Path::new(name), content.as_ref()).unwrap_err()
}

/// Returns all faces.
pub(crate) fn faces(soup: &PolygonSoup) -> Vec<Vec<i64>> {
    (0..soup.face_count())
        .map(|face| soup.face(face).to_vec())
        .collect()
}

/// Returns the values of an attribute.
pub(crate) fn values<'a>(soup: &'a PolygonSoup, name: &str) -> &'a [f64] {
    &soup
        .attributes
        .iter()
        .find(|attribute| attribute.name == name)
        .unwrap()
        .values
}

/// Everything a soup holds, its numbers as bits: -0 differs from 0 and NaN equals itself.
#[derive(Debug, PartialEq)]
pub(crate) struct Bits {
    positions: Vec<[u64; 3]>,
    faces: Vec<Vec<i64>>,
    attributes: Vec<(String, Vec<u64>)>,
}

/// Returns what a soup holds, to compare.
pub(crate) fn bits(soup: &PolygonSoup) -> Bits {
    let attribute = |a: &VertexAttribute| {
        (
            a.name.clone(),
            a.values.iter().map(|value| value.to_bits()).collect(),
        )
    };
    Bits {
        positions: soup
            .positions
            .iter()
            .map(|p| [p.x, p.y, p.z].map(f64::to_bits))
            .collect(),
        faces: faces(soup),
        attributes: soup.attributes.iter().map(attribute).collect(),
    }
}

/// A surface that owns its parts.
#[derive(Clone, Debug)]
pub(crate) struct Owned {
    pub(crate) positions: Vec<Point3<f64>>,
    pub(crate) faces: Vec<[u32; 3]>,
    pub(crate) attributes: Vec<VertexAttribute>,
}

impl Owned {
    /// Returns the surface to write.
    pub(crate) fn surface(&self) -> Surface<'_> {
        Surface {
            positions: &self.positions,
            faces: &self.faces,
            attributes: &self.attributes,
            ..Surface::default()
        }
    }

    /// Returns the soup that a format which keeps everything reads back.
    pub(crate) fn soup(&self) -> PolygonSoup {
        let mut soup = PolygonSoup::from_triangles(self.positions.clone(), &self.faces);
        soup.attributes.clone_from(&self.attributes);
        soup
    }

    /// Returns the bytes of the file written under this name.
    pub(crate) fn written(&self, name: &str) -> Vec<u8> {
        let (_directory, path) = scratch(name);
        write_surface(&path, &self.surface()).unwrap();
        std::fs::read(&path).unwrap()
    }
}

/// Returns an attribute.
pub(crate) fn attribute(name: &str, values: &[f64]) -> VertexAttribute {
    VertexAttribute {
        name: name.to_owned(),
        values: values.to_vec(),
    }
}

/// Returns a regular tetrahedron with colours and a quality.
pub(crate) fn tetrahedron() -> Owned {
    Owned {
        positions: [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]
            .map(|p| Point3::from(p.map(f64::from)))
            .to_vec(),
        faces: vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]],
        attributes: vec![
            attribute("red", &[255.0, 0.0, 0.0, 10.0]),
            attribute("green", &[0.0, 255.0, 0.0, 20.0]),
            attribute("blue", &[0.0, 0.0, 255.0, 30.0]),
            attribute("quality", &[0.1, -0.0, 1e-310, 7.0]),
        ],
    }
}
