//! The project's commands, run as `cargo xtask COMMAND`.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a command's output is what it is for"
)]

mod fuzz;
mod harness;
mod papers;
mod peers;
mod test;
mod tidy;
mod tree;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// The project's commands.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", version, about)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Reproduce the tables and figures of the papers.
    #[command(disable_help_flag = true)]
    Repro(Given),
    /// Run every method on inputs and options that are wrong on purpose.
    #[command(disable_help_flag = true)]
    Battery(Given),
    /// Run every check and every test; end non-zero if one fails.
    Test(test::Args),
    /// Run the fuzz targets for a bounded time each.
    Fuzz(fuzz::Args),
    /// Kill the programs at random moments, and check that no file is damaged and that work goes on.
    #[command(disable_help_flag = true)]
    Kills(Given),
    /// Check the invariants of ARCHITECTURE.md.
    Tidy,
    /// Collect the citations of the code into the tables of docs/papers.
    Papers(papers::Args),
    /// Compare times and results with other libraries on the same work.
    Peers(peers::Args),
    /// Write what comparisons with other people's code found into docs/references.md.
    #[command(disable_help_flag = true)]
    References(Given),
}

/// What another program reads.
#[derive(clap::Args)]
struct Given {
    /// Options; `--help` tells them.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

fn main() -> ExitCode {
    let outcome = match Cli::parse().command {
        Command::Repro(given) => harness::run("repro", &given.arguments),
        Command::Battery(given) => harness::run("battery", &given.arguments),
        Command::Test(args) => test::run(&args),
        Command::Fuzz(args) => fuzz::run(&args),
        Command::Kills(given) => harness::run("kills", &given.arguments),
        Command::Tidy => tidy::run(),
        Command::Papers(args) => papers::run(&args),
        Command::Peers(args) => peers::run(&args),
        Command::References(given) => harness::run("references", &given.arguments),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(text) => {
            eprintln!("error: {text}");
            ExitCode::FAILURE
        }
    }
}
