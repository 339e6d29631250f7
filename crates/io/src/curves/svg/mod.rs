//! The paths of an SVG file as a curve network in the plane z = 0, y upwards.
//!
//! XML is read by `quick-xml`, which writes our VTU files already; `svgtypes` reads path data and
//! transforms. The complete reader of SVG, `usvg`, brings fonts and pictures along and rounds
//! coordinates to single precision, so that curves would no longer meet. Here every transform on the
//! way from the root is applied, in double precision; styles, `use` and units are not, and a shape
//! other than `path`, `line`, `polyline` and `polygon` is refused by name.

mod flatten;
mod path;
mod shape;

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

use super::draft::Draft;
use super::obj::names_crease;
use crate::error::{CORRECT_OR_EXPORT, Fault, Place};
use crate::text::without_mark;

use flatten::flattened;
use shape::{Affine, Stroke, strokes};

/// Elements whose content is not drawn where it stands.
const NOT_DRAWN: &[&str] = &[
    "defs", "clipPath", "marker", "mask", "pattern", "symbol", "metadata", "style", "script",
];

/// Shapes that an editor turns into paths.
const OTHER_SHAPES: &[&str] = &["rect", "circle", "ellipse", "use", "text"];

/// Elements within elements, beyond which a file is no drawing.
const DEEPEST: usize = 256;

/// What holds inside an element.
#[derive(Clone, Copy)]
struct Scope {
    transform: Affine,
    crease: bool,
    drawn: bool,
}

/// Returns the network of a file.
pub(super) fn parse(bytes: &[u8]) -> Result<Draft, Fault> {
    let bytes = without_mark(bytes);
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let place = Place::Line(line_at(bytes, error.valid_up_to()));
        Fault::malformed(place, "the text is not UTF-8")
    })?;
    let mut reader = Reader::from_str(text);
    let mut scopes = vec![Scope {
        transform: Affine::identity(),
        crease: false,
        drawn: true,
    }];
    let mut lines = LineCounter::default();
    let mut found = Vec::new();
    loop {
        let start = reader.buffer_position() as usize;
        let event = reader.read_event().map_err(|error| {
            let place = Place::Line(line_at(bytes, reader.error_position() as usize));
            Fault::malformed(place, format!("this is no XML: {error}"))
        })?;
        match event {
            Event::Eof => break,
            Event::Start(element) => {
                let line = lines.at(bytes, start);
                let scope = enter(&element, scopes[scopes.len() - 1], line, &mut found)?;
                scopes.push(scope);
                if scopes.len() > DEEPEST {
                    let problem = format!("elements are nested more than {DEEPEST} deep");
                    return Err(Fault::malformed(Place::Line(line), problem));
                }
            }
            Event::Empty(element) => {
                let line = lines.at(bytes, start);
                enter(&element, scopes[scopes.len() - 1], line, &mut found)?;
            }
            // The reader has matched the name of the end with that of its start.
            Event::End(_) if scopes.len() > 1 => {
                scopes.pop();
            }
            _ => {}
        }
    }
    if scopes.len() > 1 {
        let place = Place::Line(line_at(bytes, bytes.len()));
        return Err(Fault::truncated(place, "an element is not closed"));
    }
    flattened(&found)
}

/// Returns what holds inside an element, after its own strokes are added to those found.
fn enter(
    element: &BytesStart<'_>,
    outside: Scope,
    line: u64,
    found: &mut Vec<Stroke>,
) -> Result<Scope, Fault> {
    let name = element.local_name().into_inner();
    let mut scope = outside;
    if NOT_DRAWN.contains(&name) {
        scope.drawn = false;
    }
    if !scope.drawn {
        return Ok(scope);
    }
    for key in ["id", "class", "label"] {
        let value = attribute(element, key, line)?;
        scope.crease |= value.is_some_and(|value| names_crease(value.as_bytes()));
    }
    if let Some(transform) = attribute(element, "transform", line)? {
        scope.transform = outside.transform * shape::transform(&transform, line)?;
    }
    if OTHER_SHAPES.contains(&name) {
        return Err(Fault::Unsupported {
            place: Place::Line(line),
            feature: format!("the SVG element `{name}`"),
            remedy: "convert it to a path where it was drawn",
        });
    }
    let value = |key: &str| attribute(element, key, line);
    for mut stroke in strokes(name, &value, line)? {
        stroke.apply(&scope.transform);
        stroke.crease = scope.crease;
        found.push(stroke);
    }
    Ok(scope)
}

/// Returns the value of an attribute, whatever its namespace.
fn attribute(element: &BytesStart<'_>, key: &str, line: u64) -> Result<Option<String>, Fault> {
    let wrong = |error: &dyn std::fmt::Display| {
        Fault::malformed(Place::Line(line), format!("this is no XML: {error}"))
    };
    for attribute in element.attributes() {
        let attribute = attribute.map_err(|error| wrong(&error))?;
        if attribute.key.local_name().into_inner() == key {
            let value = attribute.normalized_value(XmlVersion::Implicit1_0);
            return Ok(Some(value.map_err(|error| wrong(&error))?.into_owned()));
        }
    }
    Ok(None)
}

/// Returns the line of a byte, from 1.
fn line_at(bytes: &[u8], place: usize) -> u64 {
    1 + lines_in(&bytes[..place.min(bytes.len())])
}

/// Counts `\n`, `\r\n` and `\r`, each as one line.
fn lines_in(bytes: &[u8]) -> u64 {
    let ends =
        |i: usize| bytes[i] == b'\n' || (bytes[i] == b'\r' && bytes.get(i + 1) != Some(&b'\n'));
    (0..bytes.len()).filter(|&i| ends(i)).count() as u64
}

/// Counts lines up to places that ascend.
#[derive(Default)]
struct LineCounter {
    place: usize,
    lines: u64,
}

impl LineCounter {
    fn at(&mut self, bytes: &[u8], place: usize) -> u64 {
        self.lines += lines_in(&bytes[self.place..place]);
        self.place = place;
        1 + self.lines
    }
}

/// Returns the fault of an attribute.
fn bad_attribute(line: u64, what: &str, error: &svgtypes::Error) -> Fault {
    Fault::Malformed {
        place: Place::Line(line),
        problem: format!("{what} cannot be read: {error}"),
        remedy: CORRECT_OR_EXPORT,
    }
}
