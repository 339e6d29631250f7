//! OBJ: vertices and polygons.
//!
//! The parser is our own. The `tobj` library numbers vertices anew by first use, one group at a
//! time, and so loses the file's order and its unused vertices; it refuses an index out of range,
//! and its errors tell no line. A surface written "for every input vertex, in input order" needs
//! all four. The tests read with both.

use std::borrow::Cow;
use std::io::{self, Write};

use msplines_common::mesh::{PolygonSoup, VertexAttribute};
use nalgebra::Point3;

use crate::error::Fault;
use crate::output::Surface;
use crate::text::{self, Lines, Words, quoted};

/// Statements of the format that say nothing about vertices and polygons.
const PASSED_OVER: &[&str] = &[
    "vt",
    "vn",
    "vp",
    "g",
    "o",
    "s",
    "mg",
    "l",
    "p",
    "usemtl",
    "mtllib",
    "usemap",
    "maplib",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
    "cstype",
    "deg",
    "bmat",
    "step",
    "curv",
    "curv2",
    "surf",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "call",
    "csh",
];

/// Returns the soup of an OBJ file.
///
/// Indices become zero-based: positive ones count from the file's first vertex, negative ones back
/// from the latest. One that points before the first vertex (0 does) stays negative. Colours after
/// the coordinates become `red`, `green`, `blue` if every vertex has them.
pub(crate) fn parse(bytes: &[u8]) -> Result<PolygonSoup, Fault> {
    let mut soup = PolygonSoup {
        face_offsets: vec![0],
        ..PolygonSoup::default()
    };
    let mut colours = Vec::new();
    let mut lines = Lines::new(bytes);
    while let Some(line) = next_statement(&mut lines) {
        let mut words = Words::new(&line, lines.number());
        match words.next() {
            None => {}
            Some(b"v") => read_vertex(words, &mut soup, &mut colours)?,
            Some(b"f" | b"fo") => read_face(words, &mut soup)?,
            Some(word) if PASSED_OVER.iter().any(|known| known.as_bytes() == word) => {}
            Some(word) => {
                let problem = format!("{} is no OBJ statement", quoted(word));
                return Err(Fault::malformed(words.place(), problem));
            }
        }
    }
    if !colours.is_empty() && colours.len() == soup.positions.len() {
        for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
            let values = colours.iter().map(|colour| colour[channel]).collect();
            soup.attributes.push(VertexAttribute {
                name: name.to_owned(),
                values,
            });
        }
    }
    Ok(soup)
}

/// Returns the next line without its comment, joined with the lines it continues on.
pub(crate) fn next_statement<'a>(lines: &mut Lines<'a>) -> Option<Cow<'a, [u8]>> {
    let mut statement = Cow::Borrowed(without_comment(lines.next()?));
    while let Some(kept) = statement.trim_ascii_end().strip_suffix(b"\\") {
        let length = kept.len();
        let mut joined = statement.into_owned();
        joined.truncate(length);
        joined.push(b' ');
        joined.extend_from_slice(without_comment(lines.next().unwrap_or_default()));
        statement = Cow::Owned(joined);
    }
    Some(statement)
}

fn without_comment(line: &[u8]) -> &[u8] {
    line.split(|&b| b == b'#').next().unwrap_or_default()
}

fn read_vertex(
    mut words: Words<'_>,
    soup: &mut PolygonSoup,
    colours: &mut Vec<[f64; 3]>,
) -> Result<(), Fault> {
    let x = words.number("the x coordinate")?;
    let y = words.number("the y coordinate")?;
    let z = words.number("the z coordinate")?;
    soup.positions.push(Point3::new(x, y, z));
    // One further number is a weight, which polygons have no use for; three or more are a colour.
    if words.clone().count() >= 3 {
        let red = words.number("the red colour")?;
        let green = words.number("the green colour")?;
        colours.push([red, green, words.number("the blue colour")?]);
    }
    Ok(())
}

fn read_face(words: Words<'_>, soup: &mut PolygonSoup) -> Result<(), Fault> {
    let vertices = soup.positions.len() as i64;
    let place = words.place();
    for word in words {
        let index = word.split(|&b| b == b'/').next().unwrap_or_default();
        let index = text::integer(index, "a vertex index", || place.clone())?;
        let zero_based = if index < 0 {
            index.saturating_add(vertices)
        } else {
            index - 1
        };
        soup.face_vertices.push(zero_based);
    }
    soup.face_offsets.push(soup.face_vertices.len());
    Ok(())
}

/// Writes positions and faces. Coordinates have as many digits as it takes to read the same
/// doubles back. Attributes are left out: the format has no place for them.
pub(crate) fn write(surface: &Surface<'_>, to: &mut dyn Write) -> io::Result<()> {
    for p in surface.positions {
        writeln!(to, "v {:?} {:?} {:?}", p.x, p.y, p.z)?;
    }
    for &[a, b, c] in surface.faces {
        writeln!(
            to,
            "f {} {} {}",
            u64::from(a) + 1,
            u64::from(b) + 1,
            u64::from(c) + 1
        )?;
    }
    Ok(())
}
