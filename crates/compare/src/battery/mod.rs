//! The hostile battery: every method on inputs and options that are wrong on purpose.
//!
//! Each case runs the program `msplines` in a process of its own. It passes with a result that is finite and
//! within bounds, or with a refusal that names the place and what to do ([`law`]); a crash, a hang, a number
//! that is none, or a surface far from its input is a fault. How each case ended is recorded, so that a
//! change is seen ([`changes`]).
//!
//! | group | cases |
//! |---|---|
//! | meshes | twelve defects, put into sound meshes, control meshes, networks and solids |
//! | files | broken files of the library of models, where there is one |
//! | options | every option at and beyond its limits, and those that contradict each other |
//! | splines | every field of every spline file, taken away or spoiled |

mod defects;
mod draft;
mod inputs;
pub mod law;
mod options;
pub mod page;
mod peers;
mod process;
mod splines;
mod subjects;

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use serde::{Deserialize, Serialize};

use crate::display::Display;
use law::Bounds;
pub use law::Outcome;
pub use options::is_tried;

/// What is run.
#[derive(Clone, Debug)]
pub struct Battery {
    /// The program `msplines`.
    pub program: PathBuf,
    /// Folder of broken files, if there is one.
    pub files: Option<PathBuf>,
    /// Cases at the same time.
    pub jobs: usize,
    /// Which cases.
    pub extent: Extent,
}

/// How many of the options, spoiled spline files and repaired inputs are tried; all meshes and files are as they
/// come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// All of them.
    Whole,
    /// One of [`SAMPLED`], spread over all commands.
    Sample,
}

/// Of so many cases a sample holds one: few enough for every run of the tests.
pub const SAMPLED: usize = 8;

/// How the name of a method ends whose input is repaired.
const REPAIRED: &str = " --repair";

impl Extent {
    fn of(self, trials: Vec<Trial>) -> Vec<Trial> {
        let step = match self {
            Self::Whole => 1,
            Self::Sample => SAMPLED,
        };
        trials.into_iter().step_by(step).collect()
    }

    /// Returns meshes and files as they come, and as many of the repaired ones as of other cases.
    fn of_inputs(self, mut trials: Vec<Trial>) -> Vec<Trial> {
        if self == Self::Sample {
            let mut repaired = 0;
            trials.retain(|trial| {
                let is_repaired = trial.method.ends_with(REPAIRED);
                repaired += usize::from(is_repaired);
                !is_repaired || repaired % SAMPLED == 1
            });
        }
        trials
    }

    /// Returns whether every case like this one is tried.
    fn covers(self, row: &Row) -> bool {
        let is_input = matches!(row.group, Group::Meshes | Group::Files);
        self == Self::Whole || is_input && !row.method.ends_with(REPAIRED)
    }
}

/// Where a case belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Group {
    /// A defect put into a sound input.
    Meshes,
    /// A broken file of the library of models.
    Files,
    /// An option at or beyond its limits.
    Options,
    /// A spoiled spline file.
    Splines,
}

/// How a case ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// Where it belongs.
    pub group: Group,
    /// What is wrong with the input.
    pub case: String,
    /// The command that met it.
    pub method: String,
    /// How it ended.
    pub outcome: Outcome,
    /// What it said: the refusal, or the warnings of a result.
    pub message: String,
}

impl Row {
    /// Returns what tells this row from all others.
    fn key(&self) -> (Group, &str, &str) {
        (self.group, &self.case, &self.method)
    }
}

/// A case and the command that meets it.
#[derive(Clone, Debug)]
struct Trial {
    group: Group,
    case: String,
    method: String,
    arguments: Vec<String>,
    /// Where the result may lie; `None` where the options may ask for any place.
    bounds: Option<Bounds>,
}

/// Why there is no battery.
#[derive(Debug, thiserror::Error)]
pub enum BatteryError {
    /// A file or folder that cannot be read or written.
    #[error("{}: {source}; the battery needs a temporary folder and the files it is given", path.display())]
    Folder {
        /// The file or folder.
        path: PathBuf,
        /// What is wrong.
        source: std::io::Error,
    },
    /// A sound input that cannot be written.
    #[error("{name}: {reason}; the battery cannot make its inputs")]
    Input {
        /// The input.
        name: String,
        /// What is wrong.
        reason: String,
    },
    /// The program cannot be started, or fails on a sound input.
    #[error("msplines {arguments}: {reason}; the battery needs sound inputs to work")]
    Program {
        /// Its arguments.
        arguments: String,
        /// What is wrong.
        reason: String,
    },
}

/// Runs all cases and returns how they ended, in a fixed order.
///
/// # Errors
/// Inputs that cannot be made. A program that misbehaves is a row.
pub fn run(battery: &Battery, display: &Display) -> Result<Vec<Row>, BatteryError> {
    let benches: Vec<_> = (0..battery.jobs.max(1))
        .map(|_| inputs::Bench::new(battery))
        .collect::<Result<_, _>>()?;
    let trials = trials(battery, &benches[0])?;
    for bench in &benches[1..] {
        bench.copy_from(&benches[0])?;
    }
    let overall = display.overall(trials.len());
    let next = AtomicUsize::new(0);
    let rows = Mutex::new(vec![None; trials.len()]);
    std::thread::scope(|scope| {
        for bench in &benches {
            scope.spawn(|| {
                while let Some((index, trial)) = take(&trials, &next) {
                    let row = bench.meet(trial);
                    if let Outcome::Broken(fault) = &row.outcome {
                        let text = trial.arguments.join(" ");
                        display.line(&format!("{}: {fault} (msplines {text})", row.case));
                    }
                    rows.lock().unwrap_or_else(|e| e.into_inner())[index] = Some(row);
                    overall.passed_over();
                }
            });
        }
    });
    overall.finish();
    let rows = rows.into_inner().unwrap_or_else(|e| e.into_inner());
    Ok(rows.into_iter().flatten().collect())
}

fn take<'a>(trials: &'a [Trial], next: &AtomicUsize) -> Option<(usize, &'a Trial)> {
    let index = next.fetch_add(1, Ordering::Relaxed);
    trials.get(index).map(|trial| (index, trial))
}

fn trials(battery: &Battery, bench: &inputs::Bench) -> Result<Vec<Trial>, BatteryError> {
    bench.fill()?;
    let mut trials = defects::trials(bench)?;
    if let Some(files) = &battery.files {
        trials.extend(inputs::file_trials(bench, files)?);
    }
    trials = battery.extent.of_inputs(trials);
    trials.extend(battery.extent.of(options::trials(bench)?));
    trials.extend(battery.extent.of(splines::trials(bench)?));
    Ok(trials)
}

/// Returns the faults among the rows, as lines for people.
#[must_use]
pub fn faults(rows: &[Row]) -> Vec<String> {
    let broken = rows.iter().filter_map(|row| match &row.outcome {
        Outcome::Broken(fault) => Some(format!("{}, {}: {fault}", row.method, row.case)),
        _ => None,
    });
    broken.collect()
}

/// Returns where `rows` ended otherwise than `recorded`, as lines for people. Files count where any were
/// met, as the library of models need not be there; what a sample left out does not.
#[must_use]
pub fn changes(rows: &[Row], recorded: &[Row], extent: Extent) -> Vec<String> {
    let has_files = rows.iter().any(|row| row.group == Group::Files);
    let counted = |row: &&Row| has_files || row.group != Group::Files;
    let index: std::collections::BTreeMap<_, _> = rows.iter().map(|r| (r.key(), r)).collect();
    let known: std::collections::BTreeSet<_> = recorded.iter().map(Row::key).collect();
    let told = |row: &Row, text: String| format!("{}, {}: {text}", row.method, row.case);
    let changed = recorded.iter().filter(counted).filter_map(|before| {
        let text = match index.get(&before.key()) {
            None if !extent.covers(before) => return None,
            None => "was not run".to_owned(),
            Some(now) if now.outcome == before.outcome => return None,
            Some(now) => format!(
                "{} before, now {}: {}",
                before.outcome, now.outcome, now.message
            ),
        };
        Some(told(before, text))
    });
    let new = rows.iter().filter(|row| !known.contains(&row.key()));
    let new = new.map(|row| told(row, format!("{}, not recorded", row.outcome)));
    changed.chain(new).collect()
}

/// Returns the recorded rows in a file.
///
/// # Errors
/// A file that cannot be read.
pub fn recorded(path: &Path) -> Result<Vec<Row>, BatteryError> {
    let folder = |source| BatteryError::Folder {
        path: path.to_owned(),
        source,
    };
    let bytes = std::fs::read(path).map_err(folder)?;
    serde_json::from_slice(&bytes).map_err(|e| folder(e.into()))
}

/// Returns rows as JSON, one a line.
#[must_use]
pub fn json(rows: &[Row]) -> String {
    let lines: Vec<String> = rows.iter().flat_map(serde_json::to_string).collect();
    format!("[\n{}\n]\n", lines.join(",\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(group: Group, case: &str, outcome: Outcome) -> Row {
        Row {
            group,
            case: case.to_owned(),
            method: "info".to_owned(),
            outcome,
            message: "x".to_owned(),
        }
    }

    #[test]
    fn another_end_a_new_case_and_a_lost_one_are_changes() {
        let recorded = [
            row(Group::Meshes, "a", Outcome::Accepted),
            row(Group::Meshes, "b", Outcome::Input),
            row(Group::Files, "c", Outcome::Input),
        ];
        let now = [
            row(Group::Meshes, "b", Outcome::Accepted),
            row(Group::Meshes, "d", Outcome::Input),
        ];
        let none = Vec::<String>::new();
        assert_eq!(changes(&recorded, &recorded, Extent::Whole), none);
        assert_eq!(
            changes(&now, &recorded, Extent::Whole),
            [
                "info, a: was not run",
                "info, b: input refused before, now accepted: x",
                "info, d: input refused, not recorded"
            ]
        );
    }

    #[test]
    fn a_sample_may_leave_out_options_and_repairs_but_no_mesh() {
        let mut repaired = row(Group::Meshes, "a", Outcome::Input);
        repaired.method.push_str(REPAIRED);
        let recorded = [
            row(Group::Meshes, "a", Outcome::Input),
            row(Group::Options, "b", Outcome::Usage),
            repaired,
        ];
        assert_eq!(
            changes(&[], &recorded, Extent::Sample),
            ["info, a: was not run"]
        );
        assert_eq!(changes(&[], &recorded, Extent::Whole).len(), 3);
        let now = [
            row(Group::Meshes, "a", Outcome::Input),
            row(Group::Options, "b", Outcome::Accepted),
        ];
        assert_eq!(changes(&now, &recorded, Extent::Sample).len(), 1);
    }

    #[test]
    fn rows_come_back_from_their_file_and_faults_are_told() {
        let rows = [
            row(Group::Splines, "a", Outcome::Broken("a panic".to_owned())),
            row(Group::Options, "b", Outcome::Usage),
        ];
        let read: Vec<Row> = serde_json::from_str(&json(&rows)).expect("rows");
        assert_eq!(read, rows);
        assert_eq!(faults(&rows), ["info, a: a panic"]);
    }
}
