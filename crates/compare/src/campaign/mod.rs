//! A campaign runs the rows of experiments, stores each at once, and judges them all.

mod plan;
mod schedule;

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::display::Display;
use crate::experiment::{
    Column, Experiment, ExperimentError, Figure, Plot, Property, Row, ViewHint, experiments,
};
use crate::machine::Machine;
use crate::models::{Manifest, Provenance, models_folder};
use crate::record::{Record, Tool};
use crate::row_process::{HistoryPoint, RowProgram};
use crate::store::RowStore;
use crate::verdict::Judgement;

use schedule::Schedule;

/// The schema of [`Report`].
pub const REPORT_SCHEMA: &str = "msplines.report/2";

/// Which rows run, and how.
#[derive(Clone, Debug)]
pub struct Campaign {
    /// The project's folder, which holds `data/`.
    pub root: PathBuf,
    /// Only this paper.
    pub paper: Option<String>,
    /// Only this item of it.
    pub item: Option<String>,
    /// Only this row of it, and the rows that it needs.
    pub row: Option<String>,
    /// Folder of the models; `$MSPLINES_MODELS` or `data/models` where absent.
    pub models: Option<PathBuf>,
    /// Whether rows for `--full` run too.
    pub full: bool,
    /// Folder of stored rows and of the report.
    pub out: PathBuf,
    /// What becomes of stored rows.
    pub reuse: Reuse,
    /// Rows at the same time; more than one makes times not comparable.
    pub jobs: usize,
    /// Threads of each row; the machine's, shared among the jobs, where absent.
    pub threads: Option<usize>,
    /// Seconds after which any row is given up, where that is sooner than its own limit.
    pub time_limit: Option<f64>,
    /// The program that runs a row.
    pub program: RowProgram,
}

/// What becomes of rows that an earlier campaign stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reuse {
    /// Those of this very program that gave a result are taken; all others run.
    Finished,
    /// All rows run.
    Nothing,
    /// Only rows that failed run; all others are taken, whatever build of the program ran them.
    AllButFailed,
    /// No row runs: all are taken, whatever build of the program ran them.
    Everything,
}

/// Why a campaign cannot start.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CampaignError {
    /// An experiment or the manifest of models cannot be used.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// No such row.
    #[error("no row `{asked}`; there are: {available}")]
    UnknownRow {
        /// The row.
        asked: String,
        /// Those there are.
        available: String,
    },
    /// A file below the output folder cannot be read or written.
    #[error("{}: {source}; give another folder with --out", path.display())]
    Output {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

/// Whether times can be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Times {
    /// One row ran at a time.
    Comparable,
    /// Rows ran side by side and disturbed each other.
    SideBySide,
}

/// Everything a campaign found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Always [`REPORT_SCHEMA`].
    pub schema: String,
    /// The program that made it.
    pub tool: Tool,
    /// Where it was made.
    pub machine: Machine,
    /// Whether its times can be compared.
    pub times: Times,
    /// Seconds that the campaign took, stored rows left out.
    pub seconds: f64,
    /// The experiments.
    pub items: Vec<ItemReport>,
}

/// One experiment with its results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ItemReport {
    /// Key of the paper.
    pub paper: String,
    /// Name of the item.
    pub item: String,
    /// What is compared.
    pub title: String,
    /// What a reader should know.
    pub notes: String,
    /// Seconds that its rows took when they ran.
    pub seconds: f64,
    /// Further columns of its table.
    pub columns: Vec<Column>,
    /// The rows in the order of the file.
    pub rows: Vec<RowReport>,
    /// Properties of splines that the paper prints and rows measured.
    pub properties: Vec<Property>,
    /// What is drawn of its surfaces.
    pub figures: Vec<Figure>,
    /// What is drawn of its figures.
    pub plots: Vec<Plot>,
}

/// One row with its result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RowReport {
    /// The row.
    pub row: Row,
    /// Where its mesh comes from.
    pub provenance: Provenance,
    /// The command that runs it again.
    pub command: String,
    /// What came out.
    pub result: RowResult,
    /// What is said about it.
    pub judgement: Judgement,
    /// Where it ran, and how its optimisation went.
    pub trace: Option<Trace>,
    /// What its pictures are drawn from.
    #[serde(skip)]
    pub sources: Option<Sources>,
}

/// How a row went.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trace {
    /// Where it ran.
    pub machine: Machine,
    /// Seconds that it took in all.
    pub seconds: f64,
    /// What the optimisation minimised, over time.
    pub history: Vec<HistoryPoint>,
}

/// Files that the pictures of a row are drawn from.
#[derive(Clone, Debug, PartialEq)]
pub struct Sources {
    /// The input of the row.
    pub input: crate::case::Input,
    /// The folder of [`crate::output::write_row_files`].
    pub files: PathBuf,
    /// Where the model is best seen from.
    pub view: Option<ViewHint>,
}

/// What came out of a row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RowResult {
    /// It ran, now or in a run before.
    Done(Box<Record>),
    /// It did not run, which is no failure.
    NotRun(String),
    /// It gave no result.
    Failed(String),
}

impl RowResult {
    /// Returns the record, if it ran.
    #[must_use]
    pub fn record(&self) -> Option<&Record> {
        match self {
            Self::Done(record) => Some(record),
            Self::NotRun(_) | Self::Failed(_) => None,
        }
    }
}

impl RowReport {
    /// Returns why this row makes the campaign end with an error, if it does.
    #[must_use]
    pub fn failure(&self) -> Option<String> {
        let why = self.judgement.failure()?;
        match &self.result {
            RowResult::Failed(reason) => Some(format!("{why}: {reason}")),
            RowResult::Done(_) | RowResult::NotRun(_) => Some(why),
        }
    }
}

impl ItemReport {
    /// Returns the row of this id.
    #[must_use]
    pub fn row(&self, id: &str) -> Option<&RowReport> {
        self.rows.iter().find(|report| report.row.id == id)
    }
}

impl Report {
    /// Returns every row that makes the campaign end with an error, as `paper item row: why`.
    #[must_use]
    pub fn failures(&self) -> Vec<String> {
        let mut failures = Vec::new();
        for item in &self.items {
            for row in &item.rows {
                if let Some(why) = row.failure() {
                    let id = &row.row.id;
                    failures.push(format!("{} {} {id}: {why}", item.paper, item.item));
                }
            }
        }
        failures
    }
}

impl Campaign {
    /// Runs all rows that are asked for and not taken from the store.
    ///
    /// A row that crashes or runs out of time is a failed row, and the others go on.
    ///
    /// # Errors
    /// Experiments that cannot be read or an output folder that cannot be written.
    pub fn run(&self, display: &Display) -> Result<Report, CampaignError> {
        let started = Instant::now();
        let experiments = self.experiments()?;
        let manifest = Manifest::read(&self.root.join("data/models.toml"))?;
        let rows = self.out.join("rows");
        let store =
            RowStore::open(&rows, &self.program.fingerprint).map_err(|e| output_error(&rows, e))?;
        let schedule = Schedule {
            campaign: self,
            manifest,
            models: models_folder(self.models.as_deref(), &self.root),
            store,
            display,
            ran: Mutex::default(),
        };
        let mut finished = schedule.run(&experiments)?.into_iter();
        let items = experiments
            .into_iter()
            .map(|experiment| {
                let rows = finished.by_ref().take(experiment.rows.len()).collect();
                item_report(experiment, rows)
            })
            .collect();
        Ok(Report {
            schema: REPORT_SCHEMA.to_owned(),
            tool: Tool::this(),
            machine: Machine::this(),
            times: if self.jobs <= 1 {
                Times::Comparable
            } else {
                Times::SideBySide
            },
            seconds: started.elapsed().as_secs_f64(),
            items,
        })
    }

    /// Returns the experiments that are asked for, cut down to the rows that are.
    fn experiments(&self) -> Result<Vec<Experiment>, CampaignError> {
        let folder = self.root.join("data/experiments");
        let mut all = experiments(&folder, self.paper.as_deref(), self.item.as_deref())?;
        if let Some(asked) = &self.row {
            let available: Vec<String> = all
                .iter()
                .flat_map(|experiment| experiment.rows.iter().map(|row| row.id.clone()))
                .collect();
            all.retain_mut(|experiment| experiment.restrict(asked));
            if all.is_empty() {
                return Err(CampaignError::UnknownRow {
                    asked: asked.clone(),
                    available: available.join(", "),
                });
            }
        }
        Ok(all)
    }
}

fn item_report(experiment: Experiment, mut rows: Vec<RowReport>) -> ItemReport {
    let mean = |report: &RowReport| {
        let record = report.result.record()?;
        record.error.as_ref().map(|error| error.mean)
    };
    let means: Vec<(String, Option<f64>)> = rows
        .iter()
        .map(|report| (report.row.id.clone(), mean(report)))
        .collect();
    for (report, (_, ours)) in rows.iter_mut().zip(&means) {
        if let RowResult::Done(record) = &report.result {
            let properties = &experiment.properties;
            let judgement = &mut report.judgement;
            judgement.judge_properties(&report.row.id, properties, record);
        }
        let Some(other) = &report.row.more_accurate_than else {
            continue;
        };
        let theirs = means
            .iter()
            .find(|(id, _)| id == other)
            .and_then(|(_, mean)| *mean);
        report.judgement.claim_holds = ours.zip(theirs).map(|(ours, theirs)| ours < theirs);
    }
    let seconds = rows
        .iter()
        .filter_map(|row| Some(row.trace.as_ref()?.seconds));
    ItemReport {
        seconds: seconds.sum(),
        paper: experiment.paper,
        item: experiment.item,
        title: experiment.title,
        notes: experiment.notes,
        columns: experiment.columns,
        rows,
        properties: experiment.properties,
        figures: experiment.figures,
        plots: experiment.plots,
    }
}

fn output_error(path: &Path, source: std::io::Error) -> CampaignError {
    CampaignError::Output {
        path: path.to_owned(),
        source,
    }
}
