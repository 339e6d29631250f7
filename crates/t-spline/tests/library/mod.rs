//! Surfaces of the library of models, where their files are at hand.
#![allow(clippy::print_stdout, reason = "tests say when they did not run")]

use std::path::PathBuf;

use msplines_common::mesh::{Policy, TriangleMesh, accept};
use msplines_io::read_soup;

/// Returns a surface of the library of models, if it is there.
pub(crate) fn model(name: &str) -> Option<TriangleMesh> {
    let here = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/models");
    let root = std::env::var_os("MSPLINES_MODELS").map_or_else(|| here.into(), PathBuf::from);
    let path = root.join(name).with_extension("ply");
    if !path.is_file() {
        println!("not run: {name}");
        return None;
    }
    let soup = read_soup(&path).expect("a surface of the library");
    Some(accept(&soup, Policy::Repair).expect("a surface").mesh)
}
