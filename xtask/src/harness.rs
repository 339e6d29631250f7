//! The program of `xtask/harness`, which runs the methods.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Command;

use crate::tree;

/// The package, its program, and the test that makes cargo build the program along with the tests.
const PACKAGE: &str = "msplines-harness";
pub(crate) const TEST: &str = "commands";

/// Builds the program in the release profile and becomes it.
pub(crate) fn run(command: &str, arguments: &[OsString]) -> Result<(), String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut program = Command::new(cargo);
    program
        .args(["run", "--release", "--package", PACKAGE, "--manifest-path"])
        .arg(tree::root().join("Cargo.toml"))
        .args(["--", command])
        .args(arguments);
    let error = becoming(&mut program);
    Err(format!("cargo cannot be started: {error}"))
}

/// Puts the program in the place of this one, so that signals reach it; returns only if it cannot.
#[cfg(unix)]
fn becoming(program: &mut Command) -> std::io::Error {
    std::os::unix::process::CommandExt::exec(program)
}

/// Runs the program and ends as it did; returns only if it cannot be started.
#[cfg(not(unix))]
fn becoming(program: &mut Command) -> std::io::Error {
    match program.status() {
        Ok(status) => std::process::exit(status.code().unwrap_or(1)),
        Err(error) => error,
    }
}

/// Returns the program as the tests build it.
pub(crate) fn of_tests() -> Result<PathBuf, String> {
    let this = std::env::current_exe();
    let this = this.map_err(|error| format!("this program has no path: {error}"))?;
    // Programs of both the dev and the test profile lie in `debug`.
    let target = this.ancestors().nth(2).unwrap_or(&this);
    let name = format!("{PACKAGE}{}", std::env::consts::EXE_SUFFIX);
    Ok(target.join("debug").join(name))
}
