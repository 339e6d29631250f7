//! The numbers of one array.

use std::io::Read;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;

use crate::error::{Fault, Place};
use crate::text::{is_space, quoted};

/// How bytes of all arrays are written.
#[derive(Clone, Copy, Default)]
pub(super) struct Form {
    pub(super) compressed: bool,
    pub(super) big_endian: bool,
    /// Whether lengths take eight bytes instead of four.
    pub(super) wide_header: bool,
}

/// A type of numbers: how many bytes, and whether they are floating-point or signed.
#[derive(Clone, Copy)]
enum Kind {
    Float(usize),
    Signed(usize),
    Unsigned(usize),
}

impl Kind {
    fn size(self) -> usize {
        match self {
            Self::Float(size) | Self::Signed(size) | Self::Unsigned(size) => size,
        }
    }
}

/// Where an array is and of which type.
pub(super) struct Layout {
    kind: Kind,
    place: Where,
}

enum Where {
    Words,
    Base64,
    Appended(usize),
}

impl Layout {
    pub(super) fn build(kind: &str, format: &str, offset: Option<usize>) -> Result<Self, String> {
        let kind = match kind {
            "Float32" => Kind::Float(4),
            "Float64" => Kind::Float(8),
            "Int8" => Kind::Signed(1),
            "Int16" => Kind::Signed(2),
            "Int32" => Kind::Signed(4),
            "Int64" => Kind::Signed(8),
            "UInt8" => Kind::Unsigned(1),
            "UInt16" => Kind::Unsigned(2),
            "UInt32" => Kind::Unsigned(4),
            "UInt64" => Kind::Unsigned(8),
            // Text in field data is passed over; its numbers are never asked for.
            "String" => Kind::Unsigned(1),
            other => {
                return Err(format!(
                    "the type of an array is {}",
                    quoted(other.as_bytes())
                ));
            }
        };
        let place = match (format, offset) {
            ("ascii", _) => Where::Words,
            ("binary", _) => Where::Base64,
            ("appended", Some(offset)) => Where::Appended(offset),
            ("appended", None) => return Err("an appended array has no offset".to_owned()),
            (other, _) => {
                return Err(format!(
                    "the format of an array is {}",
                    quoted(other.as_bytes())
                ));
            }
        };
        Ok(Self { kind, place })
    }
}

/// What stands in the appended block.
pub(super) enum Appended<'a> {
    None,
    Raw(&'a [u8]),
    Base64(&'a [u8]),
}

impl<'a> Appended<'a> {
    /// Returns the XML before the appended block, and the block.
    pub(super) fn split(bytes: &'a [u8]) -> Result<(&'a [u8], Self), Fault> {
        const START: &[u8] = b"<AppendedData";
        let Some(place) = bytes.windows(START.len()).position(|w| w == START) else {
            return Ok((bytes, Self::None));
        };
        let (text, block) = bytes.split_at(place);
        let line = text.iter().filter(|&&b| b == b'\n').count() as u64 + 1;
        let malformed = |problem| Fault::malformed(Place::Line(line), problem);
        let tag_end = block.iter().position(|&b| b == b'>');
        let tag_end =
            tag_end.ok_or_else(|| malformed("the tag of the appended data has no end"))?;
        let (tag, rest) = block.split_at(tag_end);
        let mark = rest.iter().position(|&b| b == b'_');
        let mark = mark.ok_or_else(|| malformed("the appended data do not begin with `_`"))?;
        let data = &rest[mark + 1..];
        let is_raw = tag.windows(5).any(|w| w == b"\"raw\"" || w == b"'raw'");
        Ok((
            text,
            if is_raw {
                Self::Raw(data)
            } else {
                Self::Base64(data)
            },
        ))
    }
}

/// Numbers in the type they are used as.
pub(super) enum Numbers {
    Doubles(Vec<f64>),
    Integers(Vec<i64>),
}

impl Numbers {
    pub(super) fn into_doubles(self) -> Vec<f64> {
        match self {
            Self::Doubles(values) => values,
            Self::Integers(values) => values.into_iter().map(|x| x as f64).collect(),
        }
    }

    /// Returns whole numbers; others are rounded towards zero.
    pub(super) fn into_integers(self) -> Vec<i64> {
        match self {
            Self::Doubles(values) => values.into_iter().map(|x| x as i64).collect(),
            Self::Integers(values) => values,
        }
    }
}

/// Returns the numbers of an array, which may take at most `most` bytes when decompressed.
pub(super) fn decode(
    layout: &Layout,
    form: Form,
    text: &[u8],
    appended: &Appended<'_>,
    most: usize,
) -> Result<Numbers, String> {
    let bytes = match (&layout.place, appended) {
        (Where::Words, _) => return words(layout.kind, text),
        (Where::Base64, _) => payload(&base64_bytes(text)?, form, most)?,
        (Where::Appended(offset), Appended::Raw(block)) => {
            let from = block
                .get(*offset..)
                .ok_or("its offset is beyond the appended data")?;
            payload(from, form, most)?
        }
        (Where::Appended(offset), Appended::Base64(block)) => {
            let from = block
                .get(*offset..)
                .ok_or("its offset is beyond the appended data")?;
            payload(&base64_bytes(from)?, form, most)?
        }
        (Where::Appended(_), Appended::None) => return Err("there are no appended data".to_owned()),
    };
    Ok(numbers(layout.kind, form, &bytes))
}

fn words(kind: Kind, text: &[u8]) -> Result<Numbers, String> {
    let words = text.split(|&b| is_space(b)).filter(|word| !word.is_empty());
    fn parsed<T: std::str::FromStr>(word: &[u8]) -> Result<T, String> {
        let text = std::str::from_utf8(word).ok();
        let value = text.and_then(|word| word.parse().ok());
        value.ok_or_else(|| format!("{} is no number of its type", quoted(word)))
    }
    Ok(match kind {
        Kind::Float(_) => Numbers::Doubles(words.map(parsed).collect::<Result<_, _>>()?),
        _ => Numbers::Integers(words.map(parsed).collect::<Result<_, _>>()?),
    })
}

/// Returns the bytes of base64 text that may consist of several streams, each with its own padding,
/// up to the first byte that is none.
fn base64_bytes(text: &[u8]) -> Result<Vec<u8>, String> {
    let is_code = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'+' | b'/' | b'=');
    let end = text.iter().position(|&b| !is_code(b) && !is_space(b));
    let text = &text[..end.unwrap_or(text.len())];
    let code: Vec<u8> = text.iter().copied().filter(|&b| !is_space(b)).collect();
    let mut bytes = Vec::with_capacity(code.len() / 4 * 3);
    let mut rest = code.as_slice();
    while !rest.is_empty() {
        let padding = rest.iter().position(|&b| b == b'=').unwrap_or(rest.len());
        // A stream ends with the group of four that has the padding.
        let (stream, after) = rest.split_at(padding.next_multiple_of(4).min(rest.len()));
        let decoded = STANDARD.decode_vec(stream, &mut bytes);
        decoded.map_err(|error| format!("this is no base64: {error}"))?;
        if stream.is_empty() {
            return Err("this is no base64: padding stands alone".to_owned());
        }
        rest = after;
    }
    Ok(bytes)
}

/// Returns the bytes of an array that stand after their length or lengths.
fn payload(bytes: &[u8], form: Form, most: usize) -> Result<Vec<u8>, String> {
    let short = || "its data end early".to_owned();
    let width = if form.wide_header { 8 } else { 4 };
    let length = |index: usize| -> Result<usize, String> {
        let word = bytes
            .get(index * width..(index + 1) * width)
            .ok_or_else(short)?;
        usize::try_from(unsigned(word, form.big_endian)).map_err(|_| short())
    };
    if !form.compressed {
        let end = width.checked_add(length(0)?).ok_or_else(short)?;
        return Ok(bytes.get(width..end).ok_or_else(short)?.to_vec());
    }
    let blocks = length(0)?;
    if blocks == 0 {
        return Ok(Vec::new());
    }
    let header = blocks.checked_add(3).and_then(|n| n.checked_mul(width));
    let mut at = header.filter(|&n| n <= bytes.len()).ok_or_else(short)?;
    let mut all = Vec::new();
    for block in 0..blocks {
        let end = at.checked_add(length(3 + block)?).ok_or_else(short)?;
        let packed = bytes.get(at..end).ok_or_else(short)?;
        let room = most.saturating_sub(all.len()) as u64 + 1;
        let unpacked = ZlibDecoder::new(packed).take(room).read_to_end(&mut all);
        unpacked.map_err(|error| format!("its block {block} cannot be decompressed: {error}"))?;
        if all.len() > most {
            return Err("it is compressed more than any mesh can be".to_owned());
        }
        at = end;
    }
    Ok(all)
}

fn unsigned(bytes: &[u8], big_endian: bool) -> u64 {
    let join = |value: u64, byte: &u8| value << 8 | u64::from(*byte);
    if big_endian {
        bytes.iter().fold(0, join)
    } else {
        bytes.iter().rev().fold(0, join)
    }
}

fn numbers(kind: Kind, form: Form, bytes: &[u8]) -> Numbers {
    let words = bytes.chunks_exact(kind.size());
    let bits = words.map(|word| unsigned(word, form.big_endian));
    match kind {
        Kind::Float(4) => Numbers::Doubles(
            bits.map(|bits| f32::from_bits(bits as u32).into())
                .collect(),
        ),
        Kind::Float(_) => Numbers::Doubles(bits.map(f64::from_bits).collect()),
        Kind::Unsigned(_) => Numbers::Integers(bits.map(|bits| bits as i64).collect()),
        Kind::Signed(size) => {
            // Shifting the sign to the top and back extends it.
            let shift = 64 - 8 * size as u32;
            let signed = |bits: u64| (bits << shift) as i64 >> shift;
            Numbers::Integers(bits.map(signed).collect())
        }
    }
}
