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

#[cfg(test)]
mod tests {
    use clap::{Command, CommandFactory};
    use msplines_compare::battery::is_tried;

    use crate::arguments::Arguments;

    /// Collects the options of a command that no case of the battery tries.
    fn untried(command: &Command, path: &str, found: &mut Vec<String>) {
        for inner in command.get_subcommands() {
            let path = format!("{path} {}", inner.get_name());
            untried(inner, path.trim_start(), found);
        }
        let of_common = |name: &str| is_tried("info", name);
        let options = command
            .get_arguments()
            .filter_map(|argument| argument.get_long());
        let names = options.map(|name| format!("--{name}"));
        let forgotten = names.filter(|name| !is_tried(path, name) && !of_common(name));
        found.extend(forgotten.map(|name| format!("{path} {name}")));
    }

    #[test]
    fn every_option_is_tried_beyond_its_limits() {
        let mut found = Vec::new();
        untried(&Arguments::command(), "", &mut found);
        let known = ["--output", "--report"];
        found.retain(|line| !known.iter().any(|option| line.ends_with(option)));
        assert!(found.is_empty(), "add them to options.toml: {found:?}");
    }
}
