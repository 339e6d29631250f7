//! Shows what a comparison with other libraries measured.

use std::path::PathBuf;

use msplines_compare::peers::{FILE, Peers, markdown, terminal};

use crate::tree;

/// The page that holds the tables.
const PAGE: &str = "docs/peers.md";
const MARKS: [&str; 2] = ["<!-- peers:begin -->", "<!-- peers:end -->"];

/// Arguments of the second half of `cargo xtask peers`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Folder of peers.json.
    #[arg(long, value_name = "DIR", default_value = "report")]
    out: PathBuf,
    /// Write the tables into docs/peers.md as well.
    #[arg(long)]
    write_docs: bool,
}

/// Shows the tables and writes them.
pub(crate) fn run(args: &Args) -> Result<(), String> {
    let file = args.out.join(FILE);
    let peers = Peers::read(&file)?;
    print!("{}", terminal(&peers));
    println!("{}", file.display());
    if args.write_docs {
        tree::rewrite(PAGE, MARKS, &markdown(&peers))?;
        println!("wrote {PAGE}");
    }
    Ok(())
}
