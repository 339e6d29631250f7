//! The text format of curve networks: `v x y z`, `c i j k ...` and `k 0 1 ...` rows.
//!
//! A `c` row is a polyline through points counted from 1, closed if its last is its first. The `k`
//! row after it has the crease flag of every segment; without one the curve is smooth. What follows
//! a `#` is a comment. Points may come after the curves that use them.

use nalgebra::Point3;

use super::draft::{Draft, DraftCurve};
use crate::error::Fault;
use crate::text::{Lines, Words, integer, quoted};

/// Returns the network of a file.
pub(super) fn parse(bytes: &[u8]) -> Result<Draft, Fault> {
    let mut draft = Draft::default();
    let mut flagged = true;
    let mut lines = Lines::new(bytes);
    while let Some(mut words) = lines.next_with_words() {
        let line = lines.number();
        match words.next() {
            Some(b"v") => draft.push(point(words)?, line),
            Some(b"c") => {
                let place = words.place();
                let points: Vec<i64> = words
                    .map(|word| integer(word, "a point index", || place.clone()))
                    .collect::<Result<_, _>>()?;
                let creases = vec![false; points.len().saturating_sub(1)];
                flagged = false;
                draft.curves.push(DraftCurve {
                    points,
                    creases,
                    line,
                });
            }
            Some(b"k") => match draft.curves.last_mut() {
                Some(curve) if !flagged => {
                    flagged = true;
                    flags(words, &mut curve.creases)?;
                }
                _ => {
                    let problem = "this row of crease flags does not follow a curve";
                    return Err(Fault::malformed(words.place(), problem));
                }
            },
            other => {
                let word = quoted(other.unwrap_or_default());
                let problem = format!("{word} starts no row of a curve network: give v, c or k");
                return Err(Fault::malformed(words.place(), problem));
            }
        }
    }
    Ok(draft)
}

fn point(mut words: Words<'_>) -> Result<Point3<f64>, Fault> {
    let x = words.number("the x coordinate")?;
    let y = words.number("the y coordinate")?;
    let z = words.number("the z coordinate")?;
    match words.next() {
        None => Ok(Point3::new(x, y, z)),
        Some(word) => {
            let problem = format!("{} follows the three coordinates", quoted(word));
            Err(Fault::malformed(words.place(), problem))
        }
    }
}

fn flags(mut words: Words<'_>, creases: &mut [bool]) -> Result<(), Fault> {
    let given = words.clone().count();
    if given != creases.len() {
        let segments = creases.len();
        let problem = format!("there are {given} crease flags for {segments} segments");
        return Err(Fault::malformed(words.place(), problem));
    }
    for crease in creases {
        *crease = match words.next() {
            Some(b"0") => false,
            Some(b"1") => true,
            other => {
                let word = quoted(other.unwrap_or_default());
                let problem = format!("a crease flag is {word}, neither 0 nor 1");
                return Err(Fault::malformed(words.place(), problem));
            }
        };
    }
    Ok(())
}
