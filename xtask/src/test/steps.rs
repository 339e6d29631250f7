//! Running a step and keeping what it said last.

use std::ffi::OsStr;
use std::fmt;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::tree;

/// How a step ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// Nothing was wrong.
    Passed,
    /// Something was wrong; the text says what.
    Failed(String),
    /// Something that the step needs is missing; the text says what to do.
    NotRun(String),
}

impl fmt::Display for Outcome {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Passed => out.write_str("passed"),
            Self::Failed(text) => write!(out, "FAILED: {text}"),
            Self::NotRun(text) => write!(out, "not run: {text}"),
        }
    }
}

/// A step that has ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Step {
    /// How it ended.
    pub(super) outcome: Outcome,
    /// The closing lines of its test runner.
    pub(super) closing: Vec<String>,
}

impl Step {
    /// Returns the step of a check inside of this program.
    pub(super) fn of(result: Result<(), String>) -> Self {
        let outcome = result.map_or_else(Outcome::Failed, |()| Outcome::Passed);
        Self {
            outcome,
            closing: Vec::new(),
        }
    }

    /// Returns a failed step.
    pub(super) fn failed(text: impl Into<String>) -> Self {
        Self::of(Err(text.into()))
    }

    /// Returns a step that could not run.
    pub(super) fn not_run(text: impl Into<String>) -> Self {
        Self {
            outcome: Outcome::NotRun(text.into()),
            closing: Vec::new(),
        }
    }
}

/// Variable that names the folder of models.
const MODELS: &str = "MSPLINES_MODELS";

/// Returns the folder of models as a path that means the same to every test, whatever folder it
/// runs in.
fn models() -> Option<PathBuf> {
    let models = std::env::var_os(MODELS)?;
    std::env::current_dir().ok().map(|here| here.join(models))
}

/// Runs cargo with these arguments.
pub(super) fn cargo(arguments: &[&str]) -> Step {
    program(Path::new(&cargo_path()), arguments)
}

/// Runs a program in the project's root, passes its output on and keeps the closing lines.
pub(super) fn program(program: &Path, arguments: &[&str]) -> Step {
    let shown = format!("{} {}", name_of(program), arguments.join(" "));
    println!("{shown}");
    let mut command = Command::new(program);
    command
        .args(arguments)
        .current_dir(tree::root())
        .stdin(Stdio::null());
    if let Some(models) = models() {
        command.env(MODELS, models);
    }
    // nextest tells its summary on standard error, cargo test on standard output.
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = match command.spawn() {
        Ok(child) => child,
        Err(error) => return Step::failed(format!("cannot start `{shown}`: {error}")),
    };
    let (output, errors) = (child.stdout.take(), child.stderr.take());
    let closing = std::thread::scope(|scope| {
        let reader = scope.spawn(|| output.map(pass_on).unwrap_or_default());
        let mut closing = errors.map(pass_on).unwrap_or_default();
        closing.extend(reader.join().unwrap_or_default());
        closing
    });
    let outcome = match child.wait() {
        Ok(status) if status.success() => Outcome::Passed,
        Ok(status) => Outcome::Failed(format!("`{shown}` ended with {status}")),
        Err(error) => Outcome::Failed(format!("`{shown}` was lost: {error}")),
    };
    Step { outcome, closing }
}

/// Prints every line of a stream and returns those that close a test run.
fn pass_on(stream: impl std::io::Read) -> Vec<String> {
    let mut closing = Vec::new();
    for line in BufReader::new(stream).split(b'\n').map_while(Result::ok) {
        let line = String::from_utf8_lossy(&line).into_owned();
        println!("{line}");
        if closes_run(&line) {
            closing.push(line);
        }
    }
    closing
}

/// Whether a test runner ends with this line.
fn closes_run(line: &str) -> bool {
    let line = line.trim_start();
    let ran = !line.contains(" 0 passed; 0 failed");
    ran && line.starts_with("test result:")
        || (line.starts_with("Summary [") && line.contains("tests run"))
}

/// Returns the cargo arguments that run tests: nextest where it is installed.
pub(super) fn test_runner() -> Vec<&'static str> {
    if has_nextest() {
        vec!["nextest", "run", "--no-fail-fast", "--status-level", "slow"]
    } else {
        vec![
            "test",
            "--quiet",
            "--no-fail-fast",
            "--lib",
            "--bins",
            "--tests",
        ]
    }
}

/// Returns whether nextest is installed.
pub(super) fn has_nextest() -> bool {
    has_cargo_command("nextest")
}

/// Returns whether cargo knows this command.
pub(super) fn has_cargo_command(name: &str) -> bool {
    succeeds(cargo_path(), &[name, "--version"])
}

/// Returns whether a program starts and ends well, without showing what it says.
pub(super) fn succeeds(program: impl AsRef<OsStr>, arguments: &[&str]) -> bool {
    let mut command = Command::new(program);
    command
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

/// The cargo that runs this program, or the one on the path.
fn cargo_path() -> String {
    std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned())
}

fn name_of(program: &Path) -> String {
    program
        .file_name()
        .map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::{Outcome, Step, closes_run};

    #[test]
    fn the_closing_lines_of_both_runners_are_known() {
        assert!(closes_run(
            "     Summary [   0.011s] 3 tests run: 3 passed, 0 skipped"
        ));
        assert!(closes_run("test result: ok. 3 passed; 0 failed; 0 ignored"));
        assert!(!closes_run(
            "test result: ok. 0 passed; 0 failed; 0 ignored"
        ));
        assert!(!closes_run("test a_test ... ok"));
    }

    #[test]
    fn an_outcome_says_what_to_do() {
        assert_eq!(Step::failed("x").outcome.to_string(), "FAILED: x");
        let missing = Step::not_run("clippy is missing").outcome;
        assert_eq!(missing, Outcome::NotRun("clippy is missing".to_owned()));
        assert_eq!(missing.to_string(), "not run: clippy is missing");
    }
}
