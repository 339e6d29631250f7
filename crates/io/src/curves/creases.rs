//! The list of creases beside a control mesh: `i j sharpness` rows.
//!
//! Vertices count from 1, as in the OBJ file of the mesh; `i` twice is a sharp corner; a sharpness
//! of 10 or more is sharp for ever. What follows a `#` is a comment.

use std::path::Path;

use msplines_common::mesh::polygon::CreaseTag;

use crate::error::Fault;
use crate::read::bytes_of;
use crate::text::{Lines, Words, quoted};
use crate::{Format, ReadError};

/// Creases with the lines they come from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Creases {
    /// The creases, with vertices counted from 0.
    pub tags: Vec<CreaseTag>,
    /// The line of each, from 1.
    pub lines: Vec<u64>,
}

/// Returns the creases in a file. Whether the mesh has such vertices and edges is not checked.
///
/// # Errors
/// The file cannot be read, or a row is none: an index below 1 or beyond 32 bits, a sharpness that is
/// negative or no number, further words.
pub fn read_creases(path: &Path) -> Result<Creases, ReadError> {
    parse_creases(path, &bytes_of(path)?)
}

/// Returns what [`read_creases`] does for a file with these bytes; `path` names it in errors.
///
/// # Errors
/// As [`read_creases`].
pub fn parse_creases(path: &Path, bytes: &[u8]) -> Result<Creases, ReadError> {
    if bytes.is_empty() {
        return Err(ReadError::Empty {
            path: path.to_owned(),
        });
    }
    let mut creases = Creases::default();
    let mut lines = Lines::new(bytes);
    while let Some(words) = lines.next_with_words() {
        let tag = row(words).map_err(|fault| fault.in_file(path.to_owned(), Format::Creases))?;
        creases.tags.push(tag);
        creases.lines.push(lines.number());
    }
    Ok(creases)
}

fn row(mut words: Words<'_>) -> Result<CreaseTag, Fault> {
    let first = vertex(&mut words, "the first vertex")?;
    let second = vertex(&mut words, "the second vertex")?;
    let sharpness = words.number("the sharpness")?;
    if sharpness.is_nan() || sharpness < 0.0 {
        let problem = format!("the sharpness is {sharpness}, neither 0 nor more");
        return Err(Fault::malformed(words.place(), problem));
    }
    if let Some(word) = words.next() {
        let problem = format!("{} follows the sharpness", quoted(word));
        return Err(Fault::malformed(words.place(), problem));
    }
    Ok(CreaseTag {
        vertices: [first, second],
        sharpness,
    })
}

fn vertex(words: &mut Words<'_>, what: &str) -> Result<u32, Fault> {
    let number = words.integer(what)?;
    match u32::try_from(number) {
        Ok(number) if (1..u32::MAX).contains(&number) => Ok(number - 1),
        _ => {
            let problem = format!("{what} is {number}; vertices count from 1");
            Err(Fault::malformed(words.place(), problem))
        }
    }
}
