//! What the commands say when they cannot do what is asked.

use std::process::{Command, Output};

fn harness(arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_msplines-harness");
    let ran = Command::new(program).args(arguments).output();
    ran.expect("the program of this package")
}

#[test]
fn what_is_not_there_is_told_with_what_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().to_str().expect("a path of letters");
    for (arguments, told) in [
        (vec!["repro", "nobody1999", "--out", out], "hou2017"),
        (vec!["repro", "hou2017", "table99", "--out", out], "table1"),
        (vec!["peers", "--out", out], "peers.json"),
        (vec!["references", "--partial"], "--check"),
        (
            vec!["kills", "--program", "nowhere"],
            "cargo build --release -p msplines-cli",
        ),
        (vec!["kills", "--count", "0"], "--count"),
        (vec!["fly"], "unrecognized subcommand"),
    ] {
        let ran = harness(&arguments);
        let said = String::from_utf8_lossy(&ran.stderr);
        assert!(!ran.status.success(), "{arguments:?}");
        assert!(said.contains(told), "{arguments:?}: {said}");
    }
}

#[test]
fn help_is_that_of_the_project_s_commands() {
    let ran = harness(&["repro", "--help"]);
    let said = String::from_utf8_lossy(&ran.stdout);
    assert!(ran.status.success());
    assert!(
        said.contains("cargo xtask repro") && said.contains("--only-failed"),
        "{said}"
    );
}
