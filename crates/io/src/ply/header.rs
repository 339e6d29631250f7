//! The header of a PLY file: which elements follow, and of which properties.

use crate::error::{Fault, Place};
use crate::text::{Lines, Words, quoted};

/// How the body stores numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A number type of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    /// Returns the bytes a value takes in a binary body.
    pub(crate) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    fn parse(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }
}

/// What a property holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    One(Scalar),
    List { count: Scalar, item: Scalar },
}

/// A property of an element.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Property {
    pub(crate) name: String,
    pub(crate) kind: Kind,
}

/// An element: `count` records of the same properties.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Element {
    pub(crate) name: String,
    pub(crate) count: u64,
    pub(crate) properties: Vec<Property>,
}

/// A header, and where the body starts.
#[derive(Debug)]
pub(crate) struct Header<'a> {
    pub(crate) encoding: Encoding,
    pub(crate) elements: Vec<Element>,
    pub(crate) body: &'a [u8],
    pub(crate) lines: u64,
}

/// Returns the header at the start of `bytes`.
pub(crate) fn parse(bytes: &[u8]) -> Result<Header<'_>, Fault> {
    let mut lines = Lines::new(bytes);
    if lines.next().is_none_or(|line| line.trim_ascii() != b"ply") {
        return Err(Fault::malformed(
            Place::Line(1),
            "the first line is not `ply`",
        ));
    }
    let mut encoding = None;
    let mut elements = Vec::new();
    loop {
        let Some(line) = lines.next() else {
            return Err(Fault::truncated(
                lines.place(),
                "the header has no `end_header`",
            ));
        };
        let mut words = Words::new(line, lines.number());
        match words.next() {
            Some(b"format") => encoding = Some(parse_format(words)?),
            Some(b"comment" | b"obj_info") | None => {}
            Some(b"element") => elements.push(parse_element(words, &elements)?),
            Some(b"property") => match elements.last_mut() {
                Some(element) => parse_property(words, element)?,
                None => {
                    let problem = "a property stands before the first element";
                    return Err(Fault::malformed(lines.place(), problem));
                }
            },
            Some(b"end_header") => break,
            Some(word) => {
                let problem = format!("{} is no header statement", quoted(word));
                return Err(Fault::malformed(lines.place(), problem));
            }
        }
    }
    let Some(encoding) = encoding else {
        return Err(Fault::malformed(
            lines.place(),
            "the header has no `format` line",
        ));
    };
    Ok(Header {
        encoding,
        elements,
        body: lines.rest(),
        lines: lines.number(),
    })
}

fn parse_format(mut words: Words<'_>) -> Result<Encoding, Fault> {
    let encoding = match words.next().unwrap_or_default() {
        b"ascii" => Encoding::Ascii,
        b"binary_little_endian" => Encoding::LittleEndian,
        b"binary_big_endian" => Encoding::BigEndian,
        other => {
            return Err(Fault::Unsupported {
                place: words.place(),
                feature: format!("the PLY encoding {}", quoted(other)),
                remedy: "save it as ascii, binary_little_endian or binary_big_endian",
            });
        }
    };
    match words.next() {
        Some(b"1.0") => Ok(encoding),
        version => Err(Fault::Unsupported {
            place: words.place(),
            feature: format!("PLY version {}", quoted(version.unwrap_or_default())),
            remedy: "save it as PLY 1.0",
        }),
    }
}

fn parse_element(mut words: Words<'_>, earlier: &[Element]) -> Result<Element, Fault> {
    let name = parse_name(&mut words, "an element")?;
    if earlier.iter().any(|element| element.name == name) {
        let problem = format!("element `{name}` is declared twice");
        return Err(Fault::malformed(words.place(), problem));
    }
    let what = format!("the number of `{name}` elements");
    let count = words.integer(&what)?;
    match u64::try_from(count) {
        Ok(count) => Ok(Element {
            name,
            count,
            properties: Vec::new(),
        }),
        Err(_) => Err(Fault::malformed(
            words.place(),
            format!("{what} is {count}"),
        )),
    }
}

fn parse_property(mut words: Words<'_>, element: &mut Element) -> Result<(), Fault> {
    let kind = match words.next() {
        Some(b"list") => {
            let count = parse_scalar(words.next(), &words)?;
            let item = parse_scalar(words.next(), &words)?;
            Kind::List { count, item }
        }
        word => Kind::One(parse_scalar(word, &words)?),
    };
    let name = parse_name(&mut words, "a property")?;
    if element
        .properties
        .iter()
        .any(|property| property.name == name)
    {
        let problem = format!("element `{}` has property `{name}` twice", element.name);
        return Err(Fault::malformed(words.place(), problem));
    }
    element.properties.push(Property { name, kind });
    Ok(())
}

fn parse_scalar(word: Option<&[u8]>, words: &Words<'_>) -> Result<Scalar, Fault> {
    let word = word.unwrap_or_default();
    Scalar::parse(word).ok_or_else(|| {
        let problem = format!("{} is no PLY number type", quoted(word));
        Fault::malformed(words.place(), problem)
    })
}

fn parse_name(words: &mut Words<'_>, what: &str) -> Result<String, Fault> {
    match words.next() {
        Some(word) => Ok(String::from_utf8_lossy(word).into_owned()),
        None => Err(Fault::malformed(
            words.place(),
            format!("{what} has no name"),
        )),
    }
}
