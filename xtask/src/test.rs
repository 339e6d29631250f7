//! Every check and every test, each step with its outcome, to the end.

mod browser;
mod debian;
mod draw;
mod python;
pub(crate) mod reference;
mod steps;

use std::env;

use steps::{Outcome, Step};

use crate::{harness, papers, tidy};

/// Arguments of `cargo xtask test`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Run only the steps whose name contains one of these words.
    steps: Vec<String>,
}

/// Cargo arguments that name the packages: without the C++ bindings where they cannot be built.
///
/// Every step names the same packages, because another choice enables other features of common
/// dependencies, and all of them would be compiled again.
fn packages() -> Vec<&'static str> {
    if reference::is_ready() {
        vec!["--workspace"]
    } else {
        vec!["--workspace", "--exclude", reference::PACKAGE]
    }
}

/// Arguments of the smoke reproduction: generated surfaces, results apart from those of real runs.
const SMOKE: [&str; 5] = ["repro", "hou2017", "generated", "--out", "target/smoke"];

/// A step's name and what it does.
type Named = (&'static str, fn() -> Step);

/// All steps, from the quickest to tell to the slowest.
const STEPS: [Named; 9] = [
    ("format", format),
    ("tidy", || Step::of(tidy::run())),
    ("papers", || Step::of(papers::check())),
    ("clippy", clippy),
    ("tests", tests),
    ("doc-tests", doc_tests),
    ("reference", || reference::run(packages(), with_harness)),
    ("smoke", || reproduce(&["--fresh"])),
    // The rows that the step before has finished are not run again.
    ("browser", || browser::run(|| reproduce(&[]))),
];

/// Runs the steps and prints what came of them.
pub(crate) fn run(args: &Args) -> Result<(), String> {
    let wanted = |name: &str| args.steps.is_empty() || args.steps.iter().any(|w| name.contains(w));
    let mut done = Vec::new();
    for (name, step) in STEPS.iter().filter(|(name, _)| wanted(name)) {
        println!("\n=== {name}");
        done.push((*name, step()));
    }
    if done.is_empty() {
        let names: Vec<_> = STEPS.iter().map(|(name, _)| *name).collect();
        return Err(format!("no such step; there are {}", names.join(", ")));
    }
    conclude(&done)
}

/// Prints one line per step, then the closing lines of the test runners.
fn conclude(done: &[(&str, Step)]) -> Result<(), String> {
    println!("\n=== outcome");
    for (name, step) in done {
        println!("{name:<10} {}", step.outcome);
    }
    for line in done.iter().flat_map(|(_, step)| &step.closing) {
        println!("{line}");
    }
    let strict = env::var("CI").is_ok_and(|value| value == "true");
    let bad = |step: &Step| match step.outcome {
        Outcome::Passed => false,
        Outcome::Failed(_) => true,
        Outcome::NotRun(_) => strict,
    };
    let failed: Vec<_> = done
        .iter()
        .filter(|(_, step)| bad(step))
        .map(|(name, _)| *name)
        .collect();
    if failed.is_empty() {
        Ok(())
    } else {
        Err(format!("not passed: {}", failed.join(", ")))
    }
}

fn format() -> Step {
    if !steps::has_cargo_command("fmt") {
        return Step::not_run("rustfmt is missing: rustup component add rustfmt");
    }
    steps::cargo(&["fmt", "--all", "--", "--check", "-l"])
}

fn clippy() -> Step {
    if !steps::has_cargo_command("clippy") {
        return Step::not_run("clippy is missing: rustup component add clippy");
    }
    let mut arguments = vec!["clippy", "--quiet", "--all-targets"];
    arguments.extend(packages());
    arguments.extend(["--", "-D", "warnings"]);
    steps::cargo(&arguments)
}

/// Unit, property, contract and integration tests.
fn tests() -> Step {
    let mut arguments = steps::test_runner();
    arguments.extend(packages());
    if steps::has_nextest() {
        arguments.extend(["--filterset", reference::OTHERS]);
    } else {
        // They have a step of their own, which installs what they ask.
        arguments.extend(["--exclude", reference::PACKAGE]);
    }
    steps::cargo(&arguments)
}

fn doc_tests() -> Step {
    let mut arguments = vec!["test", "--quiet", "--doc"];
    arguments.extend(packages());
    steps::cargo(&arguments)
}

/// The generated rows, through the same program that reproduces all tables.
fn reproduce(more: &[&str]) -> Step {
    with_harness(&[&SMOKE, more].concat())
}

/// Runs the harness as the tests build it: in the release profile all would be compiled once more.
fn with_harness(arguments: &[&str]) -> Step {
    let mut build = vec!["test", "--quiet", "--no-run", "--test", harness::TEST];
    build.extend(packages());
    let built = steps::cargo(&build);
    if built.outcome != Outcome::Passed {
        return built;
    }
    match harness::of_tests() {
        Ok(program) => steps::program(&program, arguments),
        Err(error) => Step::failed(error),
    }
}
