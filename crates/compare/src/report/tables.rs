//! Tables for people: the judged errors, the costs, and the notes below them.

use crate::campaign::{ItemReport, RowReport, Times};
use crate::models::Provenance;
use crate::verdict::{Bound, Regression};

use super::quantities::{Quantity, Unit, absence, cost_quantities, error_quantity};

/// A table of texts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    /// What stands above it.
    pub title: String,
    /// Names of the columns.
    pub header: Vec<String>,
    /// Cells, row after row.
    pub rows: Vec<Vec<String>>,
}

/// An absent value.
const NONE: &str = "-";

/// Returns the table `paper | ours | ratio | tolerance | verdict` of an item.
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
    let cells = |report: &RowReport| {
        let mut cells = error_cells(report);
        if has_distance {
            let found = distance(report);
            cells.push(found.map_or(NONE.to_owned(), |d| Unit::Fraction.show(d.rms)));
        }
        cells
    };
    Table {
        title: format!("{} {}: {}", item.paper, item.item, item.title),
        header: header.into_iter().map(str::to_owned).collect(),
        rows: item.rows.iter().map(cells).collect(),
    }
}

fn error_cells(report: &RowReport) -> Vec<String> {
    let quantity = error_quantity(report);
    let record = report.result.record();
    let show = |value: Option<f64>| value.map_or(NONE.to_owned(), |v| quantity.unit.show(v));
    let knots = record.and_then(|record| {
        record
            .checks
            .get("knots")
            .or_else(|| record.checks.get("controls"))?
            .as_u64()
    });
    let recorded = report.row.recorded;
    let judgement = &report.judgement;
    vec![
        report.row.label.clone(),
        record.map_or(NONE.to_owned(), |record| record.input.vertices.to_string()),
        knots.map_or(report.row.asked_knots(), |knots| knots.to_string()),
        show(quantity.paper),
        show(quantity.ours),
        ratio(quantity.ratio),
        if quantity.paper.is_some() && report.row.tolerance > 0.0 {
            format!("{:.0} %", 100.0 * report.row.tolerance)
        } else {
            NONE.to_owned()
        },
        verdict(report),
        recorded.map_or(NONE.to_owned(), |recorded| {
            format!(
                "{}{:.4} % (+{:.0} %)",
                // Decibels are recorded as the mean error behind them.
                if quantity.unit == Unit::Decibel {
                    "mean "
                } else {
                    ""
                },
                100.0 * recorded.error,
                100.0 * recorded.tolerance
            )
        }),
        match judgement.regression {
            Regression::NotRecorded => NONE.to_owned(),
            Regression::Kept => "kept".to_owned(),
            Regression::Improved => "improved".to_owned(),
            Regression::Regressed => "REGRESSED".to_owned(),
        },
    ]
}

fn verdict(report: &RowReport) -> String {
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
        title: format!("Times ({remark}) and memory"),
        header: header.into_iter().map(str::to_owned).collect(),
        rows: done.map(|report| cost_cells(report, evaluates)).collect(),
    }
}

fn cost_cells(report: &RowReport, evaluates: bool) -> Vec<String> {
    let quantities = cost_quantities(report);
    let find = |name: &str| quantities.iter().find(|quantity| quantity.name == name);
    let show = |quantity: Option<&Quantity>, value: fn(&Quantity) -> Option<f64>| {
        quantity
            .and_then(|f| Some(f.unit.show(value(f)?)))
            .unwrap_or_else(|| NONE.to_owned())
    };
    let mut cells = vec![report.row.label.clone()];
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
    for report in &item.rows {
        notes.extend(report.judgement.bounds.iter().map(|bound| {
            let value = bound.value.map_or("missing".to_owned(), |v| format!("{v:.3e}"));
            let Bound {
                quantity, at_most, ..
            } = bound;
            let holds = if bound.holds() { "" } else { ", EXCEEDED" };
            format!(
                "{}: {quantity} is {value}, to be at most {at_most:e}{holds}",
                report.row.label
            )
        }));
        let warnings = report
            .result
            .record()
            .map_or(&[][..], |record| &record.warnings);
        notes.extend(
            warnings
                .iter()
                .map(|w| format!("{}: warning: {w}", report.row.label)),
        );
    }
    notes
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn ratio(value: Option<f64>) -> String {
    match value {
        Some(ratio) if ratio < 0.01 => format!("{ratio:.4}"),
        Some(ratio) => format!("{ratio:.2}"),
        None => NONE.to_owned(),
    }
}
