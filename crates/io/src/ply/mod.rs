//! PLY: text and both binary orders, polygons and triangle strips, any further properties.
//!
//! The parser is our own. The `ply-rs-bw` library refuses `nan`, `inf`, `1.` and `.5` in text,
//! lets a property declared twice shift all that follow, visits as many records as the header
//! claims even where a record takes no bytes, and tells no byte of a binary fault. Here nothing is
//! allocated before the file is known to be long enough for it. The tests read with both.

mod header;
mod read;
mod values;
mod write;

pub(crate) use read::parse;
pub(crate) use write::write;

/// Returns whether a file starts like a PLY file.
pub(crate) fn has_magic(bytes: &[u8]) -> bool {
    let bytes = crate::text::without_mark(bytes);
    bytes.starts_with(b"ply") && bytes.get(3).is_some_and(u8::is_ascii_whitespace)
}
