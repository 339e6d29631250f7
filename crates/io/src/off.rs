//! OFF: text files of vertices and polygons, also with normals, colours or texture coordinates.
//!
//! The parser is our own, for want of a library with a release in recent years.

use msplines_common::mesh::{PolygonSoup, VertexAttribute};
use nalgebra::Point3;

use crate::error::Fault;
use crate::text::{self, Lines, Words, quoted};

/// The words a file may begin with.
const MAGIC: &[&str] = &[
    "OFF", "COFF", "NOFF", "CNOFF", "STOFF", "STCOFF", "STNOFF", "STCNOFF",
];

/// Returns whether a file starts like an OFF file.
pub(crate) fn has_magic(bytes: &[u8]) -> bool {
    let first = Lines::new(bytes)
        .next_with_words()
        .and_then(|mut words| words.next());
    first.is_some_and(|word| is_magic(word) || is_other_dimension(word))
}

fn is_magic(word: &[u8]) -> bool {
    MAGIC.iter().any(|magic| magic.as_bytes() == word)
}

/// Tells the forms with homogeneous or n-dimensional positions.
fn is_other_dimension(word: &[u8]) -> bool {
    word.strip_suffix(b"OFF").is_some_and(|prefix| {
        prefix.last().is_some_and(|b| matches!(b, b'4' | b'n'))
            && prefix.iter().all(|b| b"STCN4n".contains(b))
    })
}

/// Returns the soup of an OFF file.
///
/// Vertex data beyond the position becomes attributes: `nx`, `ny`, `nz`; `red`, `green`, `blue`
/// and, where there are four, `alpha`; `s`, `t`; as the file scales them. Face colours are left.
pub(crate) fn parse(bytes: &[u8]) -> Result<PolygonSoup, Fault> {
    let mut lines = Lines::new(bytes);
    let (kind, [vertices, faces]) = parse_header(&mut lines)?;
    let mut soup = PolygonSoup {
        face_offsets: vec![0],
        ..PolygonSoup::default()
    };
    check_room(&lines, vertices, 6, "vertices")?;
    for vertex in 0..vertices {
        let Some(words) = lines.next_with_words() else {
            return Err(missing(&lines, "vertices", vertices, vertex));
        };
        let read = read_vertex(words, &kind, &mut soup);
        read.map_err(|fault| fault.in_element("vertex", vertex))?;
    }
    check_room(&lines, faces, 2, "faces")?;
    for face in 0..faces {
        let Some(words) = lines.next_with_words() else {
            return Err(missing(&lines, "faces", faces, face));
        };
        read_face(words, &mut soup).map_err(|fault| fault.in_element("face", face))?;
    }
    Ok(soup)
}

/// What each vertex line holds after the position.
struct Kind {
    normals: bool,
    colours: bool,
    texture: bool,
}

fn parse_header(lines: &mut Lines<'_>) -> Result<(Kind, [u64; 2]), Fault> {
    let mut words = lines.next_with_words().unwrap_or(Words::new(b"", 1));
    let magic = words.next().unwrap_or_default();
    if is_other_dimension(magic) {
        return Err(Fault::Unsupported {
            place: words.place(),
            feature: format!("the form {}", quoted(magic)),
            remedy: "save it with three coordinates per vertex",
        });
    }
    if !is_magic(magic) {
        return Err(Fault::malformed(
            words.place(),
            "the first word is not `OFF`",
        ));
    }
    let has = |letter| {
        magic
            .strip_suffix(b"OFF")
            .is_some_and(|prefix| prefix.contains(&letter))
    };
    let kind = Kind {
        normals: has(b'N'),
        colours: has(b'C'),
        texture: has(b'T'),
    };
    // The counts follow on the same line or on the next.
    if words.clone().next().is_none() {
        match lines.next_with_words() {
            Some(next) => words = next,
            None => return Err(Fault::truncated(lines.place(), "the counts are missing")),
        }
    }
    if words.clone().next() == Some(b"BINARY") {
        return Err(Fault::Unsupported {
            place: words.place(),
            feature: "binary OFF".to_owned(),
            remedy: "save it as text, or as binary PLY",
        });
    }
    let vertices = count(&mut words, "the number of vertices")?;
    Ok((kind, [vertices, count(&mut words, "the number of faces")?]))
}

fn count(words: &mut Words<'_>, what: &str) -> Result<u64, Fault> {
    let count = words.integer(what)?;
    u64::try_from(count).map_err(|_| Fault::malformed(words.place(), format!("{what} is {count}")))
}

/// Refuses counts the rest of the file cannot hold, before anything is done for them.
fn check_room(lines: &Lines<'_>, claimed: u64, least: usize, what: &str) -> Result<(), Fault> {
    let room = ((lines.rest().len() + 1) / least) as u64;
    if claimed <= room {
        return Ok(());
    }
    let problem = format!("{claimed} {what} are announced, there is room for at most {room}");
    Err(Fault::truncated(lines.place(), problem))
}

fn missing(lines: &Lines<'_>, what: &str, claimed: u64, found: u64) -> Fault {
    let problem = format!("{claimed} {what} are announced, {found} are there");
    Fault::truncated(lines.place(), problem)
}

fn read_vertex(mut words: Words<'_>, kind: &Kind, soup: &mut PolygonSoup) -> Result<(), Fault> {
    let x = words.number("the x coordinate")?;
    let y = words.number("the y coordinate")?;
    soup.positions
        .push(Point3::new(x, y, words.number("the z coordinate")?));
    if soup.positions.len() == 1 {
        soup.attributes = attributes(kind, words.clone().count());
    }
    for attribute in &mut soup.attributes {
        attribute.values.push(words.number(&attribute.name)?);
    }
    Ok(())
}

/// Returns empty attributes for the numbers after the position, of which the first vertex has
/// `further`: colours have three or four components, and only the line tells.
fn attributes(kind: &Kind, further: usize) -> Vec<VertexAttribute> {
    let mut names = Vec::new();
    let texture: &[&str] = if kind.texture { &["s", "t"] } else { &[] };
    if kind.normals {
        names.extend(["nx", "ny", "nz"]);
    }
    if kind.colours {
        names.extend(["red", "green", "blue"]);
        if further > names.len() + texture.len() {
            names.push("alpha");
        }
    }
    names.extend(texture);
    let empty = |name: &str| VertexAttribute {
        name: name.to_owned(),
        values: Vec::new(),
    };
    names.into_iter().map(empty).collect()
}

fn read_face(mut words: Words<'_>, soup: &mut PolygonSoup) -> Result<(), Fault> {
    let corners = count(&mut words, "the number of corners")?;
    for corner in 0..corners {
        let Some(word) = words.next() else {
            let problem = format!("{corners} corners are announced, {corner} are there");
            return Err(Fault::malformed(words.place(), problem));
        };
        soup.face_vertices
            .push(text::integer(word, "a vertex index", || words.place())?);
    }
    soup.face_offsets.push(soup.face_vertices.len());
    Ok(())
}
