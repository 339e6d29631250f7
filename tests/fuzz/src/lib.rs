//! The laws that fuzz targets hold readers to.
//!
//! Whatever the bytes: no panic, memory bounded by their number, no more things than bytes could name;
//! and what was read is read again, bit for bit, from the file that our writer makes of it.
#![allow(
    clippy::missing_panics_doc,
    reason = "a law that does not hold panics: that is what fuzzers look for"
)]

pub mod command_line;
pub mod damage;
mod memory;
pub mod meshes;
pub mod own_files;
pub mod readers;
mod round_trip;
