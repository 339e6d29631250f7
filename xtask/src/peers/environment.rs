//! Python packages to compare with, in an environment of their own below `target`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::tree::root;

/// Where the environment is made.
const PLACE: &str = "target/peers";
/// What is installed, a package a line.
const LIST: &str = "tests/reference/python/peers.txt";
/// A copy of the list whose packages are all there.
const STAMP: &str = "target/peers/installed.txt";

/// An environment, and what it lacks.
pub(super) struct Environment {
    /// Its program.
    pub(super) python: PathBuf,
    /// Packages that could not be had, and why.
    pub(super) missing: Vec<(String, String)>,
}

/// Makes the environment unless it is there; a package that cannot be installed is only told.
pub(super) fn prepare() -> Result<Environment, String> {
    let root = root();
    let python = root.join(PLACE).join("bin/python");
    let list = fs::read_to_string(root.join(LIST)).map_err(|error| format!("{LIST}: {error}"))?;
    let mut missing = Vec::new();
    if python.exists() && fs::read_to_string(root.join(STAMP)).is_ok_and(|stamp| stamp == list) {
        return Ok(Environment { python, missing });
    }
    if !python.exists() {
        make(&root.join(PLACE))?;
    }
    for package in packages(&list) {
        if let Some(reason) = install(&python, package) {
            println!("{package} cannot be installed: {reason}");
            missing.push((name(package), reason));
        }
    }
    // What failed may have been the network: it is tried again the next time.
    if missing.is_empty() {
        fs::write(root.join(STAMP), &list).map_err(|error| format!("{STAMP}: {error}"))?;
    }
    Ok(Environment { python, missing })
}

/// The packages of a list, without its comments.
fn packages(list: &str) -> impl Iterator<Item = &str> {
    let lines = list.lines().map(str::trim);
    lines.filter(|line| !line.is_empty() && !line.starts_with('#'))
}

/// The name of a package, without its version.
fn name(package: &str) -> String {
    package.split("==").next().unwrap_or(package).to_owned()
}

fn make(place: &Path) -> Result<(), String> {
    let made = Command::new("python3")
        .args(["-m", "venv", "--clear"])
        .arg(place)
        .status();
    match made {
        Ok(status) if status.success() => Ok(()),
        _ => Err(
            "python3 makes no virtual environment: apt-get install python3 python3-venv".to_owned(),
        ),
    }
}

/// Installs a package, or returns the last thing that pip said.
fn install(python: &Path, package: &str) -> Option<String> {
    let output = Command::new(python)
        .args(["-m", "pip", "install", "--quiet", "--only-binary=:all:"])
        .args(["--disable-pip-version-check", package])
        .stdin(Stdio::null())
        .output();
    match output {
        Ok(output) if output.status.success() => None,
        Ok(output) => {
            let said = String::from_utf8_lossy(&output.stderr);
            let last = said.lines().rfind(|line| !line.trim().is_empty());
            Some(last.unwrap_or("pip failed").trim().to_owned())
        }
        Err(error) => Some(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::{name, packages};

    #[test]
    fn comments_are_no_packages() {
        let found: Vec<_> = packages("# why\na==1\n\nspams-bin==2\n")
            .map(name)
            .collect();
        assert_eq!(found, ["a", "spams-bin"]);
    }
}
