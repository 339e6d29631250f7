//! The script that makes the pictures of a report turnable, bundled with Node.js where it is there.
//!
//! A report without it keeps its still pictures and says why; nothing else depends on it.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use sha2::{Digest, Sha256};

use super::replace;
use crate::input::hexadecimal;

/// Files of the bundle: its manifest, the exact versions with their digests, and the script.
const SOURCES: [(&str, &str); 3] = [
    ("package.json", include_str!("../../viewer/package.json")),
    (
        "package-lock.json",
        include_str!("../../viewer/package-lock.json"),
    ),
    ("viewer.js", include_str!("../../viewer/viewer.js")),
];
/// What the manifest's command `bundle` writes.
const BUNDLE: &str = "viewer.min.js";
/// The licence that the bundle must carry.
const LICENCE: &str = "node_modules/three/LICENSE";

/// Installs exactly what the lock file names. No package runs scripts of its own: esbuild's would only
/// save the start of one process. Without a network it gives up after one more try.
const INSTALL: [&str; 9] = [
    "ci",
    "--ignore-scripts",
    "--no-audit",
    "--no-fund",
    "--prefer-offline",
    "--include=optional",
    "--fetch-retries=1",
    "--fetch-retry-mintimeout=1000",
    "--fetch-timeout=30000",
];
/// Bundles the script.
const BUILD: [&str; 3] = ["run", "--silent", "bundle"];

/// A slow line fetches 40 MB within it; a blocked one does not hold up a report for longer.
const TIME_LIMIT: Duration = Duration::from_secs(120);
/// How often a running program is looked at.
const POLL: Duration = Duration::from_millis(20);
/// How much of a program's last line is kept.
const LAST_WORDS: usize = 160;

/// The program that installs and runs packages for Node.js.
const NPM: &str = if cfg!(windows) { "npm.cmd" } else { "npm" };

/// The script, or why there is none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Viewer {
    /// Text that can stand inside of a `<script>` element as it is.
    Script(String),
    /// One line that says why pictures stay still.
    Absent(String),
}

/// Returns the script of the turnable pictures; the second time from a file in `folder`.
///
/// The first time takes a few seconds and fetches packages with npm. Never fails: without Node.js, or
/// without a network, it returns the reason.
#[must_use]
pub fn bundle(folder: &Path) -> Viewer {
    bundle_with(NPM, folder)
}

fn bundle_with(npm: &str, folder: &Path) -> Viewer {
    let kept = folder.join(kept_name());
    if let Ok(script) = fs::read_to_string(&kept) {
        return Viewer::Script(script);
    }
    match build(npm, folder) {
        Ok(script) => {
            // A script that could not be kept is built again the next time.
            let _ = replace(&kept, script.as_bytes());
            Viewer::Script(script)
        }
        Err(reason) => Viewer::Absent(reason),
    }
}

/// Returns the name of the kept bundle: the hash of everything that it is made from.
fn kept_name() -> String {
    let mut hash = Sha256::new();
    for (name, text) in SOURCES {
        for part in [name, text] {
            hash.update((part.len() as u64).to_le_bytes());
            hash.update(part);
        }
    }
    format!("viewer-{}.js", &hexadecimal(&hash.finalize())[..16])
}

fn build(npm: &str, folder: &Path) -> Result<String, String> {
    let lost = |error: io::Error| format!("the viewer's files cannot be written: {error}");
    fs::create_dir_all(folder).map_err(lost)?;
    // Removed again at the end, whatever the end is.
    let place = tempfile::Builder::new()
        .prefix(".msplines-viewer-")
        .tempdir_in(folder)
        .map_err(lost)?;
    let place = place.path();
    for (name, text) in SOURCES {
        fs::write(place.join(name), text).map_err(lost)?;
    }
    let log = place.join("log");
    for arguments in [&INSTALL[..], &BUILD] {
        run(npm, arguments, place, &log, TIME_LIMIT)?;
    }
    let script = fs::read_to_string(place.join(BUNDLE))
        .map_err(|error| format!("the bundle of the viewer cannot be read: {error}"))?;
    let licence = fs::read_to_string(place.join(LICENCE)).unwrap_or_default();
    let text = format!("/*! three.js\n{}\n*/\n{script}", licence.trim());
    if is_safe_in_page(&text) {
        Ok(text)
    } else {
        Err("the bundle of the viewer would end its own script element".to_owned())
    }
}

/// Whether a script does not end its own element, nor start a comment of the page.
fn is_safe_in_page(script: &str) -> bool {
    let script = script.to_ascii_lowercase();
    !["</script", "<script", "<!--"]
        .iter()
        .any(|part| script.contains(part))
}

/// Runs a program in a folder to its good end, with its words in the file `log`.
fn run(
    program: &str,
    arguments: &[&str],
    folder: &Path,
    log: &PathBuf,
    time_limit: Duration,
) -> Result<(), String> {
    let shown = format!("`{program} {}`", arguments.first().unwrap_or(&""));
    let lost = |error: io::Error| format!("{shown} cannot be run: {error}");
    let words = File::create(log).map_err(lost)?;
    let child = Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(words.try_clone().map_err(lost)?)
        .stderr(words)
        .spawn();
    let mut child = match child {
        Ok(child) => child,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Err("Node.js with npm is not installed".to_owned());
        }
        Err(error) => return Err(lost(error)),
    };
    let started = Instant::now();
    loop {
        match child.try_wait().map_err(lost)? {
            Some(status) if status.success() => return Ok(()),
            Some(status) => {
                let said = fs::read(log).map_err(lost)?;
                let said = last_words(&String::from_utf8_lossy(&said));
                return Err(format!("{shown} ended with {status}: {said}"));
            }
            None if started.elapsed() < time_limit => std::thread::sleep(POLL),
            None => {
                // It may have ended by itself in between.
                let _ = child.kill();
                let _ = child.wait();
                let limit = time_limit.as_secs_f64();
                return Err(format!("{shown} took longer than {limit} s"));
            }
        }
    }
}

/// Returns what npm gives as the code of its error, else the last line.
fn last_words(said: &str) -> String {
    let code = said
        .lines()
        .find_map(|line| line.strip_prefix("npm error code "));
    let last = said.lines().map(str::trim).rfind(|line| !line.is_empty());
    let words = code.or(last).unwrap_or("it said nothing");
    words.chars().take(LAST_WORDS).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kept_script_is_returned_without_running_anything() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        fs::write(folder.path().join(kept_name()), "kept").expect("written");
        let found = bundle_with("no-such-program", folder.path());
        assert_eq!(found, Viewer::Script("kept".to_owned()));
    }

    #[test]
    fn without_npm_there_is_a_reason_and_nothing_is_left() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let found = bundle_with("no-such-program", folder.path());
        let reason = "Node.js with npm is not installed".to_owned();
        assert_eq!(found, Viewer::Absent(reason));
        assert_eq!(fs::read_dir(folder.path()).expect("readable").count(), 0);
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_a_reason() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("file");
        fs::write(&file, "").expect("written");
        let Viewer::Absent(reason) = bundle_with("no-such-program", &file.join("inside")) else {
            panic!("a script from nothing");
        };
        assert!(reason.contains("cannot be written"), "{reason}");
        assert!(!reason.contains('\n'));
    }

    #[cfg(unix)]
    #[test]
    fn programs_that_fail_or_hang_are_reasons_of_one_line() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let log = folder.path().join("log");
        let shell = |script, seconds| {
            let limit = Duration::from_secs_f64(seconds);
            run("/bin/sh", &["-c", script], folder.path(), &log, limit)
        };
        assert_eq!(shell("exit 0", 20.0), Ok(()));
        let failed = shell(
            "echo 'npm error code ENOTFOUND'; echo 'npm error more'; exit 3",
            20.0,
        );
        let failed = failed.expect_err("it failed");
        assert!(failed.ends_with("exit status: 3: ENOTFOUND"), "{failed}");
        let failed = shell("echo first; echo last >&2; exit 1", 20.0).expect_err("it failed");
        assert!(failed.ends_with(": last"), "{failed}");
        let hung = shell("exec sleep 30", 0.1).expect_err("it hung");
        assert!(hung.ends_with("took longer than 0.1 s"), "{hung}");
    }

    #[test]
    fn what_would_end_the_script_element_is_found() {
        assert!(is_safe_in_page("if (a < b) c(\"<\\/script>\")"));
        assert!(!is_safe_in_page("\"</SCRIPT>\""));
        assert!(!is_safe_in_page("a<!--b"));
    }

    #[test]
    fn versions_are_exact_and_no_address_of_a_registry_is_kept() {
        let [(_, manifest), (_, lock), _] = SOURCES;
        let manifest: serde_json::Value = serde_json::from_str(manifest).expect("json");
        let versions = manifest["dependencies"].as_object().expect("a table");
        assert_eq!(versions.len(), 2);
        for version in versions.values().filter_map(|v| v.as_str()) {
            assert!(
                version.chars().all(|c| c.is_ascii_digit() || c == '.'),
                "{version}"
            );
        }
        assert!(!lock.contains("resolved") && !lock.contains("://registry"));
    }
}
