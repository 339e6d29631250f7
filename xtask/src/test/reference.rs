//! Tests against established libraries and programs, which are installed where that is allowed.

use std::fs;
use std::io;
use std::path::Path;
use std::sync::OnceLock;

use super::steps::{self, Outcome, Step};
use super::{debian, draw, python};
use crate::tree;

/// Debian packages, and a header of each that shows it is there.
const LIBRARIES: [(&str, &str); 6] = [
    ("g++", "/usr/bin/c++"),
    (
        "libopenmesh-dev",
        "/usr/include/OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh",
    ),
    ("libosd-dev", "/usr/include/opensubdiv/far/primvarRefiner.h"),
    ("libcgal-dev", "/usr/include/CGAL/version.h"),
    ("libeigen3-dev", "/usr/include/eigen3/Eigen/Core"),
    ("libsuitesparse-dev", "/usr/include/suitesparse/cholmod.h"),
];

/// The package of bindings and their tests.
pub(crate) const PACKAGE: &str = "msplines-reference";
/// Where each test leaves what it found.
const PARTS: &str = "target/reference";
/// Where they are gathered; the harness reads it.
const RECORDS: &str = "target/reference.json";
/// nextest's name for the tests of this package.
const OWN: &str = "package(msplines-reference)";
/// nextest's name for all other tests.
pub(super) const OTHERS: &str = "not package(msplines-reference)";
/// The tests of this package that need its bindings alone.
const TESTS: [&str; 9] = [
    "openmesh",
    "opensubdiv",
    "topology",
    "delaunay",
    "cgal",
    "cholmod",
    "flattening",
    "solids",
    "distances",
];

/// Tests that ask a program, and what installs it or says what to do.
type Asking = (&'static [&'static str], fn() -> Result<(), String>);

/// The tests of this package that ask programs.
const ASKING: [Asking; 2] = [
    (&["gismo", "tensor", "vtk"], python::prepare),
    (&["step"], draw::prepare),
];

/// Returns whether the bindings can be built; on first use installs what is missing, if it may.
pub(super) fn is_ready() -> bool {
    static INSTALLED: OnceLock<()> = OnceLock::new();
    let missing = missing_packages();
    INSTALLED.get_or_init(|| debian::install_if_allowed(&missing));
    missing_packages().is_empty()
}

/// Makes sure that the bindings can be built; says what to install if they cannot.
pub(crate) fn ready() -> Result<(), String> {
    if is_ready() {
        Ok(())
    } else {
        Err(format!("apt-get install {}", missing_packages().join(" ")))
    }
}

/// Runs the tests of `tests/reference`, which is among these packages if it can be built.
///
/// `harness` then compares what they found with the page that shows it.
pub(super) fn run(packages: Vec<&str>, harness: impl FnOnce(&[&str]) -> Step) -> Step {
    if let Err(remedy) = ready() {
        return Step::not_run(remedy);
    }
    let (mut asking, mut left_out, mut remedies) = (Vec::new(), Vec::new(), Vec::new());
    for (tests, prepare) in ASKING {
        match prepare() {
            Ok(()) => asking.extend(tests),
            Err(remedy) => {
                left_out.extend(tests);
                remedies.push(format!("{}: {remedy}", tests.join(" and ")));
            }
        }
    }
    // What an earlier run left may have another name by now.
    let records = tree::root().join(PARTS);
    if let Err(error) = fs::remove_dir_all(&records).or_else(absent_is_fine) {
        return Step::failed(format!("{PARTS} was not removed: {error}"));
    }
    let mut arguments = if steps::has_nextest() {
        steps::test_runner()
    } else {
        vec!["test"]
    };
    arguments.extend(packages);
    let own = without(&left_out);
    if steps::has_nextest() {
        arguments.extend(["--filterset", &own]);
    } else {
        let tests = TESTS.iter().chain(asking);
        arguments.extend(tests.flat_map(|test| ["--test", test]));
    }
    let step = steps::cargo(&arguments);
    if let Err(error) = gather() {
        return Step::failed(format!("{} was not written: {error}", RECORDS));
    }
    if step.outcome != Outcome::Passed {
        return step;
    }
    let mut check = vec!["references", "--check"];
    if !remedies.is_empty() {
        check.push("--partial");
    }
    let checked = harness(&check).outcome;
    let outcome = match checked {
        Outcome::Passed if !remedies.is_empty() => Outcome::NotRun(remedies.join("; ")),
        other => other,
    };
    Step { outcome, ..step }
}

fn absent_is_fine(error: io::Error) -> io::Result<()> {
    match error.kind() {
        io::ErrorKind::NotFound => Ok(()),
        _ => Err(error),
    }
}

/// Returns nextest's name for the tests of this package other than these.
fn without(left_out: &[&str]) -> String {
    let left_out = left_out
        .iter()
        .map(|test| format!(" and not binary({test})"));
    format!("{OWN}{}", left_out.collect::<String>())
}

/// Gathers what each test left into one list for programs.
fn gather() -> io::Result<()> {
    let root = tree::root();
    let mut paths = Vec::new();
    for entry in fs::read_dir(root.join(PARTS))? {
        paths.push(entry?.path());
    }
    paths.sort();
    let records = paths
        .iter()
        .map(fs::read_to_string)
        .collect::<Result<Vec<_>, _>>()?;
    fs::write(
        root.join(RECORDS),
        format!("[\n{}\n]\n", records.join(",\n")),
    )
}

fn missing_packages() -> Vec<&'static str> {
    let missing = LIBRARIES
        .iter()
        .filter(|(_, sign)| !Path::new(sign).exists());
    missing.map(|(package, _)| *package).collect()
}

#[cfg(test)]
mod tests {
    use super::without;

    #[test]
    fn tests_of_absent_programs_are_left_out() {
        assert_eq!(without(&[]), "package(msplines-reference)");
        assert_eq!(
            without(&["gismo", "vtk"]),
            "package(msplines-reference) and not binary(gismo) and not binary(vtk)"
        );
    }
}
