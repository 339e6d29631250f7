//! The report in a browser: `tests/browser` opens what the generated rows give and uses it.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use super::debian;
use super::steps::{self, Outcome, Step};
use crate::tree;

/// Variable that names the browser; the test itself reads it as well.
const BROWSER: &str = "CHROMIUM";
/// Where Debian's package puts it.
const DEBIAN_BROWSER: &str = "/usr/bin/chromium";
const NODE: &str = "node";
const NPM: &str = if cfg!(windows) { "npm.cmd" } else { "npm" };

/// The report of the smoke reproduction.
const REPORT: &str = "target/smoke/index.html";
/// Where the test runs, apart from its source, and what it takes along.
const PLACE: &str = "target/browser-test";
const FILES: [&str; 3] = ["package.json", "package-lock.json", "report.test.mjs"];
/// Installs exactly what the lock file names.
const INSTALL: [&str; 7] = [
    "--prefix",
    PLACE,
    "ci",
    "--ignore-scripts",
    "--no-audit",
    "--no-fund",
    "--prefer-offline",
];

/// Runs the test on a report of the generated rows, which `repro` brings up to date.
pub(super) fn run(repro: impl FnOnce() -> Step) -> Step {
    debian::install_if_allowed(&missing_packages());
    let missing = missing_packages();
    if !missing.is_empty() {
        return Step::not_run(format!(
            "apt-get install {}, or name a Chromium in ${BROWSER}",
            missing.join(" ")
        ));
    }
    let reported = repro();
    if reported.outcome != Outcome::Passed {
        return reported;
    }
    if !tree::root().join(REPORT).is_file() {
        return Step::failed(format!("no report at {REPORT}"));
    }
    if let Err(error) = copy_test() {
        return Step::failed(format!("cannot copy the test to {PLACE}: {error}"));
    }
    if steps::program(Path::new(NPM), &INSTALL).outcome != Outcome::Passed {
        return Step::not_run("npm could not install playwright-core; it needs the npm registry");
    }
    let script = format!("{PLACE}/report.test.mjs");
    let shots = format!("{PLACE}/screenshots");
    steps::program(Path::new(NODE), &[&script, REPORT, &shots])
}

fn copy_test() -> std::io::Result<()> {
    let (from, to) = (tree::root().join("tests/browser"), tree::root().join(PLACE));
    fs::create_dir_all(&to)?;
    for file in FILES {
        fs::copy(from.join(file), to.join(file))?;
    }
    Ok(())
}

/// Returns the Debian packages of what is missing.
fn missing_packages() -> Vec<&'static str> {
    let browser = env::var_os(BROWSER).map_or_else(|| DEBIAN_BROWSER.into(), PathBuf::from);
    let has = |program: &str| steps::succeeds(program, &["--version"]);
    let tools = [
        ("chromium", browser.is_file()),
        ("nodejs", has(NODE)),
        ("npm", has(NPM)),
    ];
    let missing = tools.into_iter().filter(|(_, is_there)| !is_there);
    missing.map(|(package, _)| package).collect()
}
