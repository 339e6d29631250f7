//! Plots of the gallery, with made-up numbers.

use msplines_picture::PictureError;
use msplines_picture::plot::{Bar, Bars, Highlight, Look, Note, Plot, Quantity, Series};

/// Returns curves over two logarithmic axes.
pub(crate) fn convergence() -> Result<String, PictureError> {
    let curve = |scale: f64, order: f64| -> Vec<[f64; 2]> {
        let knots = [100.0, 200.0, 400.0, 800.0, 1600.0, 3200.0, 6400.0];
        knots
            .map(|n| [n, scale * f64::powf(n / 100.0, -order)])
            .to_vec()
    };
    let curves = [
        curve(2e-2, 0.8),
        curve(3e-2, 1.1),
        curve(1.5e-2, 1.4),
        curve(4e-2, 0.6),
    ];
    let names = ["biharmonic", "Powell-Sabin", "T-spline", "least squares"];
    let series = names
        .iter()
        .zip(&curves)
        .map(|(name, points)| Series::new(name, points));
    let plot = Plot {
        title: "Error falls with the knots",
        x: Quantity::logarithmic("knots"),
        y: Quantity::logarithmic("RMS error / diagonal"),
        series: series.collect(),
        ..Plot::default()
    };
    plot.to_svg()
}

/// Returns points with names and a front of the best.
pub(crate) fn front() -> Result<String, PictureError> {
    let paper = [[1.2, 4.1e-5], [3.0, 2.0e-5], [7.5, 1.6e-5], [9.0, 3.5e-5]];
    let ours = [[0.8, 5.2e-5], [1.9, 2.2e-5], [4.4, 0.9e-5]];
    let best = [
        [0.8, 5.2e-5],
        [1.2, 4.1e-5],
        [1.9, 2.2e-5],
        [3.0, 2.0e-5],
        [4.4, 0.9e-5],
    ];
    let names = ["bunny", "horse", "dragon", "Lucy & <co>"];
    let notes = names
        .iter()
        .zip(&paper)
        .map(|(text, at)| Note { at: *at, text });
    let marks = |name, points| Series {
        look: Look::Marks,
        ..Series::new(name, points)
    };
    let plot = Plot {
        x: Quantity::linear("time (s)"),
        y: Quantity::linear("error / diagonal"),
        series: vec![marks("paper", &paper), marks("here", &ours)],
        notes: notes.collect(),
        highlight: Some(Highlight {
            name: "Pareto front",
            points: &best,
        }),
        ..Plot::default()
    };
    plot.to_svg()
}

/// Returns bars of running times.
pub(crate) fn times() -> Result<String, PictureError> {
    let bar = |name, value, kind| Bar { name, value, kind };
    let bars = [
        bar("ordering", 0.42, 0),
        bar("factorisation", 1.93, 0),
        bar("knot optimisation", 7.1, 1),
        bar("fit", 0.88, 1),
        bar("evaluation", f64::NAN, 2),
    ];
    let chart = Bars {
        title: "Where the time goes",
        ..Bars::new(Quantity::linear("seconds"), &bars)
    };
    chart.to_svg()
}
