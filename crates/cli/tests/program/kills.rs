//! What a killed program leaves: old files or new ones, whole, and nothing that stops the next run.
//!
//! The short version of `cargo xtask kills`, on two methods.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use msplines_common::mesh::shapes;

use crate::workbench::Workbench;

/// Six kills of each fit.
const FITS: [(&str, &[&str]); 2] = [
    (
        "fit biharmonic in.ply --knots 30",
        &["a.json", "b.ply", "c.vtu", "d.glb"],
    ),
    ("fit powell-sabin in.ply", &["a.vtu", "b.json", "c.obj"]),
];
/// Shares of the run before the kill: of the whole, or of the time from the first file on.
const SHARES: [f64; 3] = [0.1, 0.5, 0.9];
/// Looked at more often than a small file takes.
const POLL: Duration = Duration::from_micros(200);

/// When a run is killed.
#[derive(Clone, Copy, Debug)]
enum Moment {
    Running(Duration),
    Writing(Duration),
}

fn command(workbench: &Workbench, fit: &str, outputs: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_msplines"));
    command
        .current_dir(workbench.path(""))
        .args(fit.split(' '))
        .args(outputs.iter().flat_map(|output| ["-o", output]))
        .args(["--report", "r.json", "--threads", "1", "--quiet"])
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command
}

/// Returns the time of a run, and that from its first file on.
fn undisturbed(workbench: &Workbench, command: &mut Command) -> (Duration, Duration) {
    let (before, started) = (changed(workbench), Instant::now());
    let mut child = command.spawn().expect("started");
    let mut first = None;
    let status = loop {
        if first.is_none() && changed(workbench) != before {
            first = Some(Instant::now());
        }
        if let Some(status) = child.try_wait().expect("a child") {
            break status;
        }
        std::thread::sleep(POLL);
    };
    assert!(status.success(), "{status}");
    (
        started.elapsed(),
        first.expect("files are written").elapsed(),
    )
}

fn kill(workbench: &Workbench, command: &mut Command, moment: Moment) {
    let before = changed(workbench);
    let mut child = command.spawn().expect("started");
    let after = match moment {
        Moment::Running(after) => after,
        Moment::Writing(after) => {
            while changed(workbench) == before && child.try_wait().expect("a child").is_none() {
                std::thread::sleep(POLL);
            }
            after
        }
    };
    std::thread::sleep(after);
    child.kill().expect("killed");
    child.wait().expect("gone");
}

/// Returns when a file was last made or renamed in the folder.
fn changed(workbench: &Workbench) -> std::time::SystemTime {
    let folder = workbench.path("").metadata().expect("a folder");
    folder.modified().expect("a time")
}

/// Returns the names in the folder.
fn names(workbench: &Workbench) -> Vec<String> {
    let entries = workbench.path("").read_dir().expect("a folder");
    let name = |entry: std::io::Result<std::fs::DirEntry>| entry.expect("an entry").file_name();
    let text = |name: std::ffi::OsString| name.to_string_lossy().into_owned();
    entries.map(name).map(text).collect()
}

/// Returns what a file holds, a record without what differs between two runs.
pub(crate) fn content(workbench: &Workbench, name: &str) -> Vec<u8> {
    if name != "r.json" {
        return workbench.bytes(name);
    }
    let mut record = workbench.json(name);
    for field in ["seconds", "peak_rss_bytes", "threads"] {
        record
            .as_object_mut()
            .expect("a record")
            .remove(field)
            .expect(field);
    }
    record.to_string().into_bytes()
}

#[test]
fn a_killed_fit_leaves_whole_files_and_the_next_one_ends_well() {
    for (fit, outputs) in FITS {
        let workbench = Workbench::new();
        let all: Vec<&str> = outputs.iter().copied().chain(["r.json"]).collect();
        let contents = || -> Vec<Vec<u8>> { all.iter().map(|n| content(&workbench, n)).collect() };
        workbench.put("in.ply", &shapes::torus(1.5, 0.5, 200));
        undisturbed(&workbench, &mut command(&workbench, fit, outputs));
        let old_bytes: Vec<Vec<u8>> = all.iter().map(|name| workbench.bytes(name)).collect();
        let old = contents();
        workbench.put("in.ply", &shapes::torus(1.0, 0.4, 200));
        let (whole, writing) = undisturbed(&workbench, &mut command(&workbench, fit, outputs));
        let new = contents();
        assert!(old.iter().zip(&new).all(|(old, new)| old != new));
        let moments = SHARES.map(|share| Moment::Running(whole.mul_f64(share)));
        let moments = moments
            .into_iter()
            .chain(SHARES.map(|share| Moment::Writing(writing.mul_f64(share))));
        for (trial, moment) in moments.enumerate() {
            let is_filled = trial % 2 == 0;
            for (name, bytes) in all.iter().zip(&old_bytes) {
                std::fs::remove_file(workbench.path(name)).expect("removed");
                if is_filled {
                    std::fs::write(workbench.path(name), bytes).expect("written");
                }
            }
            kill(&workbench, &mut command(&workbench, fit, outputs), moment);
            for (index, name) in all.iter().enumerate() {
                if !is_filled && !workbench.path(name).exists() {
                    continue;
                }
                let found = content(&workbench, name);
                let is_whole = found == new[index] || is_filled && found == old[index];
                assert!(is_whole, "{fit}, {moment:?}: {name} is damaged");
            }
            undisturbed(&workbench, &mut command(&workbench, fit, outputs));
            assert!(contents() == new, "{fit}, {moment:?}");
            // The inputs and what was asked for: nothing of the killed run.
            assert_eq!(names(&workbench).len(), all.len() + 2, "{fit}, {moment:?}");
        }
    }
}
