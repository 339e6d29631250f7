//! The project's commands that run the methods. `cargo xtask COMMAND` builds this program and starts it,
//! so that its other commands need not wait for the methods to be compiled.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a command's output is what it is for"
)]

mod battery;
mod kills;
mod peers;
mod references;
mod repro;
mod tree;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// The project's commands that run the methods.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", version, about)]
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
    /// Kill the programs at random moments, and check that no file is damaged and that work goes on.
    Kills(kills::Args),
    /// Show what a comparison with other libraries measured.
    Peers(peers::Args),
    /// Write what comparisons with other people's code found into docs/references.md.
    References(references::Args),
}

fn main() -> ExitCode {
    let outcome = match Cli::parse().command {
        Command::Repro(args) => repro::run(&args),
        Command::Battery(args) => battery::run(&args),
        Command::Kills(args) => kills::run(&args),
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
