//! Plots of the quantities of rows.

use msplines_picture::plot::{self, Highlight, Look, Quantity, Series};

use super::super::tables::one_line;
use super::{DrawnPlot, svg_address};
use crate::campaign::{ItemReport, RowReport};
use crate::experiment::{Axis, MethodName, Plot};
use crate::record::Record;

/// Width and height of a plot in pixels.
const SIZE: [u32; 2] = [720, 480];

/// The points of one series of rows, or of one row along its history.
struct Line {
    name: String,
    points: Vec<[f64; 2]>,
}

/// Draws a plot; `None` where no row that ran has both quantities.
pub(super) fn plot(item: &ItemReport, plot: &Plot) -> Option<DrawnPlot> {
    let is_asked = |row: &&RowReport| plot.rows.is_empty() || plot.rows.contains(&row.row.id);
    let rows: Vec<&RowReport> = item.rows.iter().filter(is_asked).collect();
    let lines = if plot.x.is_history() {
        rows.iter().filter_map(|row| history(row, plot)).collect()
    } else {
        series(&rows, [plot.x, plot.y])
    };
    let picture = draw([plot.x, plot.y], &lines, None)?;
    Some(DrawnPlot {
        id: plot.id.clone(),
        caption: one_line(&plot.caption),
        look_for: one_line(&plot.look_for),
        picture,
        width: SIZE[0],
        height: SIZE[1],
    })
}

/// Draws distance against coefficients and against time for every surface of an item, with the
/// rows that no other beats in both.
pub(super) fn pareto(item: &ItemReport) -> Vec<DrawnPlot> {
    let domain = |row: &RowReport| row.row.model.clone().or_else(|| row.row.surface.clone());
    let mut plots = Vec::new();
    for rows in item.rows.chunk_by(|a, b| domain(a) == domain(b)) {
        let rows: Vec<&RowReport> = rows.iter().collect();
        let name = rows[0].row.label.split(',').next().unwrap_or_default();
        for (x, what) in [(Axis::Dofs, "free coefficients"), (Axis::Seconds, "time")] {
            let axes = [x, Axis::Distance];
            let lines = series(&rows, axes);
            let front = front(lines.iter().flat_map(|line| line.points.iter().copied()));
            let Some(picture) = draw(axes, &lines, Some(&front)) else {
                continue;
            };
            plots.push(DrawnPlot {
                id: format!("pareto-{}-{}", domain(rows[0]).unwrap_or_default(), plots.len()),
                caption: format!("{name}: distance between the surfaces against {what}."),
                look_for: "Lower and further left is better; the broad line is the Pareto front, which no result lies below and left of.".to_owned(),
                picture,
                width: SIZE[0],
                height: SIZE[1],
            });
        }
    }
    plots
}

/// Returns the points that no other point beats in both coordinates, from left to right.
fn front(points: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut sorted: Vec<[f64; 2]> = points.collect();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut front: Vec<[f64; 2]> = Vec::new();
    for point in sorted {
        if front.last().is_none_or(|best| point[1] < best[1]) {
            front.push(point);
        }
    }
    front
}

/// Returns the points of every series of rows, from left to right.
fn series(rows: &[&RowReport], axes: [Axis; 2]) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    for method in [
        MethodName::Biharmonic,
        MethodName::LsMesh,
        MethodName::SparseManifold,
        MethodName::CurveNetwork,
        MethodName::Chart,
        MethodName::Trivariate,
        MethodName::Conformal,
        MethodName::PowellSabin,
        MethodName::TSpline,
    ] {
        for row in rows.iter().filter(|row| row.row.method == method) {
            let record = row.result.record();
            let point = record.and_then(|r| Some([value(r, axes[0])?, value(r, axes[1])?]));
            let Some(point) = point else {
                continue;
            };
            let name = row.row.series();
            match lines.iter_mut().find(|line| line.name == name) {
                Some(line) => line.points.push(point),
                None => lines.push(Line {
                    name,
                    points: vec![point],
                }),
            }
        }
    }
    for line in &mut lines {
        line.points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    }
    lines
}

fn history(row: &RowReport, plot: &Plot) -> Option<Line> {
    let scale = row.result.record()?.error.as_ref()?.scale;
    let history = &row.trace.as_ref()?.history;
    let along = |axis: Axis, seconds: f64, objective: f64| match axis {
        Axis::Elapsed => seconds,
        _ => 100.0 * objective / scale,
    };
    let points: Vec<[f64; 2]> = history
        .iter()
        .filter(|point| point.phase == "select" && point.objective > 0.0)
        .map(|p| [plot.x, plot.y].map(|axis| along(axis, p.seconds, p.objective)))
        .collect();
    (!points.is_empty()).then(|| Line {
        name: row.row.label.clone(),
        points,
    })
}

/// Returns a quantity of a row in the units of its axis.
fn value(record: &Record, axis: Axis) -> Option<f64> {
    let error = record.error.as_ref();
    let knots = || {
        let checks = &record.checks;
        checks
            .get("knots")
            .or_else(|| checks.get("controls"))?
            .as_f64()
    };
    let value = match axis {
        Axis::Knots => knots()?,
        Axis::Dofs => record.dofs as f64,
        Axis::Error => 100.0 * error?.mean,
        Axis::Distance => 100.0 * record.distance?.rms,
        Axis::Psnr => error?.psnr_db?,
        Axis::Seconds => record.seconds.total,
        Axis::Elapsed | Axis::Objective => return None,
    };
    (value.is_finite() && value > 0.0).then_some(value)
}

fn draw(axes: [Axis; 2], lines: &[Line], front: Option<&[[f64; 2]]>) -> Option<String> {
    let quantity = |axis: Axis| match axis {
        Axis::Psnr | Axis::Elapsed => Quantity::linear(axis.title()),
        _ => Quantity::logarithmic(axis.title()),
    };
    let series = lines.iter().map(|line| Series {
        name: &line.name,
        points: &line.points,
        look: Look::LineAndMarks,
    });
    let plot = plot::Plot {
        x: quantity(axes[0]),
        y: quantity(axes[1]),
        series: series.collect(),
        highlight: front.map(|points| Highlight {
            name: "Pareto front",
            points,
        }),
        size: SIZE,
        ..plot::Plot::default()
    };
    plot.to_svg().ok().map(|svg| svg_address(&svg))
}

#[cfg(test)]
mod tests {
    use super::front;

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let points = [[3.0, 1.0], [1.0, 4.0], [2.0, 4.0], [2.0, 2.0], [4.0, 1.5]];
        assert_eq!(
            front(points.into_iter()),
            [[1.0, 4.0], [2.0, 2.0], [3.0, 1.0]]
        );
    }
}
