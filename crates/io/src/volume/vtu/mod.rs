//! VTU: VTK's XML file of an unstructured grid.
//!
//! Arrays are words, base64 text, or stand in one appended block that is base64 text or raw bytes;
//! bytes may be compressed by zlib. What is appended raw is no XML, so that only the text before it
//! is read as such.

mod array;

use msplines_common::mesh::tet::TetSoup;
use nalgebra::Point3;
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

use self::array::{Appended, Form, Layout, Numbers, decode};
use super::cursor::Cursor;
use super::vtk::Cells;
use crate::error::{Fault, Place};
use crate::text::{quoted, without_mark};

pub(crate) fn has_magic(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(4096)];
    start.windows(8).any(|window| window == b"<VTKFile")
}

/// An array as the file describes it.
struct Described {
    name: String,
    layout: Layout,
    text: Vec<u8>,
    line: u64,
}

/// Arrays of one piece of a grid.
#[derive(Default)]
struct Piece {
    points: Option<Described>,
    cells: Vec<Described>,
}

/// Which part of a piece an array stands in.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    Points,
    Cells,
    Other,
}

pub(super) fn parse(bytes: &[u8]) -> Result<TetSoup, Fault> {
    let bytes = without_mark(bytes);
    let (text, appended) = Appended::split(bytes)?;
    let (form, pieces) = describe(text)?;
    let mut soup = TetSoup::default();
    let most = 32 * bytes.len();
    for piece in &pieces {
        let read = |array: &Described| -> Result<Numbers, Fault> {
            decode(&array.layout, form, &array.text, &appended, most).map_err(|problem| {
                Fault::malformed(
                    Place::Line(array.line),
                    format!("array {}: {problem}", quoted(array.name.as_bytes())),
                )
            })
        };
        let Some(points) = &piece.points else {
            continue;
        };
        let first = soup.positions.len();
        let coordinates = read(points)?.into_doubles();
        let points = coordinates.chunks_exact(3);
        soup.positions
            .extend(points.map(|p| Point3::new(p[0], p[1], p[2])));
        let mut cells = Cells::default();
        for array in &piece.cells {
            match array.name.as_str() {
                "connectivity" => cells.connectivity = read(array)?.into_integers(),
                "offsets" => cells.ends = read(array)?.into_integers(),
                "types" => {
                    let types = read(array)?.into_integers();
                    cells.types = types.into_iter().map(|x| x as u64).collect();
                }
                _ => {}
            }
        }
        cells.add_to(&mut soup, first, &Cursor::new(text))?;
    }
    Ok(soup)
}

/// Returns how numbers are written and the arrays of all pieces.
fn describe(text: &[u8]) -> Result<(Form, Vec<Piece>), Fault> {
    let utf8 = std::str::from_utf8(text).map_err(|error| {
        let valid = &text[..error.valid_up_to()];
        let line = valid.iter().filter(|&&b| b == b'\n').count() as u64 + 1;
        Fault::malformed(Place::Line(line), "the text is not UTF-8")
    })?;
    let mut reader = Reader::from_str(utf8);
    // The element that holds what is appended has no end in this text.
    reader.config_mut().check_end_names = false;
    let (mut form, mut pieces) = (Form::default(), Vec::<Piece>::new());
    let (mut part, mut open) = (Part::Other, None);
    // Elements that are open inside of an array: what they hold is told about it, not in it.
    let mut inside = 0;
    let mut lines = Lines {
        text,
        at: 0,
        line: 1,
    };
    loop {
        let line = lines.at(reader.buffer_position() as usize);
        let event = reader.read_event().map_err(|error| {
            Fault::malformed(Place::Line(line), format!("this is no XML: {error}"))
        })?;
        match event {
            Event::Eof => break,
            Event::Start(element) | Event::Empty(element)
                if element.name().as_ref() == "VTKFile" =>
            {
                form = read_form(&element, line)?;
            }
            Event::Start(_) if open.is_some() => inside += 1,
            Event::Start(element) => match element.name().as_ref() {
                "Piece" => pieces.push(Piece::default()),
                "Points" => part = Part::Points,
                "Cells" => part = Part::Cells,
                "PointData" | "CellData" | "FieldData" => part = Part::Other,
                "DataArray" => open = Some(read_array(&element, line)?),
                _ => {}
            },
            Event::Empty(element) if element.name().as_ref() == "DataArray" => {
                let array = read_array(&element, line)?;
                keep(array, part, &mut pieces);
            }
            Event::Text(content) if part != Part::Other && inside == 0 => {
                if let Some(array) = &mut open {
                    array.text.extend_from_slice(content.as_bytes());
                }
            }
            Event::End(_) if inside > 0 => inside -= 1,
            Event::End(element) => match element.name().as_ref() {
                "DataArray" => open
                    .take()
                    .into_iter()
                    .for_each(|array| keep(array, part, &mut pieces)),
                "Points" | "Cells" | "PointData" | "CellData" | "FieldData" => part = Part::Other,
                _ => {}
            },
            _ => {}
        }
    }
    Ok((form, pieces))
}

fn keep(array: Described, part: Part, pieces: &mut [Piece]) {
    match (part, pieces.last_mut()) {
        (Part::Points, Some(piece)) => piece.points = Some(array),
        (Part::Cells, Some(piece)) => piece.cells.push(array),
        _ => {}
    }
}

/// Counts lines as the reader goes on.
struct Lines<'a> {
    text: &'a [u8],
    at: usize,
    line: u64,
}

impl Lines<'_> {
    fn at(&mut self, place: usize) -> u64 {
        let place = place.min(self.text.len());
        let passed = &self.text[self.at..place];
        self.line += passed.iter().filter(|&&b| b == b'\n').count() as u64;
        self.at = place;
        self.line
    }
}

fn attribute(element: &BytesStart<'_>, key: &str, line: u64) -> Result<Option<String>, Fault> {
    let wrong = |error: &dyn std::fmt::Display| {
        Fault::malformed(Place::Line(line), format!("this is no XML: {error}"))
    };
    for attribute in element.attributes() {
        let attribute = attribute.map_err(|error| wrong(&error))?;
        if attribute.key.into_inner() == key {
            let value = attribute.normalized_value(XmlVersion::Implicit1_0);
            return Ok(Some(value.map_err(|error| wrong(&error))?.into_owned()));
        }
    }
    Ok(None)
}

fn read_form(element: &BytesStart<'_>, line: u64) -> Result<Form, Fault> {
    let unsupported = |feature: String, remedy| Fault::Unsupported {
        place: Place::Line(line),
        feature,
        remedy,
    };
    match attribute(element, "type", line)?.as_deref() {
        Some("UnstructuredGrid") => {}
        other => {
            let kind = quoted(other.unwrap_or_default().as_bytes());
            return Err(unsupported(
                format!("a file of type {kind}"),
                "give an unstructured grid",
            ));
        }
    }
    let compressed = match attribute(element, "compressor", line)?.as_deref() {
        None | Some("") => false,
        Some("vtkZLibDataCompressor") => true,
        Some(other) => {
            let feature = format!("the compressor {}", quoted(other.as_bytes()));
            return Err(unsupported(feature, "save it uncompressed or with zlib"));
        }
    };
    let big_endian = attribute(element, "byte_order", line)?.as_deref() == Some("BigEndian");
    let wide_header = attribute(element, "header_type", line)?.as_deref() == Some("UInt64");
    Ok(Form {
        compressed,
        big_endian,
        wide_header,
    })
}

fn read_array(element: &BytesStart<'_>, line: u64) -> Result<Described, Fault> {
    let malformed = |problem: String| Fault::malformed(Place::Line(line), problem);
    let name = attribute(element, "Name", line)?.unwrap_or_default();
    let kind = attribute(element, "type", line)?.unwrap_or_default();
    let format = attribute(element, "format", line)?.unwrap_or_else(|| "ascii".to_owned());
    let offset =
        match attribute(element, "offset", line)? {
            Some(offset) if format == "appended" => {
                let read = offset.parse();
                Some(read.map_err(|_| {
                    malformed(format!("the offset is {}", quoted(offset.as_bytes())))
                })?)
            }
            _ => None,
        };
    let layout = Layout::build(&kind, &format, offset).map_err(malformed)?;
    Ok(Described {
        name,
        layout,
        text: Vec::new(),
        line,
    })
}
