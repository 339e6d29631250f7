//! The numbers of a PLY body, one after another, in any of the three encodings.

use super::header::{Element, Kind, Scalar};
use crate::error::{Fault, Place};
use crate::text::{self, Lines, Words};

/// A body to take numbers from.
pub(super) trait Values {
    /// Returns the next value.
    fn real(&mut self, scalar: Scalar) -> Result<f64, Fault>;

    /// Returns the next value as a whole number.
    fn integer(&mut self, scalar: Scalar) -> Result<i64, Fault>;

    /// Passes over `count` values.
    fn skip(&mut self, scalar: Scalar, count: usize) -> Result<(), Fault>;

    /// Returns where the body has been read up to.
    fn place(&self) -> Place;

    /// Returns how many bytes are left; a text body counts the separator that need not end it.
    fn room(&self) -> usize;

    /// Returns the fewest bytes a value can take.
    fn least_size(scalar: Scalar) -> usize;

    /// Returns the length of the list that starts here, which the rest of the body can hold.
    fn list_length(&mut self, count: Scalar, item: Scalar) -> Result<usize, Fault> {
        let length = self.integer(count)?;
        let Ok(claimed) = u64::try_from(length) else {
            let problem = format!("a list has length {length}");
            return Err(Fault::malformed(self.place(), problem));
        };
        self.check_room(claimed, Self::least_size(item), "list items")?;
        Ok(length as usize)
    }

    /// Returns how many records of an element to read, once the body is known to be long enough.
    fn record_count(&self, element: &Element) -> Result<usize, Fault> {
        let least = |kind| match kind {
            Kind::One(scalar) | Kind::List { count: scalar, .. } => Self::least_size(scalar),
        };
        let record = element
            .properties
            .iter()
            .map(|property| least(property.kind))
            .sum();
        if record == 0 {
            return Ok(0);
        }
        self.check_room(
            element.count,
            record,
            &format!("`{}` elements", element.name),
        )?;
        Ok(element.count as usize)
    }

    /// Refuses what cannot fit into the rest of the body, before anything is allocated for it.
    fn check_room(&self, count: u64, least_size: usize, what: &str) -> Result<(), Fault> {
        let room = (self.room() / least_size.max(1)) as u64;
        if count <= room {
            return Ok(());
        }
        let problem = format!("{count} {what} are announced, there is room for at most {room}");
        Err(Fault::truncated(self.place(), problem))
    }
}

/// A text body: values are words, and lines mean nothing.
pub(super) struct Ascii<'a> {
    lines: Lines<'a>,
    words: Words<'a>,
}

impl<'a> Ascii<'a> {
    /// Returns the values of a body that starts after `header_lines` lines.
    pub(super) fn new(body: &'a [u8], header_lines: u64) -> Self {
        let words = Words::new(b"", header_lines);
        Self {
            lines: Lines::after(body, header_lines),
            words,
        }
    }

    fn word(&mut self) -> Result<&'a [u8], Fault> {
        loop {
            if let Some(word) = self.words.next() {
                return Ok(word);
            }
            let Some(line) = self.lines.next() else {
                return Err(Fault::truncated(self.place(), "a value is missing"));
            };
            self.words = Words::new(line, self.lines.number());
        }
    }
}

impl Values for Ascii<'_> {
    fn real(&mut self, _: Scalar) -> Result<f64, Fault> {
        let word = self.word()?;
        text::number(word, "a value", || self.place())
    }

    fn integer(&mut self, scalar: Scalar) -> Result<i64, Fault> {
        let word = self.word()?;
        match scalar {
            Scalar::F32 | Scalar::F64 => {
                whole(text::number(word, "a value", || self.place())?, || {
                    self.place()
                })
            }
            _ => text::integer(word, "a value", || self.place()),
        }
    }

    fn skip(&mut self, _: Scalar, count: usize) -> Result<(), Fault> {
        (0..count).try_for_each(|_| self.word().map(drop))
    }

    fn place(&self) -> Place {
        self.lines.place()
    }

    fn room(&self) -> usize {
        self.words.rest().len() + self.lines.rest().len() + 1
    }

    fn least_size(_: Scalar) -> usize {
        2
    }
}

/// A binary body.
pub(super) struct Binary<'a, const BIG_ENDIAN: bool> {
    body: &'a [u8],
    at: usize,
    body_start: usize,
}

impl<'a, const BIG_ENDIAN: bool> Binary<'a, BIG_ENDIAN> {
    /// Returns the values of a body that starts at byte `body_start` of its file.
    pub(super) fn new(body: &'a [u8], body_start: usize) -> Self {
        Self {
            body,
            at: 0,
            body_start,
        }
    }

    /// Returns the next bytes, least significant first.
    fn take<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        match self.body[self.at..].first_chunk::<N>() {
            Some(&chunk) => {
                let mut bytes = chunk;
                if BIG_ENDIAN {
                    bytes.reverse();
                }
                self.at += N;
                Ok(bytes)
            }
            None => {
                let problem = format!("a value of {N} bytes is missing");
                Err(Fault::truncated(self.place(), problem))
            }
        }
    }
}

impl<const BIG_ENDIAN: bool> Values for Binary<'_, BIG_ENDIAN> {
    fn real(&mut self, scalar: Scalar) -> Result<f64, Fault> {
        Ok(match scalar {
            Scalar::F32 => f64::from(f32::from_le_bytes(self.take()?)),
            Scalar::F64 => f64::from_le_bytes(self.take()?),
            whole => self.integer(whole)? as f64,
        })
    }

    fn integer(&mut self, scalar: Scalar) -> Result<i64, Fault> {
        Ok(match scalar {
            Scalar::I8 => i64::from(i8::from_le_bytes(self.take()?)),
            Scalar::U8 => i64::from(u8::from_le_bytes(self.take()?)),
            Scalar::I16 => i64::from(i16::from_le_bytes(self.take()?)),
            Scalar::U16 => i64::from(u16::from_le_bytes(self.take()?)),
            Scalar::I32 => i64::from(i32::from_le_bytes(self.take()?)),
            Scalar::U32 => i64::from(u32::from_le_bytes(self.take()?)),
            Scalar::F32 | Scalar::F64 => {
                let place = self.place();
                whole(self.real(scalar)?, || place)?
            }
        })
    }

    fn skip(&mut self, scalar: Scalar, count: usize) -> Result<(), Fault> {
        self.check_room(count as u64, scalar.size(), "values")?;
        self.at += count * scalar.size();
        Ok(())
    }

    fn place(&self) -> Place {
        Place::Byte((self.body_start + self.at) as u64)
    }

    fn room(&self) -> usize {
        self.body.len() - self.at
    }

    fn least_size(scalar: Scalar) -> usize {
        scalar.size()
    }
}

/// Returns a number that is whole.
fn whole(value: f64, place: impl FnOnce() -> Place) -> Result<i64, Fault> {
    /// Above 2^53 a double stands for several whole numbers.
    const LARGEST: f64 = 9_007_199_254_740_992.0;
    if value.fract() == 0.0 && value.abs() <= LARGEST {
        return Ok(value as i64);
    }
    Err(Fault::malformed(
        place(),
        format!("a value is {value}, which is no whole number"),
    ))
}
