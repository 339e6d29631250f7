//! The quantities of a row: what the paper prints, what we got, and the ratio.

use crate::campaign::{RowReport, RowResult};
use crate::experiment::Notation;
use crate::record::Record;

/// Numbers of this size and larger ones are written with a power of ten.
const LARGE: f64 = 1e6;
/// Numbers below this size are written with a power of ten.
const SMALL: f64 = 1e-3;
/// Digits of a number that is no count.
const DIGITS: i32 = 4;

/// Returns a number in its usual form: counts in full, others with four digits, and a power of ten
/// where it is very large or small.
pub(super) fn show_number(value: f64) -> String {
    let size = value.abs();
    if size >= LARGE || (size > 0.0 && size < SMALL) {
        return format!("{value:.1e}");
    }
    if value.fract() == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let before = size.log10().floor() as i32 + 1;
    let places = (DIGITS - before).clamp(0, DIGITS) as usize;
    let text = format!("{value:.places$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

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

impl Notation {
    /// Returns a value as tables for people show it.
    #[must_use]
    pub fn show(self, value: f64) -> String {
        match self {
            Self::Number => show_number(value),
            Self::Percent => Unit::Fraction.show(value),
            Self::Scientific => format!("{value:.2e}"),
            Self::Seconds => Unit::Seconds.show(value),
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
    let in_decibels = over_time || report.row.data.are_colours();
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
    if report.row.subdivide > 0 {
        let points = record.and_then(|record| record.checks.get("evaluated_points")?.as_f64());
        let evaluate = seconds(&["evaluate"]);
        let paper = printed.evaluate_seconds;
        quantities.push(Quantity::new(
            "evaluate_seconds",
            Unit::Seconds,
            paper,
            evaluate,
        ));
        quantities.push(Quantity::new("evaluated_points", Unit::Count, None, points));
    }
    quantities.push(Quantity::new(
        "total_seconds",
        Unit::Seconds,
        printed.total_seconds,
        total,
    ));
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

#[cfg(test)]
mod tests {
    use super::{Notation, show_number};

    #[test]
    fn numbers_have_their_usual_form() {
        let shown = [
            (0.0, "0"),
            (7753.0, "7753"),
            (2.22e-16, "2.2e-16"),
            (1e-12, "1.0e-12"),
            (-0.25, "-0.25"),
            (0.012_345, "0.0123"),
            (12.345_6, "12.35"),
            (1234.56, "1235"),
            (1234.96, "1235"),
            (1100.4, "1100"),
            (3.2e9, "3.2e9"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
        ];
        for (value, text) in shown {
            assert_eq!(show_number(value), text);
        }
        assert_eq!(Notation::Percent.show(0.5), "50.0000 %");
        assert_eq!(Notation::Scientific.show(1234.5), "1.23e3");
        assert_eq!(Notation::Seconds.show(1.5), "1.50 s");
    }
}
