//! Reproduces the tables and figures of the papers.

/// Arguments of `cargo xtask repro`.
#[derive(clap::Args)]
pub(crate) struct Args {}

/// Runs the reproduction.
pub(crate) fn run(_args: &Args) -> Result<(), String> {
    Err("there is no experiment to reproduce yet".to_owned())
}
