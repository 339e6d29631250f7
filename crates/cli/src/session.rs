//! What all subcommands share: threads, display, interrupts, and how they fail.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::Instant;

use msplines_common::progress::{Outcome, Progress};
use msplines_compare::display::{Display, Verbosity};
use msplines_compare::error::{RunError, exit};
use msplines_compare::output::check_folder;
use msplines_compare::record::Record;
use msplines_compare::report::replace;
use msplines_compare::run::RunOutput;

use crate::arguments::Common;
use crate::interrupt::Interrupt;

/// A failed command.
#[derive(Debug)]
pub(crate) struct Failure {
    /// Exit code.
    pub(crate) code: u8,
    /// What is wrong, where, and what to do.
    pub(crate) text: String,
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        Self {
            code: error.exit_code(),
            text: error.to_string(),
        }
    }
}

/// One run of the program.
#[derive(Debug)]
pub(crate) struct Session {
    /// When the process started.
    pub(crate) process_start: Instant,
    /// Seed of everything random.
    pub(crate) seed: u64,
    /// Whether defects are mended.
    pub(crate) repair: bool,
    /// Where the record goes.
    pub(crate) report: Option<PathBuf>,
    display: Display,
    interrupt: Interrupt,
}

impl Session {
    /// Sets up threads, display and interrupts.
    pub(crate) fn open(common: &Common, process_start: Instant) -> Result<Self, Failure> {
        if let Some(report) = &common.report {
            check_folder(report)?;
        }
        let threads = common.threads.unwrap_or(0) as usize;
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build_global()
            .map_err(|e| Failure {
                code: exit::USAGE,
                text: format!("--threads: {e}"),
            })?;
        let verbosity = if common.quiet {
            Verbosity::Quiet
        } else {
            Verbosity::Normal
        };
        Ok(Self {
            process_start,
            seed: common.seed,
            repair: common.repair,
            report: common.report.clone(),
            display: Display::new(verbosity),
            interrupt: Interrupt::listen(process_start, common.time_limit),
        })
    }

    /// Runs `work` with an observer that shows its progress and ends it when that is due, then
    /// writes the record and returns the exit code.
    pub(crate) fn observe(
        &self,
        label: &str,
        work: impl FnOnce(&mut dyn FnMut(&Progress) -> ControlFlow<()>) -> Result<RunOutput, RunError>,
    ) -> Result<u8, Failure> {
        let mut task = self.display.task(label);
        let result = work(&mut |progress| {
            task.show(
                progress.phase,
                progress.done,
                progress.total,
                progress.objective,
            );
            if self.interrupt.is_due() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        let record = match result {
            Ok(output) => output.record,
            Err(error) => {
                task.finish("failed");
                return Err(error.into());
            }
        };
        task.finish(&summary(&record));
        for warning in &record.warnings {
            self.display.line(&format!("warning: {warning}"));
        }
        self.write_report(&record)?;
        Ok(self.conclude(record.outcome))
    }

    /// Writes a value to the file of `--report`, if one is given.
    pub(crate) fn write_report(&self, value: &impl serde::Serialize) -> Result<(), Failure> {
        let Some(path) = &self.report else {
            return Ok(());
        };
        let written = serde_json::to_vec_pretty(value).map_err(std::io::Error::from);
        written
            .and_then(|bytes| replace(path, &bytes))
            .map_err(|error| {
                RunError::Write {
                    path: path.clone(),
                    reason: format!("{error}; give a path in a folder that can be written to"),
                }
                .into()
            })
    }

    /// Says what an outcome short of convergence means, and returns its exit code.
    fn conclude(&self, outcome: Outcome) -> u8 {
        match outcome {
            Outcome::Converged => exit::SUCCESS,
            Outcome::Stalled => {
                self.display.line(
                    "warning: no step improved the result any more before it met the stopping rule",
                );
                exit::SUCCESS
            }
            Outcome::MaxIterations => {
                self.display.line(
                    "warning: the allowed iterations were used up; --effort best allows more",
                );
                exit::SUCCESS
            }
            Outcome::Stopped => {
                eprintln!("stopped early: this is the best result so far, marked \"stopped\"");
                exit::STOPPED
            }
        }
    }
}

/// What is said of an atlas; nothing of a spline.
fn atlas_summary(record: &Record) -> String {
    let check = |name: &str| record.number(&format!("checks.{name}"));
    let names = ["genus", "zeros", "conformal_k_p50", "conformal_k_p99"].map(check);
    let [Some(genus), Some(zeros), Some(median), Some(most)] = names else {
        return String::new();
    };
    format!(
        "genus {genus}, {zeros} zeros, angles distorted by {median:.4} in half of the surface, up to {most:.4} in 99 %; "
    )
}

fn summary(record: &Record) -> String {
    let seconds = record.seconds.total;
    match &record.error {
        Some(error) => format!(
            "mean error {:.4} %, rms {:.4} %, max {:.4} % of {:.6}; {seconds:.2} s",
            100.0 * error.mean,
            100.0 * error.rms,
            100.0 * error.max,
            error.scale
        ),
        None => format!("{}done in {seconds:.2} s", atlas_summary(record)),
    }
}
