//! One peer in Python, in a process of its own.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use msplines_io::{Array, read_npy, write_npy};
use serde::Deserialize;
use serde_json::Value;
use tempfile::TempDir;

use super::contest::Timed;
use super::{Failure, Settings};

/// What asks the peers, seen from this package.
const SCRIPT: &str = "python/peers.py";
/// Variables that keep a library on one thread.
const ONE_THREAD: [&str; 4] = [
    "OPENBLAS_NUM_THREADS",
    "OMP_NUM_THREADS",
    "IGL_NUM_THREADS",
    "RAYON_NUM_THREADS",
];
/// After so long a peer is given up.
const PATIENCE: Duration = Duration::from_secs(600);
/// Name of the file with what a peer found.
const RESULT: &str = "result.npy";

/// Arrays that peers read.
pub(super) struct Inputs {
    folder: TempDir,
}

impl Inputs {
    pub(super) fn new() -> Result<Self, Failure> {
        let folder = tempfile::tempdir()?;
        Ok(Self { folder })
    }

    /// Stores an array of rows of so many numbers.
    pub(super) fn put(&self, name: &str, width: usize, values: Vec<f64>) -> Result<(), Failure> {
        let shape = vec![values.len() / width, width];
        let path = self.folder.path().join(format!("{name}.npy"));
        Ok(write_npy(&path, &Array { shape, values })?)
    }

    pub(super) fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// A peer that answers.
pub(super) struct Adapter {
    child: Child,
    answers: Receiver<String>,
    folder: PathBuf,
}

#[derive(Deserialize)]
struct Answer {
    #[serde(default)]
    seconds: Vec<f64>,
    version: Option<String>,
    error: Option<String>,
}

impl Adapter {
    /// Starts the process of a peer that reads these inputs, and returns it with its version.
    pub(super) fn start(
        settings: &Settings,
        peer: &str,
        inputs: &Inputs,
    ) -> Result<(Self, String), String> {
        let package = Path::new(env!("CARGO_MANIFEST_DIR"));
        let spawned = Command::new(&settings.python)
            .arg(package.join(SCRIPT))
            .arg(peer)
            .arg(inputs.path())
            .envs(ONE_THREAD.map(|name| (name, "1")))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let mut child = spawned.map_err(|error| format!("Python cannot be started: {error}"))?;
        let output = child.stdout.take().ok_or("Python has no output")?;
        let (to, answers) = mpsc::channel();
        // Ends with the process, whose output it reads.
        thread::spawn(move || {
            let lines = BufReader::new(output).lines().map_while(Result::ok);
            lines.for_each(|line| drop(to.send(line)));
        });
        let mut adapter = Self {
            child,
            answers,
            folder: inputs.path().to_owned(),
        };
        let asked = adapter.exchange(&serde_json::json!({"ask": "version"}));
        let told = asked.map_err(|error| match settings.missing.get(peer) {
            Some(reason) => reason.clone(),
            None => error.to_string(),
        })?;
        let version = told.version.ok_or("the peer tells no version")?;
        Ok((adapter, version))
    }

    /// Returns what a peer took and found.
    pub(super) fn ask(&mut self, question: &Value) -> Result<Timed, Failure> {
        let Answer { seconds, .. } = self.exchange(question)?;
        let result = read_npy(&self.folder.join(RESULT))?.values;
        Ok(Timed { seconds, result })
    }

    fn exchange(&mut self, question: &Value) -> Result<Answer, Failure> {
        let input = self.child.stdin.as_mut().ok_or("Python has no input")?;
        writeln!(input, "{question}")?;
        input.flush()?;
        let line = self.answers.recv_timeout(PATIENCE);
        let line = line.map_err(|error| match error {
            RecvTimeoutError::Timeout => format!("no result within {} s", PATIENCE.as_secs()),
            RecvTimeoutError::Disconnected => "its process ended".to_owned(),
        })?;
        let answer: Answer = serde_json::from_str(&line)?;
        match answer.error {
            Some(error) => Err(error.into()),
            None => Ok(answer),
        }
    }
}

impl Drop for Adapter {
    fn drop(&mut self) {
        // It may be in the midst of something that would take long.
        let _killed = self.child.kill();
        let _ended = self.child.wait();
    }
}
