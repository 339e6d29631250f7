//! Compares with other libraries on the same work: starts the program that measures, then the one that
//! shows what it found.

mod environment;

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use crate::harness;
use crate::test::reference;
use crate::tree::root;

/// Variables that keep a BLAS and our own pool on one thread; a BLAS reads them before `main` starts.
const ONE_THREAD: [&str; 3] = [
    "OPENBLAS_NUM_THREADS",
    "OMP_NUM_THREADS",
    "RAYON_NUM_THREADS",
];
/// What is written.
const FILE: &str = "peers.json";

/// Arguments of `cargo xtask peers`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Only the tasks whose name contains one of these words: factor, surface, middle, large, pursuit, subdivision,
    /// multilevel, least-squares.
    tasks: Vec<String>,
    /// Folder of the models; $MSPLINES_MODELS, else generated surfaces of their sizes.
    #[arg(long, value_name = "DIR")]
    models: Option<PathBuf>,
    /// Folder with the header of ddemidov's mba.
    #[arg(long, value_name = "DIR")]
    mba: Option<PathBuf>,
    /// Repetitions of short tasks; long ones have three.
    #[arg(long, value_name = "N", default_value_t = 5)]
    rounds: usize,
    /// Folder for peers.json.
    #[arg(long, value_name = "DIR", default_value = "report")]
    out: PathBuf,
    /// Show what is stored there, and measure nothing.
    #[arg(long)]
    stored: bool,
    /// Write the tables into docs/peers.md as well.
    #[arg(long)]
    write_docs: bool,
}

/// Measures, shows the tables and writes them.
pub(crate) fn run(args: &Args) -> Result<(), String> {
    let out = env::current_dir()
        .map_err(|error| format!("there is no working folder: {error}"))?
        .join(&args.out);
    if !args.stored {
        fs::create_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?;
        measure(args, &out.join(FILE))?;
    }
    let mut shown = vec![OsString::from("--out"), out.into_os_string()];
    if args.write_docs {
        shown.push("--write-docs".into());
    }
    harness::run("peers", &shown)
}

fn measure(args: &Args, file: &Path) -> Result<(), String> {
    reference::ready()?;
    let environment = environment::prepare()?;
    let mut given: Vec<OsString> = vec![environment.python.into(), file.into()];
    given.extend(args.tasks.iter().map(OsString::from));
    let models = args.models.clone();
    let models = models.or_else(|| env::var_os("MSPLINES_MODELS").map(PathBuf::from));
    for (option, folder) in [("--models", &models), ("--mba", &args.mba)] {
        if let Some(folder) = folder {
            let path = fs::canonicalize(folder)
                .map_err(|error| format!("{option} {}: {error}", folder.display()))?;
            given.extend([OsString::from(option), path.into_os_string()]);
        }
    }
    let rounds = args.rounds.max(1).to_string();
    given.extend(["--rounds", &rounds].map(OsString::from));
    for (package, reason) in environment.missing {
        let told = format!("{package}={reason}");
        given.extend(["--missing", &told].map(OsString::from));
    }
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo)
        .args(["run", "--release", "--quiet", "--package"])
        .args([reference::PACKAGE, "--bin", "peers", "--"])
        .args(given)
        .envs(ONE_THREAD.map(|name| (name, "1")))
        .current_dir(root())
        .status()
        .map_err(|error| format!("cargo cannot be started: {error}"))?;
    if status.success() {
        Ok(())
    } else {
        Err(format!("the comparison ended with {status}"))
    }
}
