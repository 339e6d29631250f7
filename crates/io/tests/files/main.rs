//! Reading and writing whole files.

mod bezier;
mod common;
mod corners;
mod curves;
mod errors;
mod libraries;
mod models;
mod npy;
mod obj;
mod off;
mod output;
mod ply;
mod round_trip;
mod step;
mod stl;
mod volume;
