//! The program `msplines`.

use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use msplines_cli::Arguments;

fn main() -> ExitCode {
    let process_start = Instant::now();
    msplines_cli::run(&Arguments::parse(), process_start)
}
