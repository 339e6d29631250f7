//! The program `msplines`: fits a spline to a mesh, evaluates it, and says how good it is.
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

use clap::Parser;

use arguments::{Arguments, Command};
use session::Session;

fn main() -> ExitCode {
    let process_start = Instant::now();
    let arguments = Arguments::parse();
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
