//! Questions to VTK, meshio and SciPy through `python/solid_peers.py`.
//!
//! `cargo xtask test reference` installs them below `target`.

use std::collections::BTreeMap;
use std::fmt;
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::OnceLock;

use serde::de::DeserializeOwned;
use serde_json::{Value, json};

/// Python of the environment with the packages, seen from the folder of this package.
const PYTHON: &str = "../../target/solid_peers/bin/python";
/// What answers, seen from there as well.
const SCRIPT: &str = "python/solid_peers.py";
/// Keeps a BLAS on one thread.
const ONE_THREAD: (&str, &str) = ("OPENBLAS_NUM_THREADS", "1");

/// Why a question has no answer.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum PythonError {
    /// The environment has not been made.
    #[error("there is no {}; `cargo xtask test reference` makes it", .path.display())]
    Absent {
        /// Where it should be.
        path: PathBuf,
    },
    /// The process cannot be started or spoken to.
    #[error("Python cannot be asked: {0}")]
    Process(#[from] io::Error),
    /// The script ended instead of answering.
    #[error("Python ended when asked `{question}`; standard error says why")]
    Ended {
        /// The question.
        question: String,
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

// A test that ends with an error shows this form of it.
impl fmt::Debug for PythonError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// A process that answers questions; it ends with this value.
#[derive(Debug)]
pub struct Python {
    child: Child,
    answers: BufReader<ChildStdout>,
}

impl Python {
    /// Starts the process.
    ///
    /// # Errors
    /// The environment is absent or cannot be run.
    pub fn start() -> Result<Self, PythonError> {
        let package = Path::new(env!("CARGO_MANIFEST_DIR"));
        let path = package.join(PYTHON);
        if !path.exists() {
            return Err(PythonError::Absent { path });
        }
        let mut child = Command::new(path)
            .arg(package.join(SCRIPT))
            .env(ONE_THREAD.0, ONE_THREAD.1)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let answers = child.stdout.take().ok_or(io::ErrorKind::BrokenPipe);
        let answers = BufReader::new(answers.map_err(io::Error::from)?);
        Ok(Self { child, answers })
    }

    /// Returns the answer to a question: a function of the script and its arguments, an object of JSON.
    ///
    /// # Errors
    /// The script ends instead, or its answer is of another form.
    pub fn ask<T: DeserializeOwned>(
        &mut self,
        question: &str,
        arguments: &Value,
    ) -> Result<T, PythonError> {
        let mut asked = arguments.clone();
        asked["ask"] = question.into();
        let question = || question.to_owned();
        let input = self.child.stdin.as_mut().ok_or(io::ErrorKind::BrokenPipe);
        let input = input.map_err(io::Error::from)?;
        writeln!(input, "{asked}")?;
        input.flush()?;
        let mut answer = String::new();
        if self.answers.read_line(&mut answer)? == 0 {
            let question = question();
            return Err(PythonError::Ended { question });
        }
        serde_json::from_str(&answer).map_err(|source| PythonError::Answer {
            question: question(),
            source,
        })
    }
}

impl Drop for Python {
    fn drop(&mut self) {
        // The script ends with its input.
        drop(self.child.stdin.take());
        let _ended = self.child.wait();
    }
}

/// Returns the version of one of the Python packages.
///
/// # Panics
/// If they cannot be asked: a comparison without its reference has failed.
#[must_use]
pub fn version(package: &str) -> String {
    static VERSIONS: OnceLock<BTreeMap<String, String>> = OnceLock::new();
    let versions = VERSIONS.get_or_init(|| {
        let found = Python::start().and_then(|mut python| python.ask("versions", &json!({})));
        found.unwrap_or_else(|error| panic!("{error}"))
    });
    versions[package].clone()
}
