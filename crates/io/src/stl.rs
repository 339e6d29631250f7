//! STL: text and binary triangles.
//!
//! The parser is our own. The `stl_io` library reads text coordinates in single precision, tells no
//! place of a fault, and looks at the first word only to tell text from binary, where many a binary
//! file begins with `solid`. The tests read with both.

use msplines_common::mesh::PolygonSoup;
use nalgebra::Point3;

use crate::error::{Fault, Place};
use crate::text::{Lines, Words, quoted, without_mark};

const HEADER_BYTES: usize = 84;
const TRIANGLE_BYTES: usize = 50;

/// Returns whether a file is a binary STL file by its length, or starts like a text one.
pub(crate) fn has_magic(bytes: &[u8]) -> bool {
    has_binary_length(bytes) || is_text(bytes)
}

fn has_binary_length(bytes: &[u8]) -> bool {
    announced(bytes).is_some_and(|triangles| {
        triangles > 0 && (bytes.len() - HEADER_BYTES) as u64 == triangles * TRIANGLE_BYTES as u64
    })
}

fn announced(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(HEADER_BYTES - 4..)?.first_chunk()?;
    Some(u64::from(u32::from_le_bytes(*count)))
}

/// Tells text by its first word and by what makes no sense in text being absent near the start.
fn is_text(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(HEADER_BYTES)];
    let first = Words::new(without_mark(start), 1)
        .next()
        .unwrap_or_default();
    first.eq_ignore_ascii_case(b"solid") && !start.contains(&0)
}

/// Returns the soup of an STL file: its triangles in order, over positions that are all different.
///
/// An STL file repeats the position of a vertex in every triangle. Exactly equal positions become
/// one vertex (+0 and -0 are equal), numbered by first use. Normals are left: they follow from the
/// triangles.
pub(crate) fn parse(bytes: &[u8]) -> Result<PolygonSoup, Fault> {
    let corners = if !has_binary_length(bytes) && is_text(bytes) {
        parse_text(bytes)?
    } else {
        parse_binary(bytes)?
    };
    Ok(merge(&corners))
}

fn parse_binary(bytes: &[u8]) -> Result<Vec<Point3<f64>>, Fault> {
    let Some(triangles) = announced(bytes) else {
        let problem = format!("it has {} bytes, the header alone takes 84", bytes.len());
        return Err(Fault::truncated(Place::Byte(bytes.len() as u64), problem));
    };
    let body = &bytes[HEADER_BYTES..];
    let (records, rest) = body.as_chunks::<TRIANGLE_BYTES>();
    let problem = format!(
        "{triangles} triangles are announced, {} are there",
        records.len()
    );
    if (records.len() as u64) < triangles {
        return Err(Fault::truncated(Place::Byte(bytes.len() as u64), problem));
    }
    if records.len() as u64 > triangles || !rest.is_empty() {
        let problem = format!("{problem} and {} further bytes", rest.len());
        return Err(Fault::malformed(
            Place::Byte(HEADER_BYTES as u64 - 4),
            problem,
        ));
    }
    let mut corners = Vec::with_capacity(3 * records.len());
    for record in records {
        // A normal of three numbers stands before the corners.
        let (numbers, _) = record[12..48].as_chunks::<4>();
        let number = |i: usize| f64::from(f32::from_le_bytes(numbers[i]));
        corners.extend((0..3).map(|c| Point3::from([0, 1, 2].map(|axis| number(3 * c + axis)))));
    }
    Ok(corners)
}

fn parse_text(bytes: &[u8]) -> Result<Vec<Point3<f64>>, Fault> {
    let mut corners = Vec::new();
    let mut ended = true;
    let mut lines = Lines::new(bytes);
    while let Some(line) = lines.next() {
        let mut words = Words::new(line, lines.number());
        let Some(word) = words.next() else { continue };
        let triangle = (corners.len() / 3) as u64;
        match word.to_ascii_lowercase().as_slice() {
            b"solid" => ended = false,
            b"endsolid" => ended = true,
            b"facet" | b"outer" | b"endloop" => {}
            b"vertex" => {
                let corner = read_corner(words);
                corners.push(corner.map_err(|fault| fault.in_element("triangle", triangle))?);
            }
            b"endfacet" if corners.len() % 3 == 0 => {}
            b"endfacet" => {
                let fault = Fault::malformed(words.place(), "a facet has not three vertices");
                return Err(fault.in_element("triangle", triangle));
            }
            _ => {
                let problem = format!("{} is no STL statement", quoted(word));
                return Err(Fault::malformed(words.place(), problem));
            }
        }
    }
    if ended && corners.len() % 3 == 0 {
        return Ok(corners);
    }
    Err(Fault::truncated(lines.place(), "`endsolid` is missing"))
}

fn read_corner(mut words: Words<'_>) -> Result<Point3<f64>, Fault> {
    let x = words.number("the x coordinate")?;
    let y = words.number("the y coordinate")?;
    Ok(Point3::new(x, y, words.number("the z coordinate")?))
}

/// Returns the triangles of `corners` over their distinct positions, in order of first use.
fn merge(corners: &[Point3<f64>]) -> PolygonSoup {
    // Adding zero turns -0 into +0 and changes nothing else; NaN equals only its own bits.
    let key = |corner: u32| corners[corner as usize].coords.map(|x| (x + 0.0).to_bits());
    let key = |corner: u32| <[u64; 3]>::from(key(corner));
    let mut order: Vec<u32> = (0..corners.len() as u32).collect();
    order.sort_unstable_by_key(|&corner| (key(corner), corner));
    let mut first_uses: Vec<u32> = (0..corners.len() as u32).collect();
    for group in order.chunk_by(|&a, &b| key(a) == key(b)) {
        for &corner in group {
            first_uses[corner as usize] = group[0];
        }
    }
    let mut soup = PolygonSoup {
        face_offsets: vec![0],
        ..PolygonSoup::default()
    };
    let mut ids = vec![0; corners.len()];
    for (corner, &first) in first_uses.iter().enumerate() {
        if first as usize == corner {
            ids[corner] = soup.positions.len() as i64;
            soup.positions.push(corners[corner]);
        }
        soup.face_vertices.push(ids[first as usize]);
    }
    soup.face_offsets
        .extend((1..=corners.len() / 3).map(|triangle| 3 * triangle));
    soup
}
