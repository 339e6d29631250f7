//! What the template of the page is filled with.

use std::path::Path;

use serde::Serialize;

use super::super::PageOptions;
use super::super::drawing::{Drawings, DrawnItem};
use super::super::properties::{Matrix, matrix};
use super::super::references::{self, Reference};
use super::super::tables::{self, Table, cost_table, error_table};
use super::super::viewer::Viewer;
use crate::campaign::{ItemReport, Report, RowReport, RowResult, Times};
use crate::experiment::PaperFacts;
use crate::verdict::{Regression, Verdict};

/// The whole page.
#[derive(Serialize)]
pub(super) struct Page<'a> {
    counts: Counts,
    version: &'a str,
    commit: &'a str,
    rustc: &'a str,
    cpu: &'a str,
    cores: usize,
    system: &'a str,
    side_by_side: bool,
    failures: Vec<Remark>,
    differences: Vec<Remark>,
    absent: Vec<Absent>,
    papers: Vec<Paper<'a>>,
    references: Option<Grid>,
    viewer: Option<&'a str>,
    no_viewer: Option<&'a str>,
}

/// How many rows ended how.
#[derive(Serialize)]
struct Counts {
    all: usize,
    ran: usize,
    failed: usize,
    differ: usize,
}

/// Something said about rows that have the same analysis.
#[derive(Serialize)]
struct Remark {
    rows: Vec<RemarkedRow>,
    why: String,
}

#[derive(Serialize)]
struct RemarkedRow {
    anchor: String,
    place: String,
    row: String,
    what: String,
}

/// Rows that did not run for the same reason.
#[derive(Serialize)]
struct Absent {
    reason: String,
    rows: Vec<String>,
}

#[derive(Serialize)]
struct Paper<'a> {
    key: &'a str,
    title: String,
    citation: String,
    items: Vec<Item<'a>>,
}

#[derive(Serialize)]
struct Item<'a> {
    anchor: String,
    name: &'a str,
    title: &'a str,
    notes: String,
    table: Grid,
    matrix: Option<Matrix>,
    costs: Option<Grid>,
    remarks: Vec<String>,
    drawn: Option<&'a DrawnItem>,
}

/// A table for the template.
#[derive(Serialize)]
struct Grid {
    id: String,
    title: String,
    header: Vec<Column>,
    rows: Vec<Line>,
    has_source: bool,
}

#[derive(Serialize)]
struct Column {
    name: String,
    is_number: bool,
}

#[derive(Serialize)]
struct Line {
    anchor: String,
    class: &'static str,
    cells: Vec<GridCell>,
    analysis: String,
    source: Option<Vec<(&'static str, String)>>,
}

#[derive(Serialize)]
struct GridCell {
    text: String,
    value: Option<f64>,
}

pub(super) fn page<'a>(
    report: &'a Report,
    drawings: &'a Drawings,
    options: &PageOptions<'a>,
) -> Page<'a> {
    let rows = || report.items.iter().flat_map(|item| &item.rows);
    let differs =
        |row: &&RowReport| matches!(row.judgement.verdict, Verdict::Better | Verdict::Worse);
    let (script, reason) = match options.viewer {
        Viewer::Script(script) => (Some(script.as_str()), None),
        Viewer::Absent(reason) => (None, Some(reason.as_str())),
    };
    Page {
        counts: Counts {
            all: rows().count(),
            ran: rows().filter(|row| row.result.record().is_some()).count(),
            failed: rows().filter(|row| row.failure().is_some()).count(),
            differ: rows().filter(differs).count(),
        },
        version: &report.tool.version,
        commit: &report.tool.commit,
        rustc: &report.tool.rustc,
        cpu: &report.machine.cpu,
        cores: report.machine.cores,
        system: &report.machine.system,
        side_by_side: report.times == Times::SideBySide,
        failures: remarks(report, |row| row.failure()),
        differences: remarks(report, |row| {
            (differs(&row) && row.failure().is_none()).then(|| tables::verdict(row))
        }),
        absent: absent(report),
        papers: papers(report, drawings, options.experiments),
        references: compared(options.references),
        viewer: script,
        no_viewer: reason,
    }
}

fn remarks(report: &Report, say: impl Fn(&RowReport) -> Option<String>) -> Vec<Remark> {
    let mut remarks: Vec<Remark> = Vec::new();
    for item in &report.items {
        for row in &item.rows {
            let Some(what) = say(row) else { continue };
            let remarked = RemarkedRow {
                anchor: row_anchor(item, row),
                place: format!("{} {}", item.paper, item.item),
                row: row.row.label.clone(),
                what,
            };
            let why = tables::one_line(&row.row.analysis);
            match remarks.iter_mut().find(|remark| remark.why == why) {
                Some(remark) => remark.rows.push(remarked),
                None => remarks.push(Remark {
                    rows: vec![remarked],
                    why,
                }),
            }
        }
    }
    remarks
}

fn absent(report: &Report) -> Vec<Absent> {
    let mut found: Vec<Absent> = Vec::new();
    for item in &report.items {
        for row in &item.rows {
            let RowResult::NotRun(reason) = &row.result else {
                continue;
            };
            let name = format!("{} {} {}", item.paper, item.item, row.row.id);
            match found.iter_mut().find(|absent| absent.reason == *reason) {
                Some(absent) => absent.rows.push(name),
                None => found.push(Absent {
                    reason: reason.clone(),
                    rows: vec![name],
                }),
            }
        }
    }
    found
}

fn papers<'a>(report: &'a Report, drawings: &'a Drawings, experiments: &Path) -> Vec<Paper<'a>> {
    let mut papers: Vec<Paper<'a>> = Vec::new();
    for (item, drawn) in report.items.iter().zip(&drawings.items) {
        if papers.last().is_none_or(|paper| paper.key != item.paper) {
            let facts = PaperFacts::read(experiments, &item.paper);
            papers.push(Paper {
                key: &item.paper,
                title: facts.title,
                citation: facts.citation,
                items: Vec::new(),
            });
        }
        if let Some(paper) = papers.last_mut() {
            paper.items.push(item_context(report, item, drawn));
        }
    }
    papers
}

fn item_context<'a>(report: &Report, item: &'a ItemReport, drawn: &'a DrawnItem) -> Item<'a> {
    let anchor = format!("{}-{}", item.paper, item.item);
    let lines = item.rows.iter().map(|row| Line {
        anchor: row_anchor(item, row),
        class: class(row),
        cells: Vec::new(),
        analysis: tables::one_line(&row.row.analysis),
        source: Some(source(row)),
    });
    let errors = grid(&anchor, "errors", &error_table(item), lines.collect());
    let costs = cost_table(item, report.times);
    let has_costs = !costs.rows.is_empty();
    let costs = grid(&anchor, "costs", &costs, Vec::new());
    Item {
        anchor,
        name: &item.item,
        title: &item.title,
        notes: tables::one_line(&item.notes),
        table: errors,
        matrix: matrix(item),
        costs: has_costs.then_some(costs),
        remarks: tables::remarks(item),
        drawn: (!drawn.is_empty()).then_some(drawn),
    }
}

/// Returns a table whose lines are `lines`, or bare ones where there are none.
fn grid(anchor: &str, kind: &str, table: &Table, mut lines: Vec<Line>) -> Grid {
    let has_source = !lines.is_empty();
    lines.resize_with(table.rows.len(), || Line {
        anchor: String::new(),
        class: "",
        cells: Vec::new(),
        analysis: String::new(),
        source: None,
    });
    // A column without anything in it only makes the table wider.
    let columns = 0..table.header.len();
    let is_shown = |&column: &usize| table.rows.iter().any(|row| row[column].says_something());
    let columns: Vec<usize> = columns.filter(is_shown).collect();
    for (line, cells) in lines.iter_mut().zip(&table.rows) {
        line.cells = columns
            .iter()
            .map(|&column| &cells[column])
            .map(|cell| GridCell {
                text: cell.text.clone(),
                value: cell.value.filter(|value| value.is_finite()),
            })
            .collect();
    }
    let header = columns.iter().map(|&column| Column {
        name: table.header[column].clone(),
        is_number: table.rows.iter().any(|row| row[column].value.is_some()),
    });
    Grid {
        id: format!("{anchor}-{kind}"),
        title: table.title.clone(),
        header: header.collect(),
        rows: lines,
        has_source,
    }
}

/// Returns the table of comparisons with other code, if there are any.
fn compared(found: &[Reference]) -> Option<Grid> {
    let table = references::table(found);
    (!found.is_empty()).then(|| grid("references", "deviations", &table, Vec::new()))
}

fn row_anchor(item: &ItemReport, row: &RowReport) -> String {
    format!("{}-{}-{}", item.paper, item.item, row.row.id)
}

fn class(row: &RowReport) -> &'static str {
    match (&row.result, row.judgement.verdict) {
        _ if row.failure().is_some() => "failed",
        (RowResult::NotRun(_), _) => "absent",
        (_, Verdict::Better) => "better",
        (_, Verdict::Worse) => "worse",
        (_, Verdict::Reproduced) => "reproduced",
        _ if row.judgement.regression == Regression::Improved => "better",
        _ => "",
    }
}

/// Returns where the figures of a row come from.
fn source(row: &RowReport) -> Vec<(&'static str, String)> {
    let mut facts = vec![
        ("command", row.command.clone()),
        ("mesh", row.provenance.text().to_owned()),
    ];
    if let Some(record) = row.result.record() {
        facts.push(("file", record.input.file.clone()));
        facts.push(("sha256", record.input.sha256.clone()));
        facts.push(("options", record.options.to_string()));
        facts.push(("seed", record.seed.to_string()));
        facts.push(("outcome", text_of(&record.outcome)));
        facts.push(("commit", record.tool.commit.clone()));
        facts.push(("rustc", record.tool.rustc.clone()));
        facts.push(("threads", record.threads.to_string()));
        facts.push(("cpu seconds", format!("{:.1}", record.seconds.cpu)));
        for warning in &record.warnings {
            facts.push(("warning", warning.clone()));
        }
    }
    if let Some(trace) = &row.trace {
        let machine = &trace.machine;
        let text = format!(
            "{}, {} cores, {}",
            machine.cpu, machine.cores, machine.system
        );
        facts.push(("machine", text));
    }
    facts
}

fn text_of(value: &impl Serialize) -> String {
    let value = serde_json::to_value(value).unwrap_or_default();
    value.as_str().unwrap_or_default().to_owned()
}
