//! OBJ: vertices and polygons.
//!
//! The parser is our own. The `tobj` library numbers vertices anew by first use, one group at a
//! time, and so loses the file's order and its unused vertices; it refuses an index out of range,
//! and its errors tell no line. A surface written "for every input vertex, in input order" needs
//! all four. The tests read with both.

use std::borrow::Cow;
use std::io::{self, Write};

use msplines_common::mesh::{PolygonSoup, VertexAttribute};
use nalgebra::{Point3, Vector3};

use crate::error::Fault;
use crate::output::{Surface, Wedges};
use crate::text::{self, Lines, Words, quoted};

/// Statements of the format that say nothing about vertices and polygons.
const PASSED_OVER: &[&str] = &[
    "vt",
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

/// What has been read.
struct Draft {
    soup: PolygonSoup,
    colours: Vec<[f64; 3]>,
    normals: Vec<Vector3<f64>>,
    /// Normal of each corner, as far as any corner named one.
    corner_normals: Vec<i64>,
}

/// A corner that names no normal.
const NO_NORMAL: i64 = -1;
/// A vertex whose corners name several.
const SEVERAL_NORMALS: i64 = -2;

/// Returns the soup of an OBJ file.
///
/// Indices become zero-based: positive ones count from the file's first vertex, negative ones back
/// from the latest. One that points before the first vertex (0 does) stays negative. Colours after
/// the coordinates become `red`, `green`, `blue` if every vertex has them. Normals become `nx`, `ny`,
/// `nz`: of a vertex the one that its corners name, or the mean of unit length of those; zero where none
/// of them names one that is there; and where no corner at all names one but there are as many as
/// vertices, those in order.
pub(crate) fn parse(bytes: &[u8]) -> Result<PolygonSoup, Fault> {
    let mut draft = Draft {
        soup: PolygonSoup {
            face_offsets: vec![0],
            ..PolygonSoup::default()
        },
        colours: Vec::new(),
        normals: Vec::new(),
        corner_normals: Vec::new(),
    };
    let mut lines = Lines::new(bytes);
    while let Some(line) = next_statement(&mut lines) {
        let mut words = Words::new(&line, lines.number());
        match words.next() {
            None => {}
            Some(b"v") => draft.read_vertex(words)?,
            Some(b"vn") => draft.read_normal(words)?,
            Some(b"f" | b"fo") => draft.read_face(words)?,
            Some(word) if PASSED_OVER.iter().any(|known| known.as_bytes() == word) => {}
            Some(word) => {
                let problem = format!("{} is no OBJ statement", quoted(word));
                return Err(Fault::malformed(words.place(), problem));
            }
        }
    }
    Ok(draft.finish())
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

impl Draft {
    fn read_vertex(&mut self, mut words: Words<'_>) -> Result<(), Fault> {
        let x = words.number("the x coordinate")?;
        let y = words.number("the y coordinate")?;
        let z = words.number("the z coordinate")?;
        self.soup.positions.push(Point3::new(x, y, z));
        // One further number is a weight, which polygons have no use for; three or more are a colour.
        if words.clone().count() >= 3 {
            let red = words.number("the red colour")?;
            let green = words.number("the green colour")?;
            self.colours
                .push([red, green, words.number("the blue colour")?]);
        }
        Ok(())
    }

    fn read_normal(&mut self, mut words: Words<'_>) -> Result<(), Fault> {
        let x = words.number("the x component of a normal")?;
        let y = words.number("the y component of a normal")?;
        let z = words.number("the z component of a normal")?;
        self.normals.push(Vector3::new(x, y, z));
        Ok(())
    }

    fn read_face(&mut self, words: Words<'_>) -> Result<(), Fault> {
        let (vertices, normals) = (self.soup.positions.len(), self.normals.len());
        let place = words.place();
        for word in words {
            let mut parts = word.split(|&b| b == b'/');
            let index = parts.next().unwrap_or_default();
            let index = text::integer(index, "a vertex index", || place.clone())?;
            if let Some(normal) = parts.nth(1).filter(|part| !part.is_empty()) {
                let normal = text::integer(normal, "a normal index", || place.clone())?;
                // Corners before this one name none.
                self.corner_normals
                    .resize(self.soup.face_vertices.len(), NO_NORMAL);
                self.corner_normals.push(zero_based(normal, normals));
            }
            self.soup.face_vertices.push(zero_based(index, vertices));
        }
        self.soup.face_offsets.push(self.soup.face_vertices.len());
        Ok(())
    }

    fn finish(mut self) -> PolygonSoup {
        if let Some(normals) = self.vertex_normals() {
            for (axis, name) in ["nx", "ny", "nz"].into_iter().enumerate() {
                self.push_attribute(name, normals.iter().map(|normal| normal[axis]).collect());
            }
        }
        if !self.colours.is_empty() && self.colours.len() == self.soup.positions.len() {
            let colours = std::mem::take(&mut self.colours);
            for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
                self.push_attribute(name, colours.iter().map(|colour| colour[channel]).collect());
            }
        }
        self.soup
    }

    fn push_attribute(&mut self, name: &str, values: Vec<f64>) {
        let name = name.to_owned();
        self.soup.attributes.push(VertexAttribute { name, values });
    }

    fn vertex_normals(&self) -> Option<Vec<Vector3<f64>>> {
        let vertices = self.soup.positions.len();
        if self.corner_normals.is_empty() {
            let are_as_many = !self.normals.is_empty() && self.normals.len() == vertices;
            return are_as_many.then(|| self.normals.clone());
        }
        let mut named = vec![NO_NORMAL; vertices];
        let mut sums = vec![Vector3::zeros(); vertices];
        for (&vertex, &index) in self.soup.face_vertices.iter().zip(&self.corner_normals) {
            let vertex = usize::try_from(vertex).ok().filter(|&v| v < vertices);
            let normal = usize::try_from(index)
                .ok()
                .and_then(|i| self.normals.get(i));
            let (Some(vertex), Some(normal)) = (vertex, normal) else {
                continue;
            };
            sums[vertex] += normal.try_normalize(0.0).unwrap_or_default();
            named[vertex] = match named[vertex] {
                NO_NORMAL => index,
                before if before == index => index,
                _ => SEVERAL_NORMALS,
            };
        }
        let mean = |sum: Vector3<f64>| sum.try_normalize(0.0).unwrap_or_default();
        let pairs = named.into_iter().zip(sums);
        let normals = pairs.map(|(index, sum)| match usize::try_from(index) {
            Ok(index) => self.normals[index],
            Err(_) => mean(sum),
        });
        Some(normals.collect())
    }
}

/// Returns an index of the file counted from zero; negative ones count back from `count`.
fn zero_based(index: i64, count: usize) -> i64 {
    if index < 0 {
        index.saturating_add(count as i64)
    } else {
        index - 1
    }
}

/// Writes positions, normals, texture coordinates and faces. Numbers have as many digits as it takes
/// to read the same doubles back. Attributes are left out: the format has no place for them.
pub(crate) fn write(surface: &Surface<'_>, to: &mut dyn Write) -> io::Result<()> {
    for p in surface.positions {
        writeln!(to, "v {:?} {:?} {:?}", p.x, p.y, p.z)?;
    }
    for n in surface.normals.unwrap_or_default() {
        writeln!(to, "vn {:?} {:?} {:?}", n.x, n.y, n.z)?;
    }
    let texture = surface.corner_texture;
    let wedges = texture.map(|t| Wedges::build(surface.positions.len(), surface.faces, t));
    for [u, v] in wedges.iter().flat_map(|wedges| &wedges.texture) {
        writeln!(to, "vt {u:?} {v:?}")?;
    }
    for (index, face) in surface.faces.iter().enumerate() {
        write!(to, "f")?;
        for (corner, &vertex) in face.iter().enumerate() {
            let vertex = u64::from(vertex) + 1;
            let texture = wedges.as_ref().map(|w| w.faces[index][corner] + 1);
            match (texture, surface.normals) {
                (None, None) => write!(to, " {vertex}")?,
                (None, Some(_)) => write!(to, " {vertex}//{vertex}")?,
                (Some(texture), None) => write!(to, " {vertex}/{texture}")?,
                (Some(texture), Some(_)) => write!(to, " {vertex}/{texture}/{vertex}")?,
            }
        }
        writeln!(to)?;
    }
    Ok(())
}
