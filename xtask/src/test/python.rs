//! Python packages that a step asks, in an environment of their own below `target`.

use std::fs;
use std::path::Path;

use super::debian;
use super::steps::{self, Outcome};
use crate::tree;

/// Where the environment is made; `tests/reference` looks for it there.
const PLACE: &str = "target/solid_peers";
/// Its program.
const PYTHON: &str = "target/solid_peers/bin/python";
/// A copy of the list that it was made from, written last.
const STAMP: &str = "target/solid_peers/requirements.txt";
/// What is installed, to the version.
const REQUIREMENTS: &str = "tests/reference/python/requirements.txt";
/// Debian's packages of what makes environments.
const DEBIAN: [&str; 2] = ["python3", "python3-venv"];
/// Installs exactly what the list names, and compiles nothing.
const INSTALL: [&str; 8] = [
    "-m",
    "pip",
    "install",
    "--quiet",
    "--disable-pip-version-check",
    "--no-deps",
    "--only-binary=:all:",
    "--requirement",
];

/// Makes the environment unless it is there; says what to do if that cannot be done.
pub(super) fn prepare() -> Result<(), String> {
    if is_current() {
        return Ok(());
    }
    if !makes_environments() {
        debian::install_if_allowed(&DEBIAN);
    }
    if !makes_environments() {
        return Err(format!("apt-get install {}", DEBIAN.join(" ")));
    }
    let python = tree::root().join(PYTHON);
    let made = steps::program(Path::new("python3"), &["-m", "venv", "--clear", PLACE]);
    if made.outcome != Outcome::Passed {
        return Err(format!("python3 made no environment in {PLACE}"));
    }
    let install = [&INSTALL[..], &[REQUIREMENTS]].concat();
    if steps::program(&python, &install).outcome != Outcome::Passed {
        return Err(format!(
            "pip could not install {REQUIREMENTS}; it needs PyPI and Python 3.11 or later"
        ));
    }
    let root = tree::root();
    fs::copy(root.join(REQUIREMENTS), root.join(STAMP))
        .map(|_| ())
        .map_err(|error| format!("{STAMP} was not written: {error}"))
}

/// Whether the environment holds what is asked for.
fn is_current() -> bool {
    let read = |path| fs::read(tree::root().join(path)).ok();
    tree::root().join(PYTHON).exists() && read(STAMP).is_some_and(|s| Some(s) == read(REQUIREMENTS))
}

/// Whether there is a Python that makes environments with pip: Debian has that apart.
fn makes_environments() -> bool {
    steps::succeeds("python3", &["-c", "import venv, ensurepip"])
}
