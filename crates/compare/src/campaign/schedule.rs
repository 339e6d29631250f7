//! Running rows: which first, which side by side, what is taken from the store, what is shown.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use super::plan::{Plan, Planned, plan};
use super::{Campaign, CampaignError, Reuse, RowReport, RowResult, Sources, Trace, output_error};
use crate::display::{Display, Overall};
use crate::experiment::{Ancestors, Experiment, Row};
use crate::machine::Machine;
use crate::models::{Manifest, Provenance};
use crate::output::{ROW_KNOTS, ROW_SURFACE};
use crate::row_process::{RowAnswer, RowRequest, run_row};
use crate::store::{EndedRow, RowStore, Stored, row_key};
use crate::verdict::{Judgement, Verdict};

/// All that rows need to run.
pub(super) struct Schedule<'a> {
    pub(super) campaign: &'a Campaign,
    pub(super) manifest: Manifest,
    pub(super) models: PathBuf,
    pub(super) store: RowStore,
    pub(super) display: &'a Display,
    /// Keys of the rows that this campaign ran: an item may show a row of another one.
    pub(super) ran: Mutex<BTreeSet<String>>,
}

/// When a stored row ran.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ran {
    Now,
    Before,
}

impl Ran {
    fn text(self) -> &'static str {
        match self {
            Self::Now => "the same as a row above",
            Self::Before => "from a run before",
        }
    }
}

/// A row in its experiment, and the earlier rows that it needs, as indices.
struct Item<'a> {
    experiment: &'a Experiment,
    row: &'a Row,
    first: usize,
}

/// Rows that have ended, and news of them.
struct Board {
    ended: Mutex<Vec<Option<Result<RowReport, CampaignError>>>>,
    news: Condvar,
}

impl Schedule<'_> {
    /// Runs all rows on as many threads as there are jobs; results come in the order of the rows.
    ///
    /// Rows are taken in order and need only earlier ones, so that waiting for those ends.
    pub(super) fn run(&self, experiments: &[Experiment]) -> Result<Vec<RowReport>, CampaignError> {
        let mut items: Vec<Item<'_>> = Vec::new();
        for experiment in experiments {
            let first = items.len();
            items.extend(experiment.rows.iter().map(|row| Item {
                experiment,
                row,
                first,
            }));
        }
        let board = Board {
            ended: Mutex::new((0..items.len()).map(|_| None).collect()),
            news: Condvar::new(),
        };
        let next = AtomicUsize::new(0);
        let overall = self.display.overall(items.len());
        std::thread::scope(|scope| {
            for _ in 0..self.campaign.jobs.max(1) {
                scope.spawn(|| {
                    loop {
                        let index = next.fetch_add(1, Ordering::Relaxed);
                        let Some(item) = items.get(index) else { return };
                        let ended = self.run_row(item, &board, &overall);
                        board.lock()[index] = Some(ended);
                        board.news.notify_all();
                    }
                });
            }
        });
        overall.finish();
        let ended = board.ended.into_inner().unwrap_or_else(|e| e.into_inner());
        ended.into_iter().flatten().collect()
    }

    fn run_row(
        &self,
        item: &Item<'_>,
        board: &Board,
        overall: &Overall,
    ) -> Result<RowReport, CampaignError> {
        let row = item.row;
        let planned = match board.ancestors(item) {
            Ok(ancestors) => plan(self.campaign, &self.manifest, &self.models, row, &ancestors),
            Err(missing) => Plan {
                provenance: Provenance::Generated,
                run: Err(RowResult::NotRun(format!(
                    "needs row {missing}, which has no result"
                ))),
            },
        };
        let mut report = RowReport {
            row: row.clone(),
            provenance: planned.provenance,
            command: self.command(item),
            result: RowResult::NotRun(String::new()),
            judgement: Judgement::without_figures(row, Verdict::NotRun),
            trace: None,
            sources: None,
        };
        match planned.run {
            Ok(planned) => self.stored_or_run(&planned, &mut report, overall)?,
            Err(result) => {
                report.result = result;
                overall.passed_over();
            }
        }
        report.judgement = judgement(&report);
        Ok(report)
    }

    fn stored_or_run(
        &self,
        planned: &Planned,
        report: &mut RowReport,
        overall: &Overall,
    ) -> Result<(), CampaignError> {
        let label = &report.row.label;
        let key = row_key(&planned.case, &planned.input_digest, self.threads())
            .map_err(|e| output_error(&self.campaign.out, e))?;
        let files = self.store.files(&key);
        let stored = self.store.load(&key);
        let stored = stored.map_err(|e| output_error(&self.campaign.out, e))?;
        if let Stored::Damaged(aside) = &stored {
            self.display.line(&format!(
                "warning: {label}: its stored row is damaged, set aside as {}",
                aside.display()
            ));
        }
        report.sources = Some(Sources {
            input: planned.case.input.clone(),
            files,
            view: planned.view,
        });
        let ran_now = if self.ran().contains(&key) {
            Ran::Now
        } else {
            Ran::Before
        };
        if let Some(ended) = self.taken(stored, report, ran_now) {
            self.display.line(&format!("{label}: {}", ran_now.text()));
            overall.passed_over();
            report.take(ended);
            return Ok(());
        }
        if self.campaign.reuse == Reuse::Everything {
            report.result = RowResult::NotRun("not in the store".to_owned());
            report.sources = None;
            overall.passed_over();
            return Ok(());
        }
        let ended = self.start(planned, report, &key, overall)?;
        self.ran().insert(key);
        report.take(ended);
        Ok(())
    }

    fn ran(&self) -> MutexGuard<'_, BTreeSet<String>> {
        self.ran.lock().unwrap_or_else(|e| e.into_inner())
    }

    /// Returns the stored row where it is to be taken.
    fn taken(&self, stored: Stored, report: &RowReport, ran_now: Ran) -> Option<EndedRow> {
        let (ended, is_current) = match stored {
            Stored::Ended(ended) => (*ended, true),
            Stored::Stale(ended) => (*ended, false),
            Stored::Nothing | Stored::Damaged(_) => return None,
        };
        let has_result = matches!(ended.answer, RowAnswer::Record(_));
        let is_taken = match self.campaign.reuse {
            _ if ran_now == Ran::Now => true,
            Reuse::Finished => is_current && has_result,
            Reuse::Nothing => false,
            Reuse::Everything => true,
            Reuse::AllButFailed => {
                let mut as_stored = report.clone();
                as_stored.take(ended.clone());
                judgement(&as_stored).failure().is_none()
            }
        };
        is_taken.then_some(ended)
    }

    fn start(
        &self,
        planned: &Planned,
        report: &RowReport,
        key: &str,
        overall: &Overall,
    ) -> Result<EndedRow, CampaignError> {
        let campaign = self.campaign;
        let unwritable = |e| output_error(&campaign.out, e);
        let files = self.store.unfinished(key).map_err(unwritable)?;
        let request = RowRequest {
            case: planned.case.clone(),
            threads: self.threads(),
            files,
        };
        let own = report.row.time_limit_seconds;
        let limit = campaign.time_limit.map_or(own, |limit| limit.min(own));
        let mut task = self.display.task(&report.row.label);
        let started = Instant::now();
        let mut history = Vec::new();
        let answer = run_row(
            &campaign.program,
            &request,
            Duration::from_secs_f64(limit),
            &mut |step| {
                history.extend(step.history_point(started));
                task.show(&step.phase, step.done, step.total, step.objective);
            },
        );
        let seconds = started.elapsed().as_secs_f64();
        let (answer, said) = match answer {
            Ok(record) => {
                let said = finished_line(&record);
                (RowAnswer::Record(Box::new(record)), said)
            }
            Err(reason) => {
                let said = format!("failed: {reason}");
                (RowAnswer::Error(reason), said)
            }
        };
        task.finish(&said);
        overall.advance(seconds);
        let ended = EndedRow {
            answer,
            history,
            seconds,
            machine: Machine::this(),
        };
        self.store
            .save(key, &ended, &request.files)
            .map_err(unwritable)?;
        Ok(ended)
    }

    /// Returns the threads of each row: those asked for, else the machine's, shared among the jobs.
    fn threads(&self) -> usize {
        if let Some(threads) = self.campaign.threads {
            return threads.max(1);
        }
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        (cores / self.campaign.jobs.max(1)).max(1)
    }

    /// Returns the command that runs a row again, on whatever folder of models.
    fn command(&self, item: &Item<'_>) -> String {
        let Experiment {
            paper, item: name, ..
        } = item.experiment;
        let mut command = format!("cargo xtask repro {paper} {name} {}", item.row.id);
        if item.row.model.is_some() {
            command.push_str(" --models DIR");
        }
        if item.row.full_only {
            command.push_str(" --full");
        }
        if self.campaign.jobs > 1 {
            command.push_str(&format!(" --jobs {}", self.campaign.jobs));
        }
        if let Some(threads) = self.campaign.threads {
            command.push_str(&format!(" --threads {threads}"));
        }
        command
    }
}

impl Board {
    fn lock(&self) -> MutexGuard<'_, Vec<Option<Result<RowReport, CampaignError>>>> {
        self.ended.lock().unwrap_or_else(|e| e.into_inner())
    }

    /// Waits for the rows that `item` needs and returns their files, or the first without any.
    fn ancestors(&self, item: &Item<'_>) -> Result<Ancestors, String> {
        Ok(Ancestors {
            knots: self.file_of(item, item.row.knots_from.as_ref(), ROW_KNOTS)?,
            reference: self.file_of(item, item.row.compared_with.as_ref(), ROW_SURFACE)?,
        })
    }

    fn file_of(
        &self,
        item: &Item<'_>,
        row: Option<&String>,
        file: &str,
    ) -> Result<Option<PathBuf>, String> {
        let Some(id) = row else { return Ok(None) };
        let at = item.experiment.rows.iter().position(|row| row.id == *id);
        let index = item.first + at.ok_or_else(|| id.clone())?;
        let mut ended = self.lock();
        while ended[index].is_none() {
            ended = self.news.wait(ended).unwrap_or_else(|e| e.into_inner());
        }
        let Some(Ok(report)) = &ended[index] else {
            return Err(id.clone());
        };
        match (&report.result, &report.sources) {
            (RowResult::Done(_), Some(sources)) => Ok(Some(sources.files.join(file))),
            _ => Err(id.clone()),
        }
    }
}

impl RowReport {
    /// Takes the result of a row that has ended.
    fn take(&mut self, ended: EndedRow) {
        self.result = match ended.answer {
            RowAnswer::Record(record) => RowResult::Done(record),
            RowAnswer::Error(reason) => RowResult::Failed(reason),
        };
        self.trace = Some(Trace {
            machine: ended.machine,
            seconds: ended.seconds,
            history: ended.history,
        });
    }
}

fn judgement(report: &RowReport) -> Judgement {
    let row = &report.row;
    match &report.result {
        RowResult::Done(record) => Judgement::of(row, report.provenance, record),
        RowResult::NotRun(_) => Judgement::without_figures(row, Verdict::NotRun),
        RowResult::Failed(_) => Judgement::without_figures(row, Verdict::Failed),
    }
}

fn finished_line(record: &crate::record::Record) -> String {
    let seconds = record.seconds.total;
    match &record.error {
        Some(error) => format!("mean error {:.4} %, {seconds:.1} s", 100.0 * error.mean),
        None => format!("{seconds:.1} s"),
    }
}
