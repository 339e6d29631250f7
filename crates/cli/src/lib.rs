//! The program `msplines`: fits a spline to a mesh, evaluates it, and says how good it is.
//!
//! It is a library with a `main` of a few lines, so that its command line can be read without running it.
//!
//! Exit codes: 0 a result (converged, stalled or out of iterations, with a warning), 2 the command
//! cannot be meant so, 3 the input is refused, 4 the method cannot take this input, 5 stopped early
//! with the result so far written and marked.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a program's output is what it is for"
)]

mod arguments;
mod commands;
mod conformal;
mod info;
mod interrupt;
mod manifold;
mod powell_sabin;
mod session;
mod solid;
mod t_spline;

use std::process::ExitCode;
use std::time::Instant;

pub use arguments::Arguments;

use arguments::Command;
use session::Session;

/// Does what the command line asks for, prints what came of it, and returns the exit code.
///
/// Times in records count from `process_start`.
#[must_use]
pub fn run(arguments: &Arguments, process_start: Instant) -> ExitCode {
    let outcome = Session::open(&arguments.common, process_start).and_then(|session| {
        match &arguments.command {
            Command::Info(info) => info::run(info, &session),
            Command::Fit { method } => commands::fit(method, &session),
            Command::Decompose(decompose) => commands::decompose(decompose, &session),
            Command::Edit(edit) => commands::edit(edit, &session),
            Command::Combine(combine) => commands::combine(combine, &session),
            Command::Evaluate(evaluate) => commands::evaluate(evaluate, &session),
            Command::Conformal(conformal) => conformal::run(conformal, &session),
            Command::Deform(deform) => commands::deform(deform, &session),
            Command::Reshape(reshape) => commands::reshape(reshape, &session),
        }
    });
    match outcome {
        Ok(code) => ExitCode::from(code),
        Err(failure) => {
            eprintln!("error: {}", failure.text);
            ExitCode::from(failure.code)
        }
    }
}
