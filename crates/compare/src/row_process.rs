//! A row in a process of its own: its own peak memory, a time limit, and a crash is only a row.
//!
//! The parent writes a [`RowRequest`] and starts the program with the paths of request and answer;
//! the child runs it ([`answer`]), prints its progress as JSON lines and writes the [`RowAnswer`].
//! What pictures are drawn from is written after the run, outside of its times.

use std::io::{BufRead, BufReader, Read, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use msplines_common::progress::Progress;
use serde::{Deserialize, Serialize};

use crate::case::Case;
use crate::output::write_row_files;
use crate::record::Record;
use crate::run::run;

/// How often a running row is looked at.
const POLL: Duration = Duration::from_millis(20);
/// Exit code of a row whose parent is gone; nobody reads it.
const ABANDONED: i32 = 1;
/// How much of what a crashed row said is kept.
const LAST_WORDS: usize = 400;

/// The program that runs rows: `program arguments... REQUEST ANSWER`.
#[derive(Clone, Debug)]
pub struct RowProgram {
    /// The executable.
    pub program: PathBuf,
    /// What makes it run a row.
    pub arguments: Vec<String>,
    /// The file whose bytes tell one build of the program from another.
    pub fingerprint: PathBuf,
}

/// What the child is asked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RowRequest {
    /// The run.
    pub case: Case,
    /// Number of threads.
    pub threads: usize,
    /// Folder for what pictures are drawn from: [`crate::output::write_row_files`].
    pub files: PathBuf,
}

/// What the child answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RowAnswer {
    /// The record of the run.
    Record(Box<Record>),
    /// Why there is none.
    Error(String),
}

/// A step of a row, as its process prints it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RowProgress {
    /// The phase.
    pub phase: String,
    /// Work done in this phase.
    pub done: u64,
    /// Work of this phase, 0 where unknown.
    pub total: u64,
    /// What is minimised, where there is such a thing.
    pub objective: Option<f64>,
}

impl RowProgress {
    /// Returns what has been reached by now, in a row that started at `started`.
    #[must_use]
    pub fn history_point(&self, started: Instant) -> Option<HistoryPoint> {
        Some(HistoryPoint {
            seconds: started.elapsed().as_secs_f64(),
            phase: self.phase.clone(),
            objective: self.objective.filter(|value| value.is_finite())?,
        })
    }
}

/// What a running optimisation had reached.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HistoryPoint {
    /// Seconds since the row was started.
    pub seconds: f64,
    /// The phase.
    pub phase: String,
    /// What is minimised: the root mean square of the error, in the units of the data.
    pub objective: f64,
}

/// Runs `request` in a process of its own, reporting its progress to `show`.
///
/// # Errors
/// Why there is no record: the error of the run, a crash with its last words, or the time limit.
pub fn run_row(
    program: &RowProgram,
    request: &RowRequest,
    time_limit: Duration,
    show: &mut dyn FnMut(&RowProgress),
) -> Result<Record, String> {
    let folder = tempfile::Builder::new()
        .prefix("msplines-row-")
        .tempdir()
        .map_err(|e| format!("no temporary folder: {e}"))?;
    let (asked, answered) = (
        folder.path().join("request.json"),
        folder.path().join("answer.json"),
    );
    let text = serde_json::to_vec(request).map_err(|e| e.to_string())?;
    std::fs::write(&asked, text).map_err(|e| format!("cannot write a temporary file: {e}"))?;
    let mut child = Command::new(&program.program)
        .args(&program.arguments)
        .args([&asked, &answered])
        // Never written to: that it ends tells the row that nobody waits for it.
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|e| format!("cannot start {}: {e}", program.program.display()))?;
    let ended = watch(&mut child, time_limit, show);
    if let Ok(bytes) = std::fs::read(&answered) {
        return match serde_json::from_slice(&bytes) {
            Ok(RowAnswer::Record(record)) => Ok(*record),
            Ok(RowAnswer::Error(error)) => Err(error),
            Err(error) => Err(format!("its answer cannot be read: {error}")),
        };
    }
    Err(ended)
}

/// Waits for the end of a child and returns how it ended.
fn watch(child: &mut Child, time_limit: Duration, show: &mut dyn FnMut(&RowProgress)) -> String {
    let started = Instant::now();
    let (stdout, stderr) = (child.stdout.take(), child.stderr.take());
    let (sender, receiver) = std::sync::mpsc::channel();
    std::thread::spawn(move || {
        for line in stdout
            .into_iter()
            .flat_map(|out| BufReader::new(out).lines())
        {
            let step = line
                .ok()
                .and_then(|text| serde_json::from_str::<RowProgress>(&text).ok());
            if step.is_some_and(|step| sender.send(step).is_err()) {
                return;
            }
        }
    });
    let words = std::thread::spawn(move || {
        let mut bytes = Vec::new();
        // What was said until the pipe broke is all there is.
        let _ = stderr.map(|mut err| err.read_to_end(&mut bytes));
        String::from_utf8_lossy(&bytes).into_owned()
    });
    let status = loop {
        receiver.try_iter().for_each(|step| show(&step));
        match child.try_wait() {
            Ok(Some(status)) => break status,
            Ok(None) if started.elapsed() < time_limit => std::thread::sleep(POLL),
            Ok(None) => {
                // It may have ended by itself in between.
                let _ = child.kill();
                let _ = child.wait();
                return format!("time limit of {} s reached", time_limit.as_secs_f64());
            }
            Err(error) => return format!("cannot be waited for: {error}"),
        }
    };
    let words = words.join().unwrap_or_default();
    let words = words.trim();
    let start = words
        .char_indices()
        .rev()
        .nth(LAST_WORDS)
        .map_or(0, |(index, _)| index);
    format!("ended without an answer ({status}): {}", &words[start..])
}

/// The child's side: runs the request in the file `asked` and writes the file `answered`.
///
/// Standard input is a pipe from the parent. Where that is killed the pipe ends, and so does this
/// process: else it would go on writing where the next campaign runs the same row again.
///
/// # Errors
/// A request that cannot be read or an answer that cannot be written.
pub fn answer(asked: &Path, answered: &Path, process_start: Instant) -> std::io::Result<()> {
    std::thread::spawn(|| {
        // Whatever ends the pipe, the parent is gone.
        let _ = std::io::copy(&mut std::io::stdin(), &mut std::io::sink());
        std::process::exit(ABANDONED);
    });
    let request: RowRequest = serde_json::from_slice(&std::fs::read(asked)?)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(request.threads)
        .build_global();
    let answer = match pool {
        Ok(()) => run_and_print(&request, process_start),
        Err(error) => RowAnswer::Error(error.to_string()),
    };
    let written = answered.with_extension("part");
    std::fs::write(&written, serde_json::to_vec(&answer)?)?;
    std::fs::rename(&written, answered)
}

fn run_and_print(request: &RowRequest, process_start: Instant) -> RowAnswer {
    let mut out = std::io::stdout().lock();
    let mut print = |progress: &Progress| {
        let step = RowProgress {
            phase: progress.phase.to_owned(),
            done: progress.done,
            total: progress.total,
            objective: progress.objective,
        };
        if let Ok(text) = serde_json::to_string(&step) {
            // A parent that has gone away is no reason to stop.
            let _ = writeln!(out, "{text}");
        }
        ControlFlow::Continue(())
    };
    let ended = run(&request.case, process_start, &mut print).and_then(|output| {
        write_row_files(&request.files, &output)?;
        Ok(output.record)
    });
    match ended {
        Ok(record) => RowAnswer::Record(Box::new(record)),
        Err(error) => RowAnswer::Error(error.to_string()),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use crate::case::{Amount, Input, Knots, Method};
    use crate::generated::GeneratedSurface;
    use crate::record::tests::sample;

    fn shell(script: &str) -> RowProgram {
        let arguments = ["-c", script, "row"].map(str::to_owned).to_vec();
        RowProgram {
            program: "/bin/sh".into(),
            arguments,
            fingerprint: "/bin/sh".into(),
        }
    }

    fn row(script: &str, limit: f64) -> (Result<Record, String>, Vec<RowProgress>) {
        let input = Input::Surface(GeneratedSurface::Genus2);
        let knots = Knots::Optimised(Amount::Count(5));
        let request = RowRequest {
            case: Case::new(input, Method::biharmonic(knots)),
            threads: 1,
            files: "nowhere".into(),
        };
        let mut steps = Vec::new();
        let limit = Duration::from_secs_f64(limit);
        let result = run_row(&shell(script), &request, limit, &mut |step| {
            steps.push(step.clone());
        });
        (result, steps)
    }

    #[test]
    fn a_row_gives_its_record_and_its_progress() {
        let answer = RowAnswer::Record(Box::new(sample()));
        let text = serde_json::to_string(&answer).expect("json");
        let script = format!(
            "echo '{{\"phase\":\"fit\",\"done\":1,\"total\":2}}'; echo noise; sleep 0.2; printf '%s' '{text}' > \"$2\""
        );
        let (result, steps) = row(&script, 20.0);
        assert_eq!(result, Ok(sample()));
        assert_eq!(
            steps,
            [RowProgress {
                phase: "fit".to_owned(),
                done: 1,
                total: 2,
                objective: None,
            }]
        );
    }

    #[test]
    fn a_crash_is_a_row_with_its_last_words() {
        let (result, _) = row("echo 'panicked at the disco' >&2; kill -SEGV $$", 20.0);
        let reason = result.expect_err("it crashed");
        assert!(
            reason.contains("signal: 11") && reason.contains("at the disco"),
            "{reason}"
        );
    }

    #[test]
    fn a_row_out_of_time_is_ended() {
        let started = Instant::now();
        let (result, _) = row("exec sleep 30", 0.1);
        assert_eq!(result, Err("time limit of 0.1 s reached".to_owned()));
        assert!(started.elapsed() < Duration::from_secs(10));
    }

    #[test]
    fn the_pipe_that_tells_of_the_parents_end_stays_open() {
        let (result, _) = row("read line; echo 'nobody waits' >&2", 0.3);
        assert_eq!(result, Err("time limit of 0.3 s reached".to_owned()));
    }

    #[test]
    fn half_an_answer_is_no_record() {
        let (result, _) = row("printf '{\"record\":' > \"$2\"", 20.0);
        assert!(result.expect_err("not a record").contains("cannot be read"));
        let (result, _) = row("printf '{\"error\":\"3 holes\"}' > \"$2\"; exit 3", 20.0);
        assert_eq!(result, Err("3 holes".to_owned()));
    }
}
