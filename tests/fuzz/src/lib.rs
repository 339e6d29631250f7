//! The laws that fuzz targets hold readers to.

pub mod meshes;
mod memory;
pub mod readers;
mod round_trip;
