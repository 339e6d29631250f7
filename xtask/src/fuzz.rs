//! Every fuzz target for a bounded time, with its executions and finds.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::tree;

/// Arguments of `cargo xtask fuzz`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// How long each target runs.
    #[arg(long, default_value_t = 60, value_name = "N")]
    seconds: u32,
    /// `address` also watches the memory of `unsafe` code, and is several times slower.
    #[arg(long, default_value = "none", value_parser = ["none", "address"])]
    sanitizer: String,
    /// Run only these targets.
    targets: Vec<String>,
}

/// The package, its targets, seeds and dictionaries.
const PACKAGE: &str = "tests/fuzz";
/// Programs, corpora that grow and finds.
const OUTPUT: &str = "target/fuzz";
/// Seconds after which one input is a hang, on a busy machine.
const HANG: u32 = 20;
/// Most memory in MiB; the targets themselves count bytes per byte of input.
const MEMORY: u32 = 2048;
/// Line of libFuzzer that tells the executions.
const EXECUTED: &str = "stat::number_of_executed_units:";

/// What came of one target.
struct Outcome {
    executions: u64,
    /// Files of inputs that broke a law.
    finds: Vec<PathBuf>,
    /// What was said last, where there is a find.
    said: String,
}

/// Builds the targets, runs one after another and prints what came of them.
pub(crate) fn run(args: &Args) -> Result<(), String> {
    let root = tree::root();
    let targets = chosen(&args.targets, &all_targets(&root)?)?;
    build(&root, &args.sanitizer)?;
    let programs = root.join(OUTPUT).join(host()?).join("release");
    println!("{:<14} {:>12} {:>8} finds", "target", "executions", "per s");
    let (mut executions, mut broken) = (0, Vec::new());
    for target in targets {
        let outcome = fuzz(&root, &programs, &target, args.seconds)?;
        let rate = outcome.executions / u64::from(args.seconds.max(1));
        let finds = outcome.finds.len();
        println!("{target:<14} {:>12} {rate:>8} {finds}", outcome.executions);
        executions += outcome.executions;
        if finds > 0 {
            println!("{}", outcome.said);
            broken.extend(outcome.finds);
        }
    }
    println!("{:<14} {executions:>12}", "all");
    if broken.is_empty() {
        return Ok(());
    }
    let shown: Vec<_> = broken
        .iter()
        .map(|find| find.display().to_string())
        .collect();
    Err(format!(
        "{} inputs break a law; give each to the program of its target: {}",
        broken.len(),
        shown.join(", ")
    ))
}

/// Returns the names of all targets, sorted.
fn all_targets(root: &Path) -> Result<Vec<String>, String> {
    let folder = root.join(PACKAGE).join("targets");
    let told = |error| format!("cannot read {}: {error}", folder.display());
    let mut names = Vec::new();
    for entry in fs::read_dir(&folder).map_err(told)? {
        let path = entry.map_err(told)?.path();
        names.extend(
            path.file_stem()
                .map(|stem| stem.to_string_lossy().into_owned()),
        );
    }
    names.sort();
    Ok(names)
}

/// Returns the targets that are asked for, all where none is.
fn chosen(asked: &[String], all: &[String]) -> Result<Vec<String>, String> {
    match asked.iter().find(|name| !all.contains(name)) {
        Some(unknown) => Err(format!(
            "no target `{unknown}`; there are {}",
            all.join(", ")
        )),
        None if asked.is_empty() => Ok(all.to_vec()),
        None => Ok(asked.to_vec()),
    }
}

fn build(root: &Path, sanitizer: &str) -> Result<(), String> {
    let mut command = Command::new("cargo");
    command
        .args(["+nightly", "fuzz", "build", "--fuzz-dir", PACKAGE])
        .args(["--target-dir", OUTPUT, "--sanitizer", sanitizer])
        .current_dir(root)
        // The toolchain of this program would win over the one that is asked for.
        .env_remove("RUSTUP_TOOLCHAIN")
        .env_remove("CARGO");
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(_) | Err(_) => Err(
            "the targets were not built; they need `rustup toolchain install nightly` and \
             `cargo install cargo-fuzz`"
                .to_owned(),
        ),
    }
}

/// Returns the platform that programs are built for, which is part of their path.
fn host() -> Result<String, String> {
    let said = Command::new("rustc").arg("-vV").output();
    let said = said.map_err(|error| format!("rustc does not run: {error}"))?;
    let said = String::from_utf8_lossy(&said.stdout).into_owned();
    let host = said.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned)
        .ok_or_else(|| "rustc tells no host".to_owned())
}

/// Runs one target, on the seeds and on what earlier runs found worth keeping.
fn fuzz(root: &Path, programs: &Path, target: &str, seconds: u32) -> Result<Outcome, String> {
    let folder = |name: &str| -> Result<PathBuf, String> {
        let path = root.join(OUTPUT).join(name).join(target);
        fs::create_dir_all(&path).map_err(|e| format!("cannot make {}: {e}", path.display()))?;
        Ok(path)
    };
    let (grown, finds) = (folder("corpus")?, folder("finds")?);
    let mut command = Command::new(programs.join(target));
    command
        .arg(format!("-max_total_time={seconds}"))
        .arg(format!("-timeout={HANG}"))
        .arg(format!("-rss_limit_mb={MEMORY}"))
        .arg("-print_final_stats=1")
        .arg(format!("-artifact_prefix={}/", finds.display()));
    let words = root
        .join(PACKAGE)
        .join(format!("dictionaries/{target}.dict"));
    if words.is_file() {
        command.arg(format!("-dict={}", words.display()));
    }
    // What is new goes to the first folder.
    command.arg(grown);
    let seeds = root.join(PACKAGE).join("corpus").join(target);
    if seeds.is_dir() {
        command.arg(seeds);
    }
    let ran = command.stdin(Stdio::null()).output();
    let ran = ran.map_err(|error| format!("target {target} does not run: {error}"))?;
    let said = String::from_utf8_lossy(&ran.stderr);
    let mut found = Vec::new();
    if !ran.status.success() {
        let entries = fs::read_dir(&finds).map_err(|e| e.to_string())?;
        found.extend(entries.filter_map(|entry| Some(entry.ok()?.path())));
        if found.is_empty() {
            return Err(format!("target {target} failed: {}", last_lines(&said)));
        }
    }
    Ok(Outcome {
        executions: executions(&said),
        finds: found,
        said: last_lines(&said),
    })
}

/// Returns the number of executions that libFuzzer tells at its end.
fn executions(said: &str) -> u64 {
    let count = said.lines().find_map(|line| line.strip_prefix(EXECUTED));
    count
        .and_then(|count| count.trim().parse().ok())
        .unwrap_or(0)
}

fn last_lines(said: &str) -> String {
    const SHOWN: usize = 40;
    let lines: Vec<_> = said.lines().collect();
    lines[lines.len().saturating_sub(SHOWN)..].join("\n")
}

#[cfg(test)]
mod tests {
    use super::{all_targets, chosen, executions};
    use crate::tree;

    #[test]
    fn executions_are_read_from_what_the_fuzzer_says() {
        let said = "Done 7 runs\nstat::number_of_executed_units: 1234\nstat::x: 5\n";
        assert_eq!(executions(said), 1234);
        assert_eq!(executions("nothing"), 0);
    }

    #[test]
    fn an_unknown_target_is_told_with_those_there_are() {
        let all = ["obj".to_owned(), "ply".to_owned()];
        assert_eq!(chosen(&[], &all).expect("all"), all);
        assert_eq!(chosen(&all[1..], &all).expect("one"), &all[1..]);
        let error = chosen(&["x".to_owned()], &all).expect_err("unknown");
        assert_eq!(error, "no target `x`; there are obj, ply");
    }

    #[test]
    fn every_target_is_a_program_of_the_package_and_has_seeds() {
        let root = tree::root();
        let manifest = root.join("tests/fuzz/Cargo.toml");
        let manifest = std::fs::read_to_string(manifest).expect("a manifest");
        for target in all_targets(&root).expect("targets") {
            assert!(
                manifest.contains(&format!("path = \"targets/{target}.rs\"")),
                "{target}"
            );
            assert!(
                root.join("tests/fuzz/corpus").join(&target).is_dir(),
                "{target}"
            );
        }
    }
}
