//! npy: NumPy's file of one array.
//!
//! The parser is our own. The `npyz` library takes memory on the word of the header before it looks
//! for its bytes, multiplies dimensions without a check, so that a huge shape panics or wraps, needs
//! its number type named beforehand, and tells no place of a fault. Here nothing is taken before the
//! file is known to hold it. The tests read and write with both.

mod header;

use std::io::{self, Write};
use std::path::Path;

use self::header::{Header, Order};
use crate::error::{Fault, Place};
use crate::read::bytes_of;
use crate::{Format, ReadError, WriteError, write_atomically};

/// The first bytes of every file.
const MAGIC: &[u8] = b"\x93NUMPY";

/// The data start at a multiple of this, so that they can be mapped into memory.
const ALIGNMENT: usize = 64;

/// Numbers in rows: the last index of `shape` changes fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Number of indices in each dimension.
    pub shape: Vec<usize>,
    /// The numbers, as many as the product of the shape.
    pub values: Vec<f64>,
}

/// Returns the array of one to three dimensions in a `.npy` file.
///
/// Reads floating-point numbers of 4 and 8 bytes and whole numbers of 1 to 8, of either byte order,
/// stored by rows or by columns. A whole number beyond 2⁵³ becomes the nearest double. NaN and
/// infinity are data. Takes the file's size in memory beside the result.
///
/// # Errors
/// The file cannot be read, is no `.npy` file, holds another kind of data or more dimensions, or
/// has not exactly the bytes that its header announces.
pub fn read_npy(path: &Path) -> Result<Array, ReadError> {
    parse_npy(path, &bytes_of(path)?)
}

/// Returns what [`read_npy`] does for a file with these bytes; `path` names it in errors.
///
/// # Errors
/// As [`read_npy`].
pub fn parse_npy(path: &Path, bytes: &[u8]) -> Result<Array, ReadError> {
    if bytes.is_empty() {
        return Err(ReadError::Empty {
            path: path.to_owned(),
        });
    }
    parse(bytes).map_err(|fault| fault.in_file(path.to_owned(), Format::Npy))
}

/// Returns whether a file starts like a `.npy` file.
pub(crate) fn has_magic(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Returns why an array is no surface mesh.
pub(crate) fn no_mesh() -> Fault {
    Fault::Unsupported {
        place: Place::Byte(0),
        feature: "an array as a mesh".to_owned(),
        remedy: "give an OBJ, OFF, PLY or STL file",
    }
}

fn parse(bytes: &[u8]) -> Result<Array, Fault> {
    let Header {
        number,
        order,
        shape,
        start,
    } = header::parse(bytes)?;
    let data = &bytes[start..];
    let count = shape.iter().try_fold(1u128, |product, &dimension| {
        product.checked_mul(dimension as u128)
    });
    let needed = count.and_then(|count| count.checked_mul(number.size as u128));
    if needed != Some(data.len() as u128) {
        return Err(wrong_length(&shape, number.size, data.len(), needed, start));
    }
    let value = |index: usize| number.value(&data[index * number.size..][..number.size]);
    let count = data.len() / number.size;
    let values = match order {
        // Without numbers a dimension can have any length.
        _ if count == 0 => Vec::new(),
        Order::Rows => (0..count).map(value).collect(),
        Order::Columns => by_columns(&shape).map(value).collect(),
    };
    Ok(Array { shape, values })
}

fn wrong_length(
    shape: &[usize],
    size: usize,
    found: usize,
    needed: Option<u128>,
    start: usize,
) -> Fault {
    let announced = format!("shape {shape:?} of numbers of {size} bytes is announced");
    match needed {
        Some(needed) if needed < found as u128 => Fault::Malformed {
            place: Place::Byte(start as u64 + needed as u64),
            problem: format!("{announced}, and further bytes follow"),
            remedy: "save one array in each file",
        },
        _ => Fault::truncated(
            Place::Byte((start + found) as u64),
            format!("{announced}, {found} bytes are there"),
        ),
    }
}

/// Returns, in order of rows, where each number stands in an array stored by columns.
fn by_columns(shape: &[usize]) -> impl Iterator<Item = usize> {
    let mut counts = [1; 3];
    counts[3 - shape.len()..].copy_from_slice(shape);
    let [a, b, c] = counts;
    let rows = (0..a).flat_map(move |i| (0..b).map(move |j| (i, j)));
    rows.flat_map(move |(i, j)| (0..c).map(move |k| i + a * (j + b * k)))
}

/// Writes an array of one to three dimensions as a `.npy` file of doubles, by rows.
///
/// The file is written beside `path` and renamed; on an error nothing is left behind. The same array
/// gives the same bytes.
///
/// # Errors
/// The file cannot be written, or the array has not as many values as its shape says, or no or more
/// than three dimensions.
pub fn write_npy(path: &Path, array: &Array) -> Result<(), WriteError> {
    let shape = &array.shape;
    let count = shape
        .iter()
        .try_fold(1usize, |product, &dimension| product.checked_mul(dimension));
    if !header::DIMENSIONS.contains(&shape.len()) || count != Some(array.values.len()) {
        return Err(WriteError::ArrayShape {
            shape: shape.clone(),
            values: array.values.len(),
        });
    }
    write_atomically(path, |to| write(array, to))
}

fn write(array: &Array, to: &mut dyn Write) -> io::Result<()> {
    let dimensions: String = array.shape.iter().map(|n| format!("{n}, ")).collect();
    let mut text = format!(
        "{{'descr': '<f8', 'fortran_order': False, 'shape': ({}), }}",
        dimensions.trim_end()
    );
    let before = MAGIC.len() + header::VERSION_BYTES + size_of::<u16>();
    let end = (before + text.len() + 1).next_multiple_of(ALIGNMENT);
    text.extend(std::iter::repeat_n(' ', end - 1 - before - text.len()));
    text.push('\n');
    to.write_all(MAGIC)?;
    to.write_all(&[1, 0])?;
    to.write_all(&(text.len() as u16).to_le_bytes())?;
    to.write_all(text.as_bytes())?;
    array
        .values
        .iter()
        .try_for_each(|value| to.write_all(&value.to_le_bytes()))
}
