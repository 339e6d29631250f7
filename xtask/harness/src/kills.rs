//! Kills the programs at random moments and checks what they leave: old files or new ones, whole.
//!
//! Three phases: fits of every method with several outputs and a record, a small reproduction with
//! its store, and the writing of its report. As the programs are deterministic, what is left is
//! compared with the bytes of runs that nobody disturbed; what holds times is compared without them.

mod fits;
mod moment;
mod reproduction;
mod tally;

use std::path::{Path, PathBuf};

use msplines_compare::report::replace;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

use tally::Tally;

/// Arguments of `cargo xtask kills`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Kills in all: three quarters of them for fits, the rest for reproductions and reports.
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..))]
    count: u32,
    /// Seed of the moments.
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
    /// The program `msplines`; the one beside this program where absent.
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
    /// Folder for kills.json.
    #[arg(long, value_name = "DIR", default_value = "target/kills")]
    out: PathBuf,
}

/// What is written.
#[derive(Serialize)]
struct Found<'a> {
    schema: &'a str,
    seed: u64,
    count: u32,
    phases: &'a [Tally],
}

/// Kills, checks, prints a table and fails if anything was damaged.
pub(crate) fn run(args: &Args) -> Result<(), String> {
    let program = program(args)?;
    let this = std::env::current_exe().map_err(|e| format!("this program has no path: {e}"))?;
    let folder = tempfile::Builder::new()
        .prefix("msplines-kills-")
        .tempdir()
        .map_err(|e| format!("no temporary folder: {e}"))?;
    let mut random = Pcg64Mcg::seed_from_u64(args.seed);
    let [of_fits, of_rows, of_reports] = shares(args.count);
    let mut phases = fits::run(&program, &folder.path().join("fits"), of_fits, &mut random)?;
    let place = folder.path().join("reproduction");
    phases.extend(reproduction::run(
        &this,
        &place,
        [of_rows, of_reports],
        &mut random,
    )?);
    print!("{}", tally::table(&phases));
    let path = args.out.join("kills.json");
    write(&path, args, &phases)?;
    println!("wrote {}", path.display());
    let faults: Vec<String> = phases.iter().flat_map(|p| p.faults.clone()).collect();
    if faults.is_empty() {
        Ok(())
    } else {
        Err(faults.join("\nerror: "))
    }
}

/// Returns the kills of fits, of reproductions and of reports.
fn shares(count: u32) -> [u32; 3] {
    let eighth = count / 8;
    [count - 2 * eighth, eighth, eighth]
}

fn program(args: &Args) -> Result<PathBuf, String> {
    let this = std::env::current_exe().map_err(|e| format!("this program has no path: {e}"))?;
    let beside = || this.with_file_name(format!("msplines{}", std::env::consts::EXE_SUFFIX));
    let program = args.program.clone().unwrap_or_else(beside);
    if program.is_file() {
        return Ok(program);
    }
    Err(format!(
        "{} is missing: run `cargo build --release -p msplines-cli`, or name the program with --program",
        program.display()
    ))
}

fn write(path: &Path, args: &Args, phases: &[Tally]) -> Result<(), String> {
    let found = Found {
        schema: "msplines.kills/1",
        seed: args.seed,
        count: args.count,
        phases,
    };
    let bytes = serde_json::to_vec_pretty(&found).map_err(|e| e.to_string())?;
    replace(path, &bytes).map_err(|e| format!("{}: {e}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::shares;

    #[test]
    fn every_kill_belongs_to_a_phase() {
        assert_eq!(shares(200), [150, 25, 25]);
        assert_eq!(shares(1), [1, 0, 0]);
        assert_eq!(shares(15).iter().sum::<u32>(), 15);
    }
}
