//! The quantities of a row: what the paper prints, what we got, and the ratio.

use crate::campaign::{RowReport, RowResult};
use crate::record::Record;

/// One quantity of a row.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// Name of the quantity, such as `error_mean`.
    pub name: &'static str,
    /// Its unit.
    pub unit: Unit,
    /// What the paper prints.
    pub paper: Option<f64>,
    /// What we got.
    pub ours: Option<f64>,
    /// Ours over the paper's.
    pub ratio: Option<f64>,
}

/// Unit of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A fraction in files, percent in tables for people.
    Fraction,
    /// Decibels.
    Decibel,
    /// Seconds of wall time.
    Seconds,
    /// Bytes in files, mebibytes in tables for people.
    Bytes,
    /// A count.
    Count,
}

impl Unit {
    /// Returns the name of the unit in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Fraction => "fraction",
            Self::Decibel => "dB",
            Self::Seconds => "s",
            Self::Bytes => "bytes",
            Self::Count => "count",
        }
    }

    /// Returns a value as tables for people show it.
    #[must_use]
    pub fn show(self, value: f64) -> String {
        match self {
            Self::Fraction if value != 0.0 && value.abs() < 1e-6 => {
                format!("{:.1e} %", 100.0 * value)
            }
            Self::Fraction => format!("{:.4} %", 100.0 * value),
            Self::Decibel => format!("{value:.1} dB"),
            Self::Seconds if value < 10.0 => format!("{value:.2} s"),
            Self::Seconds => format!("{value:.0} s"),
            Self::Bytes => format!("{:.0} MiB", value / f64::from(1 << 20)),
            Self::Count => format!("{value:.0}"),
        }
    }
}

impl Quantity {
    fn new(name: &'static str, unit: Unit, paper: Option<f64>, ours: Option<f64>) -> Self {
        let ratio = ours.zip(paper).map(|(ours, paper)| ours / paper);
        Self {
            name,
            unit,
            paper,
            ours,
            ratio,
        }
    }
}

/// Returns the quantity of a row that is judged: its mean error, or decibels for colours.
#[must_use]
pub fn error_quantity(report: &RowReport) -> Quantity {
    let printed = &report.row.printed;
    let error = report
        .result
        .record()
        .and_then(|record| record.error.as_ref());
    let over_time = report.row.over_time.is_some();
    let in_decibels = over_time || report.row.data == crate::experiment::RowData::ColourPattern;
    let mut quantity = if in_decibels {
        let ours = error.and_then(|error| error.psnr_db);
        Quantity::new("psnr_db", Unit::Decibel, printed.psnr_db, ours)
    } else {
        Quantity::new(
            "error_mean",
            Unit::Fraction,
            printed.error,
            error.map(|error| error.mean),
        )
    };
    // Decibels have no ratio of their own: the judgement holds that of the root mean squares.
    quantity.ratio = report.judgement.ratio;
    quantity
}

/// Returns the quantities of a row that are shown and never judged: times, memory, points.
#[must_use]
pub fn cost_quantities(report: &RowReport) -> Vec<Quantity> {
    let (printed, record) = (&report.row.printed, report.result.record());
    let seconds = |names: &[&str]| record.map(|record| phase_seconds(record, names));
    let total = record.map(|record| record.seconds.total);
    let memory = record.map(|record| record.peak_rss_bytes as f64);
    let mut quantities = vec![
        Quantity::new(
            "select_seconds",
            Unit::Seconds,
            printed.select_seconds,
            seconds(&["domain", "select"]),
        ),
        Quantity::new(
            "fit_seconds",
            Unit::Seconds,
            printed.fit_seconds,
            seconds(&["fit"]),
        ),
    ];
    if report.row.is_evaluated() {
        let check = |name: &str| record.and_then(|record| record.checks.get(name)?.as_f64());
        let points = check("evaluated_points");
        let evaluate = match report.row.over_time {
            Some(_) => check("evaluate_seconds_median"),
            None => seconds(&["evaluate"]),
        };
        let paper = printed.evaluate_seconds;
        quantities.push(Quantity::new(
            "evaluate_seconds",
            Unit::Seconds,
            paper,
            evaluate,
        ));
        quantities.push(Quantity::new("evaluated_points", Unit::Count, None, points));
    }
    quantities.push(Quantity::new("total_seconds", Unit::Seconds, None, total));
    quantities.push(Quantity::new("peak_rss_bytes", Unit::Bytes, None, memory));
    quantities
}

/// Returns why a row has no quantities, if it has none.
pub(super) fn absence(report: &RowReport) -> Option<String> {
    match &report.result {
        RowResult::Done(_) => None,
        RowResult::NotRun(reason) => Some(format!("not run: {reason}")),
        RowResult::Failed(reason) => Some(format!("failed: {reason}")),
    }
}

fn phase_seconds(record: &Record, names: &[&str]) -> f64 {
    let phases = names
        .iter()
        .filter_map(|&name| record.seconds.phases.get(name));
    // An empty sum of floating-point numbers is -0.
    phases.fold(0.0, |sum, seconds| sum + seconds)
}
