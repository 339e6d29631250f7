//! The matrix of properties of an item: a line per property, a column per spline, what the paper
//! prints above what rows measured.

use serde::Serialize;

use super::quantities::show_number;
use super::tables::{Cell, NONE, Table, one_line};
use crate::campaign::ItemReport;
use crate::experiment::{Measured, Property, splines};
use crate::verdict::Bound;

/// The matrix.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Matrix {
    pub(super) splines: Vec<Spline>,
    pub(super) lines: Vec<Line>,
}

/// A column.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Spline {
    pub(super) name: String,
    /// Whether no row measured anything of it.
    pub(super) is_only_printed: bool,
}

/// A property.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Line {
    pub(super) name: String,
    pub(super) remark: String,
    pub(super) cells: Vec<Entry>,
}

/// A property of a spline.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Entry {
    pub(super) printed: String,
    pub(super) measured: Option<Finding>,
}

/// What a row measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Finding {
    pub(super) row: String,
    pub(super) text: String,
    pub(super) mark: Mark,
}

/// Whether a property holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Mark {
    /// It does.
    Ok,
    /// It does not, or the row did not measure it.
    Missed,
    /// The row gave no figures.
    NotRun,
}

impl Mark {
    fn text(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Missed => "MISSED",
            Self::NotRun => "not run",
        }
    }
}

/// Returns the matrix of an item, if it has properties.
pub(super) fn matrix(item: &ItemReport) -> Option<Matrix> {
    let properties = &item.properties;
    let names = splines(properties);
    let line = |property: &Property| Line {
        name: property.name.clone(),
        remark: one_line(&property.remark),
        cells: names
            .iter()
            .map(|name| entry(item, property, name))
            .collect(),
    };
    let column = |name: &&str| Spline {
        name: (*name).to_owned(),
        is_only_printed: !properties.iter().any(|p| p.measured.contains_key(*name)),
    };
    (!properties.is_empty()).then(|| Matrix {
        splines: names.iter().map(column).collect(),
        lines: properties.iter().map(line).collect(),
    })
}

fn entry(item: &ItemReport, property: &Property, spline: &str) -> Entry {
    let finding = |measured: &Measured| {
        let judgement = item.row(&measured.row).map(|report| &report.judgement);
        let checks = judgement.map_or(&[][..], |judgement| &judgement.properties);
        let check = checks
            .iter()
            .find(|check| check.property == property.name && check.spline == spline);
        let (text, mark) = match check {
            Some(check) => said(measured, &check.bound),
            None => (measured.row.clone(), Mark::NotRun),
        };
        Finding {
            row: measured.row.clone(),
            text,
            mark,
        }
    };
    Entry {
        printed: property
            .printed
            .get(spline)
            .map_or_else(|| NONE.to_owned(), |text| one_line(text)),
        measured: property.measured.get(spline).map(finding),
    }
}

fn said(measured: &Measured, bound: &Bound) -> (String, Mark) {
    let value = bound.value.map_or("missing".to_owned(), show_number);
    let text = one_line(&measured.says).replace(Measured::VALUE, &value);
    let mark = if bound.holds() {
        Mark::Ok
    } else {
        Mark::Missed
    };
    let at_most = bound.at_most.map_or_else(String::new, |bound| {
        format!(", at most {}", show_number(bound))
    });
    (text + &at_most, mark)
}

/// Returns the matrix of an item as a table whose cells have a line for what is printed and one
/// for what was measured; without rows where the item has no properties.
#[must_use]
pub fn property_table(item: &ItemReport) -> Table {
    let (splines, lines) = matrix(item).map_or_else(Default::default, |m| (m.splines, m.lines));
    let has_remarks = lines.iter().any(|line| !line.remark.is_empty());
    let mut header = vec!["property".to_owned()];
    header.extend(splines.into_iter().map(|spline| {
        let note = if spline.is_only_printed {
            " (printed)"
        } else {
            ""
        };
        spline.name + note
    }));
    if has_remarks {
        header.push("remark".to_owned());
    }
    let row = |line: Line| {
        let mut row = vec![Cell::text(line.name)];
        row.extend(line.cells.into_iter().map(|entry| {
            let measured = entry
                .measured
                .map(|m| format!("\n{}: {}", m.text, m.mark.text()));
            Cell::text(entry.printed + &measured.unwrap_or_default())
        }));
        if has_remarks {
            row.push(Cell::text(line.remark));
        }
        row
    };
    Table {
        title: "Properties: what is printed, and what was measured".to_owned(),
        header,
        rows: lines.into_iter().map(row).collect(),
    }
}
