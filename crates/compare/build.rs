//! Records which compiler and which commit the tool is built from.

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let compiler = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    let rustc = output(&compiler, &["--version"]).unwrap_or_else(|| "unknown".to_owned());
    let commit = output("git", &["rev-parse", "--short=12", "HEAD"]);
    println!("cargo::rustc-env=MSPLINES_RUSTC={rustc}");
    println!(
        "cargo::rustc-env=MSPLINES_COMMIT={}",
        commit.as_deref().unwrap_or("unknown")
    );
    // Only paths that exist: a missing one would have the script run again on every build.
    for path in ["HEAD".to_owned()]
        .into_iter()
        .chain(output("git", &["symbolic-ref", "HEAD"]))
    {
        if let Some(file) = output("git", &["rev-parse", "--git-path", &path])
            && Path::new(&file).exists()
        {
            println!("cargo::rerun-if-changed={file}");
        }
    }
}

fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (output.status.success() && !text.is_empty()).then_some(text)
}
