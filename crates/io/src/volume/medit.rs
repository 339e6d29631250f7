//! Medit `.mesh`: text of keywords, each with a count and as many rows of numbers.

use msplines_common::mesh::tet::TetSoup;
use nalgebra::Point3;

use super::cells::refuse;
use super::cursor::Cursor;
use crate::error::{Fault, Place};
use crate::text::quoted;

/// Keywords that are left out, and how many numbers each row has.
const LEFT_OUT: &[(&[u8], usize)] = &[
    (b"Edges", 3),
    (b"EdgesP2", 4),
    (b"Triangles", 4),
    (b"TrianglesP2", 7),
    (b"Quadrilaterals", 5),
    (b"Corners", 1),
    (b"Ridges", 1),
    (b"RequiredVertices", 1),
    (b"RequiredEdges", 1),
    (b"RequiredTriangles", 1),
    (b"RequiredQuadrilaterals", 1),
    (b"RequiredTetrahedra", 1),
    (b"Normals", 3),
    (b"Tangents", 3),
    (b"NormalAtVertices", 2),
    (b"NormalAtTriangleVertices", 3),
    (b"TangentAtVertices", 2),
    (b"TangentAtEdges", 3),
    (b"SubDomainFromGeom", 4),
    (b"SubDomainFromMesh", 4),
];

/// Keywords of solid cells that are refused unless there are none of them.
const REFUSED: &[(&[u8], &str)] = &[
    (b"Hexahedra", "hexahedron"),
    (b"Prisms", "prism"),
    (b"Pentahedra", "prism"),
    (b"Pyramids", "pyramid"),
    (b"TetrahedraP2", "tetrahedron of 10 nodes"),
];

/// Whole number at the start of a binary file, in either byte order.
const BINARY: [[u8; 4]; 2] = [[1, 0, 0, 0], [0, 0, 0, 1]];

fn is_binary(bytes: &[u8]) -> bool {
    bytes
        .first_chunk()
        .is_some_and(|first| BINARY.contains(first))
        // The version follows, a small number, so that a font or picture is not taken for a mesh.
        && bytes.get(4..8).is_some_and(|version| {
            let sum: u32 = version.iter().map(|&b| u32::from(b)).sum();
            (1..=4).contains(&sum)
        })
}

pub(super) fn has_magic(bytes: &[u8]) -> bool {
    is_binary(bytes) || Cursor::new(bytes).uncommented() == Some(b"MeshVersionFormatted")
}

/// Returns the soup of a file; its vertices count from 1.
pub(super) fn parse(bytes: &[u8]) -> Result<TetSoup, Fault> {
    if is_binary(bytes) {
        return Err(Fault::Unsupported {
            place: Place::Byte(0),
            feature: "binary Medit".to_owned(),
            remedy: "save it as text .mesh",
        });
    }
    let mut cursor = Cursor::new(bytes);
    let mut soup = TetSoup::default();
    while let Some(word) = cursor.uncommented() {
        match word {
            b"MeshVersionFormatted" => {
                cursor.integer("the version")?;
            }
            b"Dimension" => {
                let dimension = cursor.integer("the dimension")?;
                if dimension != 3 {
                    return Err(Fault::Unsupported {
                        place: cursor.line_place(),
                        feature: format!("dimension {dimension}"),
                        remedy: "give a mesh in three dimensions",
                    });
                }
            }
            b"Vertices" => read_vertices(&mut cursor, &mut soup)?,
            b"Tetrahedra" => read_tetrahedra(&mut cursor, &mut soup)?,
            b"End" => break,
            other => pass(&mut cursor, other)?,
        }
    }
    Ok(soup)
}

fn read_vertices(cursor: &mut Cursor<'_>, soup: &mut TetSoup) -> Result<(), Fault> {
    let count = cursor.count("the number of vertices", 8)?;
    for vertex in 0..count {
        let mut read = || -> Result<Point3<f64>, Fault> {
            let x = cursor.number("the x coordinate")?;
            let y = cursor.number("the y coordinate")?;
            let z = cursor.number("the z coordinate")?;
            cursor.integer("the reference")?;
            Ok(Point3::new(x, y, z))
        };
        let position = read().map_err(|fault| fault.in_element("vertex", vertex as u64))?;
        soup.positions.push(position);
    }
    Ok(())
}

fn read_tetrahedra(cursor: &mut Cursor<'_>, soup: &mut TetSoup) -> Result<(), Fault> {
    let count = cursor.count("the number of tetrahedra", 10)?;
    for cell in 0..count {
        let mut corners = [0; 4];
        let mut read = || -> Result<(), Fault> {
            for corner in &mut corners {
                *corner = cursor.integer("a vertex index")?.saturating_sub(1);
            }
            cursor.integer("the reference")?;
            Ok(())
        };
        read().map_err(|fault| fault.in_element("tetrahedron", cell as u64))?;
        soup.cells.push(corners);
    }
    Ok(())
}

fn pass(cursor: &mut Cursor<'_>, word: &[u8]) -> Result<(), Fault> {
    if let Some((_, name)) = REFUSED.iter().find(|(keyword, _)| *keyword == word) {
        return match cursor.integer("the number of cells")? {
            0 => Ok(()),
            _ => Err(refuse(cursor.line_place(), name)),
        };
    }
    let Some((_, numbers)) = LEFT_OUT.iter().find(|(keyword, _)| *keyword == word) else {
        let problem = format!("{} is no keyword that is known here", quoted(word));
        return Err(Fault::malformed(cursor.line_place(), problem));
    };
    let rows = cursor.count("the number of rows", 2 * numbers)?;
    for _ in 0..rows * numbers {
        cursor.number("a number")?;
    }
    Ok(())
}
