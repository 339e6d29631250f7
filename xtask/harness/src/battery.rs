//! The hostile battery: runs the program on everything that is wrong on purpose.

use std::path::PathBuf;
use std::process::Command;
use std::time::Instant;

use msplines_compare::battery::{self, Battery, Extent, page};
use msplines_compare::display::{Display, Verbosity};
use msplines_compare::report::replace;

use crate::tree::root;

/// How the cases ended when that was last accepted.
const RECORDED: &str = "data/battery.json";
/// The page.
const PAGE: &str = "docs/battery.md";

/// Arguments of `cargo xtask battery`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Folder of the models; $MSPLINES_MODELS, else data/models, where absent.
    #[arg(long, value_name = "DIR")]
    models: Option<PathBuf>,
    /// The program; that of the release profile, which is built first, where absent.
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
    /// Cases at the same time.
    #[arg(long, value_name = "N", default_value_t = 2)]
    jobs: usize,
    /// File for how every case ended, as JSON.
    #[arg(long, value_name = "FILE", default_value = "target/battery.json")]
    out: PathBuf,
    /// Record how the cases ended, and write the page; the broken files must be there.
    #[arg(long)]
    write_docs: bool,
}

/// Runs the battery, prints its table and says what is broken or has changed.
pub(crate) fn run(args: &Args) -> Result<(), String> {
    let started = Instant::now();
    let root = root();
    let files = files(args);
    if args.write_docs && files.is_none() {
        return Err("--write-docs needs the broken files: give --models DIR".to_owned());
    }
    let battery = Battery {
        program: program(args)?,
        files,
        jobs: args.jobs,
        extent: Extent::Whole,
    };
    let rows =
        battery::run(&battery, &Display::new(Verbosity::Normal)).map_err(|e| e.to_string())?;
    println!("{}", page::terminal(&rows));
    println!(
        "{} cases in {:.0} s",
        rows.len(),
        started.elapsed().as_secs_f64()
    );
    let mut written = vec![(root.join(&args.out), battery::json(&rows))];
    let recorded = battery::recorded(&root.join(RECORDED)).unwrap_or_default();
    let faults = battery::faults(&rows);
    let mut wrong = faults.clone();
    if args.write_docs {
        written.push((root.join(RECORDED), battery::json(&rows)));
        written.push((root.join(PAGE), page::markdown(&rows)));
    } else {
        wrong.extend(battery::changes(&rows, &recorded, Extent::Whole));
    }
    for (path, text) in written {
        replace(&path, text.as_bytes()).map_err(|e| format!("{}: {e}", path.display()))?;
        println!("wrote {}", path.display());
    }
    if wrong.is_empty() {
        Ok(())
    } else {
        Err(wrong.join("\nerror: "))
    }
}

/// Returns the folder of broken files, if there is one.
fn files(args: &Args) -> Option<PathBuf> {
    let given = args
        .models
        .clone()
        .or_else(|| std::env::var_os("MSPLINES_MODELS").map(PathBuf::from));
    let folder = given
        .unwrap_or_else(|| root().join("data/models"))
        .join("hostile");
    let folder = std::path::absolute(folder).ok()?;
    folder.is_dir().then_some(folder)
}

fn program(args: &Args) -> Result<PathBuf, String> {
    if let Some(program) = &args.program {
        return std::path::absolute(program).map_err(|e| format!("{}: {e}", program.display()));
    }
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let built = Command::new(cargo)
        .args(["build", "--quiet", "--release", "--package", "msplines-cli"])
        .current_dir(root())
        .status();
    if !built
        .map_err(|e| format!("cannot start cargo: {e}"))?
        .success()
    {
        return Err("the program cannot be built".to_owned());
    }
    // This program lies beside the other.
    let here = std::env::current_exe().map_err(|e| format!("this program has no path: {e}"))?;
    Ok(here.with_file_name(format!("msplines{}", std::env::consts::EXE_SUFFIX)))
}
