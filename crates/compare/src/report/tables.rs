//! Tables for people: the judged errors, the costs, and the notes below them.

use crate::campaign::{ItemReport, RowReport, Times};
use crate::experiment::Column;
use crate::models::Provenance;
use crate::verdict::Regression;

use super::quantities::{Quantity, Unit, absence, cost_quantities, error_quantity};

/// A cell: what people read, and the number behind it, by which a column is sorted.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// What people read.
    pub text: String,
    /// The number behind it.
    pub value: Option<f64>,
}

impl Cell {
    /// Returns whether the cell says anything.
    #[must_use]
    pub fn says_something(&self) -> bool {
        self.text != NONE
    }

    /// Returns a cell without a number.
    pub(super) fn text(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            value: None,
        }
    }

    /// Returns a cell that shows `value` by `show`, or says that there is none.
    pub(super) fn number(value: Option<f64>, show: impl FnOnce(f64) -> String) -> Self {
        Self {
            text: value.map_or_else(|| NONE.to_owned(), show),
            value,
        }
    }
}

impl std::fmt::Display for Cell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text)
    }
}

/// A table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// What stands above it.
    pub title: String,
    /// Names of the columns.
    pub header: Vec<String>,
    /// Cells, row after row.
    pub rows: Vec<Vec<Cell>>,
}

/// An absent value.
pub(super) const NONE: &str = "-";

/// Returns the table `paper | ours | ratio | tolerance | verdict` of an item, with the columns that
/// its experiment asks for.
#[must_use]
pub fn error_table(item: &ItemReport) -> Table {
    let mut header = vec![
        "row",
        "vertices",
        "knots",
        "paper",
        "ours",
        "ratio",
        "tolerance",
        "verdict",
        "recorded",
        "regression",
    ];
    let distance = |report: &RowReport| report.result.record().and_then(|record| record.distance);
    let has_distance = item.rows.iter().any(|report| distance(report).is_some());
    if has_distance {
        header.push("distance, rms");
    }
    let columns: Vec<(&Column, bool)> = item
        .columns
        .iter()
        .map(|column| (column, is_printed(item, column)))
        .collect();
    let titles = columns.iter().flat_map(|(column, printed)| {
        let paper = printed.then(|| format!("{}, paper", column.title));
        paper.into_iter().chain([column.title.clone()])
    });
    let titles: Vec<String> = titles.collect();
    header.extend(titles.iter().map(String::as_str));
    let cells = |report: &RowReport| {
        let mut cells = error_cells(report);
        if has_distance {
            let found = distance(report);
            cells.push(Cell::number(found.map(|d| d.rms), |v| {
                Unit::Fraction.show(v)
            }));
        }
        let record = report.result.record();
        for (column, printed) in &columns {
            let show = |value: Option<f64>| Cell::number(value, |v| column.notation.show(v));
            if *printed {
                cells.push(show(printed_value(report, column)));
            }
            cells.push(show(record.and_then(|record| record.number(&column.path))));
        }
        cells
    };
    Table {
        title: format!("{} {}: {}", item.paper, item.item, item.title),
        header: header.into_iter().map(str::to_owned).collect(),
        rows: item.rows.iter().map(cells).collect(),
    }
}

/// Returns what the paper prints for a column.
fn printed_value(report: &RowReport, column: &Column) -> Option<f64> {
    let printed = &report.row.printed;
    match column.path.strip_prefix("checks.") {
        Some(name) => printed.checks.get(name).copied(),
        None if column.path == "seconds.total" => printed.total_seconds,
        None => None,
    }
}

fn is_printed(item: &ItemReport, column: &Column) -> bool {
    let mut rows = item.rows.iter();
    rows.any(|report| printed_value(report, column).is_some())
}

fn error_cells(report: &RowReport) -> Vec<Cell> {
    let quantity = error_quantity(report);
    let record = report.result.record();
    let show = |value: Option<f64>| Cell::number(value, |v| quantity.unit.show(v));
    let vertices = record.map(|record| record.input.vertices as f64);
    let knots = record.and_then(|record| {
        let checks = &record.checks;
        let knots = checks.get("knots").or_else(|| checks.get("controls"))?;
        knots.as_f64()
    });
    let tolerance =
        (quantity.paper.is_some() && report.row.tolerance > 0.0).then_some(report.row.tolerance);
    vec![
        Cell::text(&report.row.label),
        Cell::number(vertices, |v| Unit::Count.show(v)),
        match knots {
            Some(_) => Cell::number(knots, |v| Unit::Count.show(v)),
            None => Cell::text(report.row.asked_knots()),
        },
        show(quantity.paper),
        show(quantity.ours),
        ratio(quantity.ratio),
        Cell::number(tolerance, |t| format!("{:.0} %", 100.0 * t)),
        Cell::text(verdict(report)),
        recorded_cell(report, quantity.unit),
        Cell::text(match report.judgement.regression {
            Regression::NotRecorded => NONE,
            Regression::Kept => "kept",
            Regression::Improved => "improved",
            Regression::Regressed => "REGRESSED",
        }),
    ]
}

/// Decibels are recorded as the mean error behind them.
fn recorded_cell(report: &RowReport, unit: Unit) -> Cell {
    let Some(recorded) = report.row.recorded else {
        return Cell::text(NONE);
    };
    let of_what = if unit == Unit::Decibel { "mean " } else { "" };
    Cell::number(Some(recorded.error), |error| {
        let tolerance = 100.0 * recorded.tolerance;
        format!(
            "{of_what}{} (+{tolerance:.0} %)",
            Unit::Fraction.show(error)
        )
    })
}

/// Returns what is said about a row.
pub(super) fn verdict(report: &RowReport) -> String {
    let mut text = absence(report).unwrap_or_else(|| {
        let text = report.judgement.verdict.text();
        match report.provenance {
            Provenance::Real => text.to_owned(),
            other => format!("{text} ({})", other.text()),
        }
    });
    if let (Some(holds), Some(other)) =
        (report.judgement.claim_holds, &report.row.more_accurate_than)
    {
        let relation = if holds {
            "more accurate than"
        } else {
            "NOT more accurate than"
        };
        text.push_str(&format!(", {relation} {other}"));
    }
    text
}

/// Returns the table of times and memory of an item; rows without quantities are left out.
#[must_use]
pub fn cost_table(item: &ItemReport, times: Times) -> Table {
    let evaluates = item.rows.iter().any(|report| report.row.subdivide > 0);
    let mut header = vec![
        "row",
        "T_k paper",
        "T_k ours",
        "ratio",
        "T_f paper",
        "T_f ours",
        "ratio",
    ];
    if evaluates {
        header.extend(["evaluation paper", "evaluation ours", "ratio", "points"]);
    }
    header.extend(["total", "memory"]);
    let done = item
        .rows
        .iter()
        .filter(|report| report.result.record().is_some());
    let remark = match times {
        Times::Comparable => "never judged",
        Times::SideBySide => "rows ran side by side: not comparable",
    };
    Table {
        title: format!(
            "Times ({remark}) and memory; {:.0} s for all rows",
            item.seconds
        ),
        header: header.into_iter().map(str::to_owned).collect(),
        rows: done.map(|report| cost_cells(report, evaluates)).collect(),
    }
}

fn cost_cells(report: &RowReport, evaluates: bool) -> Vec<Cell> {
    let quantities = cost_quantities(report);
    let find = |name: &str| quantities.iter().find(|quantity| quantity.name == name);
    let show = |quantity: Option<&Quantity>, value: fn(&Quantity) -> Option<f64>| {
        let unit = quantity.map_or(Unit::Count, |q| q.unit);
        Cell::number(quantity.and_then(value), |v| unit.show(v))
    };
    let mut cells = vec![Cell::text(&report.row.label)];
    let mut compared = vec!["select_seconds", "fit_seconds"];
    if evaluates {
        compared.push("evaluate_seconds");
    }
    for name in compared {
        let quantity = find(name);
        cells.push(show(quantity, |f| f.paper));
        cells.push(show(quantity, |f| f.ours));
        cells.push(ratio(quantity.and_then(|f| f.ratio)));
    }
    if evaluates {
        cells.push(show(find("evaluated_points"), |f| f.ours));
    }
    cells.push(show(find("total_seconds"), |f| f.ours));
    cells.push(show(find("peak_rss_bytes"), |f| f.ours));
    cells
}

/// Returns what stands below the tables of an item: its notes and the analysis of each row.
#[must_use]
pub fn notes(item: &ItemReport) -> Vec<String> {
    let mut notes: Vec<String> = Vec::new();
    if !item.notes.trim().is_empty() {
        notes.push(one_line(&item.notes));
    }
    for rows in item.rows.chunk_by(|a, b| a.row.analysis == b.row.analysis) {
        if !rows[0].row.analysis.trim().is_empty() {
            let labels: Vec<&str> = rows
                .iter()
                .map(|report| report.row.label.as_str())
                .collect();
            notes.push(format!(
                "{}: {}",
                labels.join("; "),
                one_line(&rows[0].row.analysis)
            ));
        }
    }
    notes.extend(remarks(item));
    notes
}

/// Returns what is to be said of single rows: their bounds and their warnings.
pub(super) fn remarks(item: &ItemReport) -> Vec<String> {
    let mut remarks = Vec::new();
    for report in &item.rows {
        let label = &report.row.label;
        for bound in &report.judgement.bounds {
            let value = bound
                .value
                .map_or("missing".to_owned(), |v| format!("{v:.3e}"));
            let holds = if bound.holds() { "" } else { ", EXCEEDED" };
            let limit = bound
                .at_most
                .map_or_else(String::new, |limit| format!(", to be at most {limit:e}"));
            let quantity = &bound.quantity;
            remarks.push(format!("{label}: {quantity} is {value}{limit}{holds}"));
        }
        let record = report.result.record();
        let warnings = record.map_or(&[][..], |record| &record.warnings);
        remarks.extend(warnings.iter().map(|w| format!("{label}: warning: {w}")));
    }
    remarks
}

/// Returns a text on one line.
pub(super) fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn ratio(value: Option<f64>) -> Cell {
    Cell::number(value, |ratio| match ratio {
        _ if ratio < 0.01 => format!("{ratio:.4}"),
        _ => format!("{ratio:.2}"),
    })
}
