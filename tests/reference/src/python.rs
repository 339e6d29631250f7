//! Questions to VTK, meshio and SciPy through `python/solid_peers.py`.
//!
//! `cargo xtask test reference` installs them below `target`.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::OnceLock;

use serde::de::DeserializeOwned;
use serde_json::Value;

/// Python of the environment with the packages, seen from the folder of this package.
const PYTHON: &str = "../../target/solid_peers/bin/python";
/// What answers, seen from there as well.
const SCRIPT: &str = "python/solid_peers.py";
/// Keeps a BLAS on one thread.
const ONE_THREAD: (&str, &str) = ("OPENBLAS_NUM_THREADS", "1");

/// Why a question has no answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PythonError {
    /// The environment has not been made.
    #[error("there is no {}; `cargo xtask test reference` makes it", .path.display())]
    Absent {
        /// Where it should be.
        path: PathBuf,
    },
    /// The process cannot be run.
    #[error("Python cannot be asked `{question}`: {source}")]
    Process {
        /// The question.
        question: String,
        /// What the system says.
        source: io::Error,
    },
    /// The script failed.
    #[error("Python was asked `{question}` and ended with {status}:\n{errors}")]
    Failed {
        /// The question.
        question: String,
        /// How it ended.
        status: ExitStatus,
        /// What it wrote to standard error.
        errors: String,
    },
    /// The answer is not what was asked for.
    #[error("the answer to `{question}` is not as expected: {source}")]
    Answer {
        /// The question.
        question: String,
        /// What is wrong with it.
        source: serde_json::Error,
    },
}

/// Returns the answer to a question: a function of the script and its arguments, an object of JSON.
///
/// # Errors
/// The environment is absent, the script fails, or its answer is of another form.
pub fn ask<T: DeserializeOwned>(question: &str, arguments: &Value) -> Result<T, PythonError> {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = package.join(PYTHON);
    if !path.exists() {
        return Err(PythonError::Absent { path });
    }
    let mut asked = arguments.clone();
    asked["ask"] = question.into();
    let mut command = Command::new(path);
    command
        .arg(package.join(SCRIPT))
        .env(ONE_THREAD.0, ONE_THREAD.1);
    let (status, output, errors) =
        converse(&mut command, &asked).map_err(|source| PythonError::Process {
            question: question.to_owned(),
            source,
        })?;
    if !status.success() {
        return Err(PythonError::Failed {
            question: question.to_owned(),
            status,
            errors: String::from_utf8_lossy(&errors).into_owned(),
        });
    }
    serde_json::from_slice(&output).map_err(|source| PythonError::Answer {
        question: question.to_owned(),
        source,
    })
}

/// Runs a program with this on its standard input; returns how it ended and what it wrote.
fn converse(command: &mut Command, asked: &Value) -> io::Result<(ExitStatus, Vec<u8>, Vec<u8>)> {
    let mut child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    if let Some(mut input) = child.stdin.take() {
        // The script reads all of it before it writes; if it dies before, its status says so.
        match input.write_all(asked.to_string().as_bytes()) {
            Err(error) if error.kind() != io::ErrorKind::BrokenPipe => return Err(error),
            _ => {}
        }
    }
    let ended = child.wait_with_output()?;
    Ok((ended.status, ended.stdout, ended.stderr))
}

/// Returns the version of one of the Python packages.
///
/// # Panics
/// If they cannot be asked: a comparison without its reference has failed.
#[must_use]
pub fn version(package: &str) -> String {
    static VERSIONS: OnceLock<BTreeMap<String, String>> = OnceLock::new();
    let versions = VERSIONS.get_or_init(|| {
        ask("versions", &serde_json::json!({})).unwrap_or_else(|error| panic!("{error}"))
    });
    versions[package].clone()
}
