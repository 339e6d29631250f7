//! The header of a `.npy` file: a Python dictionary of the number type, the order and the shape.

use std::ops::RangeInclusive;

use super::MAGIC;
use crate::error::{Fault, Place};
use crate::text::quoted;

/// Numbers of dimensions that are read and written.
pub(super) const DIMENSIONS: RangeInclusive<usize> = 1..=3;

/// Bytes of the version behind the magic.
pub(super) const VERSION_BYTES: usize = 2;

/// Which index changes fastest in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Order {
    /// The last one.
    Rows,
    /// The first one.
    Columns,
}

/// What kind of number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Float,
    Signed,
    Unsigned,
}

/// A type of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Number {
    kind: Kind,
    big_endian: bool,
    /// Bytes that each takes.
    pub(super) size: usize,
}

impl Number {
    /// Returns the type of a description such as `<f8`.
    fn parse(word: &[u8]) -> Option<Self> {
        let &[order, kind, size] = word else {
            return None;
        };
        let (kind, size) = match (kind, size) {
            (b'f', b'4' | b'8') => (Kind::Float, usize::from(size - b'0')),
            (b'i', b'1' | b'2' | b'4' | b'8') => (Kind::Signed, usize::from(size - b'0')),
            (b'u', b'1' | b'2' | b'4' | b'8') => (Kind::Unsigned, usize::from(size - b'0')),
            _ => return None,
        };
        let big_endian = match order {
            b'<' => false,
            b'>' => true,
            b'|' if size == 1 => false,
            _ => return None,
        };
        Some(Self {
            kind,
            big_endian,
            size,
        })
    }

    /// Returns the value of `size` bytes.
    pub(super) fn value(self, bytes: &[u8]) -> f64 {
        // Widened to eight bytes, the least significant first.
        let mut wide = [0; 8];
        wide[..self.size].copy_from_slice(bytes);
        if self.big_endian {
            wide[..self.size].reverse();
        }
        let unsigned = u64::from_le_bytes(wide);
        let unused = u64::BITS - 8 * self.size as u32;
        match self.kind {
            Kind::Float if self.size == 4 => f64::from(f32::from_bits(unsigned as u32)),
            Kind::Float => f64::from_bits(unsigned),
            Kind::Signed => ((unsigned << unused).cast_signed() >> unused) as f64,
            Kind::Unsigned => unsigned as f64,
        }
    }
}

/// A header, and where the data start.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) number: Number,
    pub(super) order: Order,
    pub(super) shape: Vec<usize>,
    pub(super) start: usize,
}

/// Returns the header at the start of `bytes`.
pub(super) fn parse(bytes: &[u8]) -> Result<Header, Fault> {
    let Some(rest) = bytes.strip_prefix(MAGIC) else {
        let problem = "the file does not start with `\\x93NUMPY`";
        return Err(Fault::malformed(Place::Byte(0), problem));
    };
    let cut = || {
        let end = Place::Byte(bytes.len() as u64);
        Fault::truncated(end, "the header is longer than the file")
    };
    let (version, rest) = rest.split_first_chunk::<VERSION_BYTES>().ok_or_else(cut)?;
    let (length, rest) = match version {
        [1, 0] => {
            let (length, rest) = rest.split_first_chunk().ok_or_else(cut)?;
            (u32::from(u16::from_le_bytes(*length)), rest)
        }
        [2 | 3, 0] => {
            let (length, rest) = rest.split_first_chunk().ok_or_else(cut)?;
            (u32::from_le_bytes(*length), rest)
        }
        [major, minor] => {
            return Err(Fault::Unsupported {
                place: Place::Byte(MAGIC.len() as u64),
                feature: format!("npy version {major}.{minor}"),
                remedy: "save it with `numpy.save`",
            });
        }
    };
    let text = rest.get(..length as usize).ok_or_else(cut)?;
    let start = bytes.len() - rest.len();
    Text {
        rest: text,
        start,
        whole: text.len(),
    }
    .dictionary()
}

/// What is left of the text of a header.
struct Text<'a> {
    rest: &'a [u8],
    /// Where the text starts in the file.
    start: usize,
    /// Bytes of the text.
    whole: usize,
}

impl<'a> Text<'a> {
    fn dictionary(mut self) -> Result<Header, Fault> {
        let (mut number, mut order, mut shape) = (None, None, None);
        self.expect(b'{', "a dictionary")?;
        while !self.accept(b'}') {
            let key = self.string("a key")?;
            self.expect(b':', "`:` behind a key")?;
            match key {
                b"descr" if number.is_none() => number = Some(self.number()?),
                b"fortran_order" if order.is_none() => order = Some(self.order()?),
                b"shape" if shape.is_none() => shape = Some(self.shape()?),
                _ => {
                    let problem = format!("the key {} is unknown or repeated", quoted(key));
                    return Err(Fault::malformed(self.place(), problem));
                }
            }
            if !self.accept(b',') {
                self.expect(b'}', "`,` or `}`")?;
                break;
            }
        }
        if !self.rest.trim_ascii().is_empty() {
            return Err(self.unexpected("the end of the header"));
        }
        let place = self.place();
        let missing =
            |key: &str| Fault::malformed(place.clone(), format!("the header has no `{key}`"));
        Ok(Header {
            number: number.ok_or_else(|| missing("descr"))?,
            order: order.ok_or_else(|| missing("fortran_order"))?,
            shape: shape.ok_or_else(|| missing("shape"))?,
            start: self.start + self.whole,
        })
    }

    fn number(&mut self) -> Result<Number, Fault> {
        self.skip_space();
        let place = self.place();
        let unsupported = |feature: String| Fault::Unsupported {
            place,
            feature,
            remedy: "save real or whole numbers, such as `array.astype(float)`",
        };
        if self.rest.starts_with(b"[") {
            return Err(unsupported("a structured type".to_owned()));
        }
        let word = self.string("a number type")?;
        Number::parse(word).ok_or_else(|| unsupported(format!("the type {}", quoted(word))))
    }

    fn order(&mut self) -> Result<Order, Fault> {
        self.skip_space();
        for (word, order) in [("True", Order::Columns), ("False", Order::Rows)] {
            if let Some(rest) = self.rest.strip_prefix(word.as_bytes()) {
                self.rest = rest;
                return Ok(order);
            }
        }
        Err(self.unexpected("`True` or `False`"))
    }

    fn shape(&mut self) -> Result<Vec<usize>, Fault> {
        self.skip_space();
        let place = self.place();
        self.expect(b'(', "a shape in brackets")?;
        let mut shape = Vec::new();
        while !self.accept(b')') {
            // One more than are read, so that no header makes a long list.
            if shape.len() <= *DIMENSIONS.end() {
                shape.push(self.dimension()?);
            } else {
                self.dimension()?;
            }
            if !self.accept(b',') {
                self.expect(b')', "`,` or `)`")?;
                break;
            }
        }
        if DIMENSIONS.contains(&shape.len()) {
            return Ok(shape);
        }
        Err(Fault::Unsupported {
            place,
            feature: match shape.len() {
                0 => "an array without dimensions".to_owned(),
                _ => format!("an array of more than {} dimensions", DIMENSIONS.end()),
            },
            remedy: "reshape it to one, two or three dimensions",
        })
    }

    /// Returns the next dimension; one beyond the largest index becomes that.
    fn dimension(&mut self) -> Result<usize, Fault> {
        self.skip_space();
        let digits = self.rest.iter().take_while(|b| b.is_ascii_digit()).count();
        if digits == 0 {
            return Err(self.unexpected("a dimension"));
        }
        let (word, rest) = self.rest.split_at(digits);
        // Python 2 marked long numbers.
        self.rest = rest.strip_prefix(b"L").unwrap_or(rest);
        Ok(word.iter().fold(0, |value: usize, digit| {
            let tens = value.saturating_mul(10);
            tens.saturating_add(usize::from(digit - b'0'))
        }))
    }

    /// Returns the next string. What it says is compared with known words, so that an escaped
    /// character is an unknown word.
    fn string(&mut self, what: &str) -> Result<&'a [u8], Fault> {
        self.skip_space();
        let inside = match self.rest {
            [quote @ (b'\'' | b'"'), inside @ ..] => {
                let end = inside.iter().position(|b| b == quote);
                end.map(|end| inside.split_at(end))
            }
            _ => None,
        };
        let Some((word, rest)) = inside else {
            return Err(self.unexpected(what));
        };
        self.rest = &rest[1..];
        Ok(word)
    }

    fn accept(&mut self, byte: u8) -> bool {
        self.skip_space();
        let rest = self.rest.strip_prefix(&[byte]);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn expect(&mut self, byte: u8, what: &str) -> Result<(), Fault> {
        if self.accept(byte) {
            return Ok(());
        }
        Err(self.unexpected(what))
    }

    fn unexpected(&self, what: &str) -> Fault {
        let found = match self.rest.trim_ascii() {
            [] => "the header ends".to_owned(),
            rest => format!("{} stands", quoted(rest)),
        };
        Fault::malformed(self.place(), format!("{found} where {what} is expected"))
    }

    fn skip_space(&mut self) {
        self.rest = self.rest.trim_ascii_start();
    }

    fn place(&self) -> Place {
        Place::Byte((self.start + self.whole - self.rest.len()) as u64)
    }
}
