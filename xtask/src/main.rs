//! The project's commands, run as `cargo xtask COMMAND`.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a command's output is what it is for"
)]

mod battery;
mod fuzz;
mod kills;
mod papers;
mod peers;
mod references;
mod repro;
mod test;
mod tidy;
mod tree;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// The project's commands.
#[derive(Parser)]
#[command(name = "cargo xtask", version, about)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Reproduce the tables and figures of the papers.
    Repro(repro::Args),
    /// Run every method on inputs and options that are wrong on purpose.
    Battery(battery::Args),
    /// Run every check and every test; end non-zero if one fails.
    Test(test::Args),
    /// Run the fuzz targets for a bounded time each.
    Fuzz(fuzz::Args),
    /// Kill the programs at random moments, and check that no file is damaged and that work goes on.
    Kills(kills::Args),
    /// Check the invariants of ARCHITECTURE.md.
    Tidy,
    /// Collect the citations of the code into the tables of docs/papers.
    Papers(papers::Args),
    /// Compare times and results with other libraries on the same work.
    Peers(peers::Args),
    /// Write what comparisons with other people's code found into docs/references.md.
    References(references::Args),
}

fn main() -> ExitCode {
    let outcome = match Cli::parse().command {
        Command::Repro(args) => repro::run(&args),
        Command::Battery(args) => battery::run(&args),
        Command::Test(args) => test::run(&args),
        Command::Fuzz(args) => fuzz::run(&args),
        Command::Kills(args) => kills::run(&args),
        Command::Tidy => tidy::run(),
        Command::Papers(args) => papers::run(&args),
        Command::Peers(args) => peers::run(&args),
        Command::References(args) => references::run(&args),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(text) => {
            eprintln!("error: {text}");
            ExitCode::FAILURE
        }
    }
}
