//! Surfaces and solids of the library of models, where their files are at hand: the tests of several
//! packages include this file.
#![allow(clippy::print_stdout, reason = "tests say when they did not run")]

use std::path::{Path, PathBuf};

use msplines_common::mesh::{Policy, TriangleMesh, accept};
use msplines_io::read_soup;

/// Returns where a file of the library of models is, if it is there.
pub(crate) fn path(name: &str) -> Option<PathBuf> {
    let workspace = || {
        let above = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
        let mut folders = above.map(|folder| folder.join("data/models"));
        folders.find(|folder| folder.is_dir()).unwrap_or_default()
    };
    let root = std::env::var_os("MSPLINES_MODELS").map_or_else(workspace, PathBuf::from);
    let path = root.join(name);
    if !path.is_file() {
        println!("not run: {name}");
    }
    Some(path).filter(|path| path.is_file())
}

/// Returns a surface of the library of models, if it is there.
pub(crate) fn model(name: &str) -> Option<TriangleMesh> {
    let soup = read_soup(&path(&format!("{name}.ply"))?).expect("a surface of the library");
    Some(accept(&soup, Policy::Repair).expect("a surface").mesh)
}
