//! The lines of an OBJ file as a curve network.
//!
//! Every `l` element is a curve, with a crease if the last group or object name before it contains
//! `crease`. Faces and all else are passed over.

use nalgebra::Point3;

use super::draft::{Draft, DraftCurve};
use crate::error::Fault;
use crate::obj::next_statement;
use crate::text::{Lines, Words, integer};

/// Returns the network of a file.
pub(super) fn parse(bytes: &[u8]) -> Result<Draft, Fault> {
    let mut draft = Draft::default();
    let mut crease = false;
    let mut lines = Lines::new(bytes);
    while let Some(statement) = next_statement(&mut lines) {
        let line = lines.number();
        let mut words = Words::new(&statement, line);
        match words.next() {
            Some(b"v") => {
                let x = words.number("the x coordinate")?;
                let y = words.number("the y coordinate")?;
                let z = words.number("the z coordinate")?;
                draft.push(Point3::new(x, y, z), line);
            }
            Some(b"g" | b"o") => crease = names_crease(words.rest()),
            Some(b"l") => {
                let points = indices(words, draft.points.len())?;
                let creases = vec![crease; points.len().saturating_sub(1)];
                draft.curves.push(DraftCurve {
                    points,
                    creases,
                    line,
                });
            }
            _ => {}
        }
    }
    Ok(draft)
}

/// Returns whether a name contains `crease`, in any case.
pub(super) fn names_crease(name: &[u8]) -> bool {
    let mut windows = name.windows(6);
    windows.any(|window| window.eq_ignore_ascii_case(b"crease"))
}

/// Returns point numbers from 1; negative ones count back from the latest point.
fn indices(words: Words<'_>, count: usize) -> Result<Vec<i64>, Fault> {
    let place = words.place();
    words
        .map(|word| {
            let index = word.split(|&b| b == b'/').next().unwrap_or_default();
            let index = integer(index, "a point index", || place.clone())?;
            if index < 0 {
                Ok(index.saturating_add(1 + count as i64))
            } else {
                Ok(index)
            }
        })
        .collect()
}
