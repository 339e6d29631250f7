//! A campaign runs the rows of experiments, stores each at once, and judges them all.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::case::{Case, Input};
use crate::display::Display;
use crate::experiment::{Experiment, ExperimentError, Row, experiments};
use crate::models::{Located, Manifest, Provenance, models_folder};
use crate::record::{Record, Tool};
use crate::row_process::{RowProgram, RowRequest, run_row};
use crate::store::{RowStore, Stored, row_key};
use crate::verdict::{Judgement, Verdict};

/// The schema of [`Report`].
pub const REPORT_SCHEMA: &str = "msplines.report/1";

/// Which rows run, and how.
#[derive(Clone, Debug)]
pub struct Campaign {
    /// The project's folder, which holds `data/`.
    pub root: PathBuf,
    /// Only this paper.
    pub paper: Option<String>,
    /// Only this item of it.
    pub item: Option<String>,
    /// Folder of the models; `$MSPLINES_MODELS` or `data/models` where absent.
    pub models: Option<PathBuf>,
    /// Whether rows for `--full` run too.
    pub full: bool,
    /// Folder of stored rows and of the report.
    pub out: PathBuf,
    /// Whether stored rows are ignored.
    pub fresh: bool,
    /// Rows at the same time; more than one makes times not comparable.
    pub jobs: usize,
    /// The program that runs a row.
    pub program: RowProgram,
}

/// Why a campaign cannot start.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CampaignError {
    /// An experiment or the manifest of models cannot be used.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
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
    /// Whether its times can be compared.
    pub times: Times,
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
    /// The rows in the order of the file.
    pub rows: Vec<RowReport>,
}

/// One row with its result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RowReport {
    /// The row.
    pub row: Row,
    /// Where its mesh comes from.
    pub provenance: Provenance,
    /// What came out.
    pub result: RowResult,
    /// What is said about it.
    pub judgement: Judgement,
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

impl Report {
    /// Returns every row that makes the campaign end with an error, as `paper item row: why`.
    #[must_use]
    pub fn failures(&self) -> Vec<String> {
        let mut failures = Vec::new();
        for item in &self.items {
            for RowReport {
                row,
                result,
                judgement,
                ..
            } in &item.rows
            {
                let Some(why) = judgement.failure() else {
                    continue;
                };
                let reason = match result {
                    RowResult::Failed(reason) => format!(": {reason}"),
                    RowResult::Done(_) | RowResult::NotRun(_) => String::new(),
                };
                failures.push(format!(
                    "{} {} {}: {why}{reason}",
                    item.paper, item.item, row.id
                ));
            }
        }
        failures
    }
}

impl Campaign {
    /// Runs all rows that are asked for and not yet stored.
    ///
    /// A row that crashes or runs out of time is a failed row, and the others go on.
    ///
    /// # Errors
    /// Experiments that cannot be read or an output folder that cannot be written.
    pub fn run(&self, display: &Display) -> Result<Report, CampaignError> {
        let data = self.root.join("data");
        let paper = self.paper.as_deref();
        let experiments = experiments(&data.join("experiments"), paper, self.item.as_deref())?;
        let manifest = Manifest::read(&data.join("models.toml"))?;
        let models = models_folder(self.models.as_deref(), &self.root);
        let rows = self.out.join("rows");
        let store = RowStore::open(&rows).map_err(|e| output_error(&rows, e))?;
        let context = Context {
            campaign: self,
            manifest,
            models,
            store,
            display,
        };
        let all: Vec<&Row> = experiments.iter().flat_map(|e| &e.rows).collect();
        let mut finished = context.run_all(&all)?.into_iter();
        let items = experiments
            .iter()
            .map(|experiment| {
                let rows = finished.by_ref().take(experiment.rows.len()).collect();
                item_report(experiment, rows)
            })
            .collect();
        Ok(Report {
            schema: REPORT_SCHEMA.to_owned(),
            tool: Tool::this(),
            times: if self.jobs <= 1 {
                Times::Comparable
            } else {
                Times::SideBySide
            },
            items,
        })
    }
}

/// A running campaign.
struct Context<'a> {
    campaign: &'a Campaign,
    manifest: Manifest,
    models: PathBuf,
    store: RowStore,
    display: &'a Display,
}

impl Context<'_> {
    /// Runs rows on as many threads as there are jobs; results come in the order of the rows.
    fn run_all(&self, rows: &[&Row]) -> Result<Vec<RowReport>, CampaignError> {
        let next = AtomicUsize::new(0);
        let results = Mutex::new(Vec::with_capacity(rows.len()));
        std::thread::scope(|scope| {
            for _ in 0..self.campaign.jobs.max(1) {
                scope.spawn(|| {
                    loop {
                        let index = next.fetch_add(1, Ordering::Relaxed);
                        let Some(row) = rows.get(index) else { return };
                        let result = self.run_one(row);
                        let mut results = results.lock().unwrap_or_else(|e| e.into_inner());
                        results.push((index, result));
                    }
                });
            }
        });
        let mut results = results.into_inner().unwrap_or_else(|e| e.into_inner());
        results.sort_by_key(|&(index, _)| index);
        results.into_iter().map(|(_, result)| result).collect()
    }

    fn run_one(&self, row: &Row) -> Result<RowReport, CampaignError> {
        let (result, provenance) = match self.plan(row) {
            Plan::Run {
                case,
                input_digest,
                provenance,
            } => (self.stored_or_run(row, &case, &input_digest)?, provenance),
            Plan::Not { result, provenance } => (result, provenance),
        };
        let judgement = match &result {
            RowResult::Done(record) => Judgement::of(row, provenance, record.error.as_ref()),
            RowResult::NotRun(_) => Judgement::without_figures(row, Verdict::NotRun),
            RowResult::Failed(_) => Judgement::without_figures(row, Verdict::Failed),
        };
        Ok(RowReport {
            row: row.clone(),
            provenance,
            result,
            judgement,
        })
    }

    fn plan(&self, row: &Row) -> Plan {
        let not = |result| Plan::Not {
            result,
            provenance: Provenance::Generated,
        };
        let (input, input_digest, provenance) = match (&row.model, &row.surface) {
            (Some(name), _) => {
                let Some(model) = self.manifest.model(name) else {
                    return not(RowResult::Failed(format!(
                        "no model {name} in data/models.toml"
                    )));
                };
                if row.full_only && !self.campaign.full {
                    let result = RowResult::NotRun("only with --full".to_owned());
                    return Plan::Not {
                        result,
                        provenance: model.provenance(),
                    };
                }
                match model.locate(&self.models) {
                    Located::Found(path) => (
                        Input::File {
                            path,
                            repair: false,
                        },
                        model.sha256.clone(),
                        model.provenance(),
                    ),
                    Located::Missing(why) => {
                        return Plan::Not {
                            result: RowResult::NotRun(why),
                            provenance: model.provenance(),
                        };
                    }
                }
            }
            (None, _) if row.full_only && !self.campaign.full => {
                return not(RowResult::NotRun("only with --full".to_owned()));
            }
            (None, surface) => match surface.as_deref().unwrap_or_default().parse() {
                Ok(surface) => {
                    let surface: crate::generated::GeneratedSurface = surface;
                    (
                        Input::Surface(surface),
                        format!("generated {surface}"),
                        Provenance::Generated,
                    )
                }
                Err(error) => return not(RowResult::Failed(error.to_string())),
            },
        };
        match row.case(input) {
            Ok(case) => Plan::Run {
                case: Box::new(case),
                input_digest,
                provenance,
            },
            Err(error) => not(RowResult::Failed(error.to_string())),
        }
    }

    fn stored_or_run(
        &self,
        row: &Row,
        case: &Case,
        input_digest: &str,
    ) -> Result<RowResult, CampaignError> {
        let threads = self.threads();
        let program = &self.campaign.program;
        let key = row_key(case, input_digest, &program.program, threads)
            .map_err(|e| output_error(&program.program, e))?;
        if !self.campaign.fresh {
            match self
                .store
                .load(&key)
                .map_err(|e| output_error(&self.campaign.out, e))?
            {
                Stored::Finished(record) => {
                    self.display
                        .line(&format!("{}: from a run before", row.label));
                    return Ok(RowResult::Done(record));
                }
                Stored::Damaged(aside) => self.display.line(&format!(
                    "{}: its stored row is damaged, set aside as {}; it runs again",
                    row.label,
                    aside.display()
                )),
                Stored::Nothing => {}
            }
        }
        let mut task = self.display.task(&row.label);
        let request = RowRequest {
            case: case.clone(),
            threads,
        };
        let limit = Duration::from_secs_f64(row.time_limit_seconds);
        let result = run_row(program, &request, limit, &mut |step| {
            task.show(&step.phase, step.done, step.total, None);
        });
        match result {
            Ok(record) => {
                self.store
                    .save(&key, &record)
                    .map_err(|e| output_error(&self.campaign.out, e))?;
                task.finish(&format!("{:.1} s", record.seconds.total));
                Ok(RowResult::Done(Box::new(record)))
            }
            Err(reason) => {
                task.finish(&format!("failed: {reason}"));
                Ok(RowResult::Failed(reason))
            }
        }
    }

    /// Returns the threads of each row: the machine's, shared among the jobs.
    fn threads(&self) -> usize {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        (cores / self.campaign.jobs.max(1)).max(1)
    }
}

/// What becomes of a row.
enum Plan {
    Run {
        case: Box<Case>,
        input_digest: String,
        provenance: Provenance,
    },
    Not {
        result: RowResult,
        provenance: Provenance,
    },
}

fn item_report(experiment: &Experiment, mut rows: Vec<RowReport>) -> ItemReport {
    let mean = |report: &RowReport| {
        report
            .result
            .record()?
            .error
            .as_ref()
            .map(|error| error.mean)
    };
    let means: Vec<(String, Option<f64>)> = rows
        .iter()
        .map(|report| (report.row.id.clone(), mean(report)))
        .collect();
    for (report, (_, ours)) in rows.iter_mut().zip(&means) {
        let Some(other) = &report.row.more_accurate_than else {
            continue;
        };
        let theirs = means
            .iter()
            .find(|(id, _)| id == other)
            .and_then(|(_, mean)| *mean);
        report.judgement.claim_holds = ours.zip(theirs).map(|(ours, theirs)| ours < theirs);
    }
    ItemReport {
        paper: experiment.paper.clone(),
        item: experiment.item.clone(),
        title: experiment.title.clone(),
        notes: experiment.notes.clone(),
        rows,
    }
}

fn output_error(path: &Path, source: std::io::Error) -> CampaignError {
    CampaignError::Output {
        path: path.to_owned(),
        source,
    }
}
