//! VTK's legacy file of an unstructured grid, text and binary.

use msplines_common::mesh::tet::TetSoup;
use nalgebra::Point3;

use super::cells::{Kind, refuse, vtk_kind};
use super::cursor::Cursor;
use crate::error::Fault;
use crate::text::quoted;

pub(crate) fn has_magic(bytes: &[u8]) -> bool {
    bytes.starts_with(b"# vtk DataFile")
}

/// Cells as arrays, from either form of the file.
#[derive(Default)]
pub(super) struct Cells {
    /// Vertices of all cells.
    pub(super) connectivity: Vec<i64>,
    /// Where the vertices of each cell end.
    pub(super) ends: Vec<i64>,
    /// Type of each cell.
    pub(super) types: Vec<u64>,
}

impl Cells {
    /// Appends the tetrahedra, their vertices counted from `first`, to a soup.
    pub(super) fn add_to(
        &self,
        soup: &mut TetSoup,
        first: usize,
        cursor: &Cursor<'_>,
    ) -> Result<(), Fault> {
        let malformed = |problem: String| Fault::malformed(cursor.line_place(), problem);
        if self.types.len() != self.ends.len() {
            let (types, ends) = (self.types.len(), self.ends.len());
            return Err(malformed(format!(
                "{types} types are given for {ends} cells"
            )));
        }
        let mut start = 0;
        for (cell, (&number, &end)) in self.types.iter().zip(&self.ends).enumerate() {
            let range = usize::try_from(start).ok().zip(usize::try_from(end).ok());
            let corners = range.and_then(|(start, end)| self.connectivity.get(start..end));
            let Some(corners) = corners else {
                let problem = format!(
                    "cell {cell} has vertices {start} to {end} of the list, which are not there"
                );
                return Err(malformed(problem));
            };
            start = end;
            match vtk_kind(number) {
                Some(Kind::Lower) => {}
                Some(Kind::Tetrahedron) => {
                    let Ok(corners) = <[i64; 4]>::try_from(corners) else {
                        let count = corners.len();
                        return Err(malformed(format!(
                            "tetrahedron {cell} has {count} vertices"
                        )));
                    };
                    let shifted = corners.map(|v| v.saturating_add(first as i64));
                    // An index of another piece must not become one of this.
                    let bad = corners.iter().any(|&v| v < 0);
                    soup.cells.push(if bad { corners } else { shifted });
                }
                Some(Kind::Other(name)) => {
                    let fault = refuse(cursor.line_place(), name);
                    return Err(fault.in_element("cell", cell as u64));
                }
                None => {
                    return Err(malformed(format!(
                        "cell {cell} is of unknown type {number}"
                    )));
                }
            }
        }
        Ok(())
    }
}

/// Whether arrays are words or bytes.
#[derive(Clone, Copy, PartialEq)]
enum Coding {
    Text,
    Binary,
}

pub(super) fn parse(bytes: &[u8]) -> Result<TetSoup, Fault> {
    let mut cursor = Cursor::new(bytes);
    cursor.line();
    cursor.line();
    let coding = match cursor.word() {
        Some(b"ASCII") => Coding::Text,
        Some(b"BINARY") => Coding::Binary,
        other => {
            let word = quoted(other.unwrap_or_default());
            let problem = format!("{word} stands where ASCII or BINARY is expected");
            return Err(Fault::malformed(cursor.line_place(), problem));
        }
    };
    let mut soup = TetSoup::default();
    let mut cells = Cells::default();
    while let Some(word) = cursor.word() {
        match word.to_ascii_uppercase().as_slice() {
            b"DATASET" => {
                let kind = cursor.expect("the kind of the data set")?;
                if !kind.eq_ignore_ascii_case(b"UNSTRUCTURED_GRID") {
                    return Err(Fault::Unsupported {
                        place: cursor.line_place(),
                        feature: format!("the data set {}", quoted(kind)),
                        remedy: "give an unstructured grid",
                    });
                }
            }
            b"POINTS" => {
                let count = cursor.integer("the number of points")?;
                let kind = cursor.expect("the type of the points")?;
                let numbers = array(&mut cursor, coding, kind, count.saturating_mul(3))?;
                let points = numbers.chunks_exact(3);
                soup.positions = points.map(|p| Point3::new(p[0], p[1], p[2])).collect();
            }
            b"CELLS" => read_cells(&mut cursor, coding, &mut cells)?,
            b"CELL_TYPES" => {
                let count = cursor.integer("the number of cells")?;
                let types = array(&mut cursor, coding, b"int", count)?;
                cells.types = types.into_iter().map(|x| x as u64).collect();
            }
            b"FIELD" => pass_field(&mut cursor, coding)?,
            b"METADATA" => {
                cursor.line();
                while cursor
                    .line()
                    .is_some_and(|line| !line.trim_ascii().is_empty())
                {}
            }
            // Everything after belongs to points or cells.
            b"POINT_DATA" | b"CELL_DATA" => break,
            other => {
                let problem = format!("{} is no keyword that is known here", quoted(other));
                return Err(Fault::malformed(cursor.line_place(), problem));
            }
        }
    }
    cells.add_to(&mut soup, 0, &cursor)?;
    Ok(soup)
}

fn read_cells(cursor: &mut Cursor<'_>, coding: Coding, cells: &mut Cells) -> Result<(), Fault> {
    let first = cursor.integer("the number of cells")?;
    let second = cursor.integer("the length of the list of cells")?;
    let mut ahead = cursor.clone();
    if ahead.word() == Some(b"OFFSETS") {
        let kind = ahead.expect("the type of the offsets")?;
        *cursor = ahead;
        let offsets = array(cursor, coding, kind, first)?;
        cells.ends = offsets.into_iter().skip(1).map(|x| x as i64).collect();
        if cursor.word() != Some(b"CONNECTIVITY") {
            let problem = "CONNECTIVITY does not follow the offsets";
            return Err(Fault::malformed(cursor.line_place(), problem));
        }
        let kind = cursor.expect("the type of the connectivity")?;
        let list = array(cursor, coding, kind, second)?;
        cells.connectivity = list.into_iter().map(|x| x as i64).collect();
        return Ok(());
    }
    let list = array(cursor, coding, b"int", second)?;
    let mut at = 0;
    for cell in 0..first {
        let count = list.get(at).copied().unwrap_or(-1.0);
        let end = (at + 1).saturating_add(count.max(0.0) as usize);
        let Some(corners) = list.get(at + 1..end).filter(|_| count >= 0.0) else {
            let problem = format!("the list of cells ends within cell {cell}");
            return Err(Fault::malformed(cursor.line_place(), problem));
        };
        cells.connectivity.extend(corners.iter().map(|&x| x as i64));
        cells.ends.push(cells.connectivity.len() as i64);
        at = end;
    }
    Ok(())
}

/// Passes over arrays that belong to the whole data set, such as a time.
fn pass_field(cursor: &mut Cursor<'_>, coding: Coding) -> Result<(), Fault> {
    cursor.expect("the name of the field")?;
    let arrays = cursor.count("the number of arrays", 8)?;
    for _ in 0..arrays {
        cursor.expect("the name of an array")?;
        let components = cursor.integer("the number of components")?;
        let tuples = cursor.integer("the number of tuples")?;
        let kind = cursor.expect("the type of an array")?;
        array(cursor, coding, kind, components.saturating_mul(tuples))?;
    }
    Ok(())
}

/// Returns the numbers of an array as doubles, which hold all indices that a mesh can have.
fn array(
    cursor: &mut Cursor<'_>,
    coding: Coding,
    kind: &[u8],
    count: i64,
) -> Result<Vec<f64>, Fault> {
    if coding == Coding::Text {
        let count = cursor.check_room("the number of items", count, 2)?;
        return (0..count).map(|_| cursor.number("an item")).collect();
    }
    // The numbers begin right after the end of the line.
    cursor.line();
    let size = match kind {
        b"double" | b"long" | b"unsigned_long" | b"vtktypeint64" | b"vtktypeuint64" => 8,
        b"float" | b"int" | b"unsigned_int" | b"vtktypeint32" => 4,
        b"short" | b"unsigned_short" => 2,
        b"char" | b"unsigned_char" => 1,
        other => {
            let problem = format!("{} is no type of numbers that is known here", quoted(other));
            return Err(Fault::malformed(cursor.line_place(), problem));
        }
    };
    let count = cursor.check_room("the number of items", count, size)?;
    let mut numbers = Vec::with_capacity(count);
    for _ in 0..count {
        numbers.push(match (kind, size) {
            (b"double", _) => f64::from_be_bytes(cursor.take("a number")?),
            (b"float", _) => f32::from_be_bytes(cursor.take("a number")?).into(),
            (_, 8) => i64::from_be_bytes(cursor.take("a number")?) as f64,
            (_, 4) => i32::from_be_bytes(cursor.take("a number")?).into(),
            (_, 2) => i16::from_be_bytes(cursor.take("a number")?).into(),
            _ => cursor.take::<1>("a number")?[0].into(),
        });
    }
    Ok(numbers)
}
