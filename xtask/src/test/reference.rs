//! Tests against established C++ libraries, which are installed where that is allowed.

use std::fs;
use std::path::Path;

use super::steps::{self, Step};
use crate::tree;

/// Debian packages, and a header of each that shows it is there.
const LIBRARIES: [(&str, &str); 4] = [
    ("g++", "/usr/bin/c++"),
    (
        "libopenmesh-dev",
        "/usr/include/OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh",
    ),
    ("libcgal-dev", "/usr/include/CGAL/version.h"),
    ("libsuitesparse-dev", "/usr/include/suitesparse/cholmod.h"),
];

/// Runs the tests of `tests/reference`.
pub(super) fn run() -> Step {
    let mut missing = missing_packages();
    if !missing.is_empty() && may_install() {
        install(&missing);
        missing = missing_packages();
    }
    if !missing.is_empty() {
        return Step::not_run(format!("apt-get install {}", missing.join(" ")));
    }
    let mut arguments = steps::test_runner();
    arguments.extend(["--package", "msplines-reference"]);
    let step = steps::cargo(&arguments);
    match gather() {
        Ok(()) => step,
        Err(error) => Step::failed(format!("target/reference.json was not written: {error}")),
    }
}

/// Gathers what each test left in `target/reference` into one list for programs.
fn gather() -> std::io::Result<()> {
    let target = tree::root().join("target");
    let mut paths = Vec::new();
    for entry in fs::read_dir(target.join("reference"))? {
        paths.push(entry?.path());
    }
    paths.sort();
    let records = paths
        .iter()
        .map(fs::read_to_string)
        .collect::<Result<Vec<_>, _>>()?;
    fs::write(
        target.join("reference.json"),
        format!("[\n{}\n]\n", records.join(",\n")),
    )
}

fn missing_packages() -> Vec<&'static str> {
    let missing = LIBRARIES
        .iter()
        .filter(|(_, sign)| !Path::new(sign).exists());
    missing.map(|(package, _)| *package).collect()
}

/// Whether this is the superuser of a Debian system.
fn may_install() -> bool {
    // Only the superuser may write the package database.
    steps::succeeds("test", &["-w", "/var/lib/dpkg/status"])
        && steps::succeeds("apt-get", &["--version"])
}

fn install(packages: &[&str]) {
    let apt = Path::new("apt-get");
    let mut arguments = vec!["install", "--yes", "--no-install-recommends"];
    arguments.extend(packages);
    steps::program(apt, &["update", "--quiet"]);
    steps::program(apt, &arguments);
}
