//! Least squares with smoothing, coarse to fine.
//!
//! # Notation
//! `f` minimises `sum of w |f - x|² + λ W ∫ |f_uu|² + |f_vv|² + |f_ww|²` over its control points, with the
//! total weight `W` and derivatives in units of spans. Inside of the cube that is `λ W / n³` times the
//! squared second differences of the control points; near its faces it stays a measure of the solid,
//! where differences of control points that hardly act would tie it to them.

mod assemble;
mod precondition;
mod stencil;

use std::ops::ControlFlow;

use faer::{Mat, MatRef};
use msplines_common::linalg::{CgReport, CgTolerance, conjugate_gradient};
use msplines_common::progress::{Observer, Outcome, Progress};
use msplines_common::{Point3, Vector3};
use nalgebra::{SMatrix, SVector, SymmetricEigen};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::doubling;
use crate::error::FitError;
pub use crate::options::LeastSquares as Options;
use crate::samples::VolumeSamples;
use crate::spline::{TrivariateSpline, refine_lattice};
pub(crate) use assemble::{Equations, assemble};
pub(crate) use precondition::BlockInverse;
#[cfg(test)]
pub(crate) use stencil::Stencil;

/// Most spans: the rows of 64 take 0.8 GB.
pub const MOST_SPANS: usize = 64;

/// Least eigenvalue, against the largest, of the products of trilinear functions over the samples.
const DETERMINED: f64 = 1e-12;

/// Samples that one task evaluates.
const BATCH: usize = 4096;

/// A fit, and how it went.
#[derive(Clone, Debug, PartialEq)]
pub struct LeastSquaresFit {
    /// The solid.
    pub spline: TrivariateSpline,
    /// Each level, coarsest first.
    pub levels: Vec<Level>,
    /// How it ended.
    pub outcome: Outcome,
}

/// How a level went.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Level {
    /// Spans in each direction.
    pub spans: usize,
    /// Weighted root mean square of the distances of the samples.
    pub rms: f64,
    /// Largest distance of a sample.
    pub max: f64,
    /// Steps of conjugate gradients.
    pub iterations: u32,
    /// Residual of the equations against their right-hand side.
    pub residual: f64,
}

/// Returns the solid that approximates samples in the sense of least squares.
///
/// Each level starts from the one before, exactly refined. The cost of a level is that of its
/// equations, about 343 times the samples and 16,000 times the spans, and of 9 to 18 steps of
/// conjugate gradients over 343 numbers for each control point.
///
/// # Reference
/// [Kim2014] §5. Deviation: least squares instead of multilevel B-splines, which come less close with
/// more control points.
///
/// # Errors
/// Levels that do not double or are too fine; numbers out of range; samples that leave a trilinear map
/// open.
pub fn fit(
    samples: &VolumeSamples,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<LeastSquaresFit, FitError> {
    let spans = check(samples, options)?;
    let mut problem = Problem::start(samples, options);
    let (mut levels, mut outcome) = (Vec::new(), Outcome::Converged);
    for (done, &n) in spans.iter().enumerate() {
        let (_, report) = problem.solve(n);
        let (rms, max) = residuals(samples, &problem.spline());
        levels.push(Level {
            spans: n,
            rms,
            max,
            iterations: report.iterations,
            residual: report.residual,
        });
        outcome = [Outcome::MaxIterations, Outcome::Converged][usize::from(report.converged)];
        let progress = Progress::new("fit", done as u64 + 1, spans.len() as u64);
        if observer(&progress.with_objective(rms)) == ControlFlow::Break(()) && n < options.finest {
            outcome = Outcome::Stopped;
            break;
        }
    }
    Ok(LeastSquaresFit {
        spline: problem.spline(),
        levels,
        outcome,
    })
}

/// The levels of a fit whose options and samples make sense.
pub(crate) fn check(samples: &VolumeSamples, options: &Options) -> Result<Vec<usize>, FitError> {
    let (coarsest, finest) = (options.coarsest, options.finest);
    let Some(spans) = doubling(coarsest, finest) else {
        return Err(FitError::Levels { coarsest, finest });
    };
    if finest > MOST_SPANS {
        return Err(FitError::TooFine {
            spans: finest,
            most: MOST_SPANS,
        });
    }
    for (name, value) in [
        ("smoothing", options.smoothing),
        ("tolerance", options.tolerance),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            let range = "above 0";
            return Err(FitError::Number { name, value, range });
        }
    }
    if !determined(samples) {
        return Err(FitError::Undetermined);
    }
    Ok(spans)
}

/// Whether the samples leave no trilinear map open: those are what smoothing does not see.
fn determined(samples: &VolumeSamples) -> bool {
    let mut products = SMatrix::<f64, 8, 8>::zeros();
    for (at, &weight) in samples.parameters().iter().zip(samples.weights()) {
        let at = at.map(|t| [1.0, 2.0 * t - 1.0]);
        let row = SVector::<f64, 8>::from_fn(|i, _| at[0][i % 2] * at[1][i / 2 % 2] * at[2][i / 4]);
        products.ger(weight, &row, &row, 1.0);
    }
    let eigenvalues = SymmetricEigen::new(products).eigenvalues;
    eigenvalues.min() > DETERMINED * eigenvalues.max()
}

/// The equations of a level and what solves them approximately.
pub(crate) struct System {
    pub(crate) equations: Equations,
    pub(crate) inverse: BlockInverse,
}

/// Samples, options, and the solid so far: one lattice after another for each coordinate, around the
/// mean of the points.
pub(crate) struct Problem<'a> {
    samples: &'a VolumeSamples,
    options: &'a Options,
    centre: [f64; 3],
    spans: usize,
    values: Vec<f64>,
}

impl<'a> Problem<'a> {
    pub(crate) fn start(samples: &'a VolumeSamples, options: &'a Options) -> Self {
        let weighted = samples.points().iter().zip(samples.weights());
        let sum: Vector3<f64> = weighted.map(|(p, &w)| p.coords * w).sum();
        Self {
            samples,
            options,
            centre: (sum / samples.total_weight()).into(),
            spans: 0,
            values: Vec::new(),
        }
    }

    /// Solves on a level, which is the first or has twice the spans of the one before.
    pub(crate) fn solve(&mut self, spans: usize) -> (System, CgReport) {
        let lattice = (spans + 3).pow(3);
        let mut equations = assemble(self.samples, spans, self.centre);
        let weight = self.samples.total_weight() / spans.pow(3) as f64;
        let matrix = &mut equations.matrix;
        matrix.add_second_derivatives(self.options.smoothing * weight);
        let inverse = BlockInverse::build(&equations.matrix);
        let mut x = Mat::zeros(lattice, 3);
        if self.spans > 0 {
            let coarse = self.values.chunks_exact((self.spans + 3).pow(3));
            for (column, values) in coarse.enumerate() {
                let fine = refine_lattice(self.spans, 1, values);
                x.col_mut(column).copy_from(faer::ColRef::from_slice(&fine));
            }
        }
        let system = System { equations, inverse };
        let report = self.iterate(&system, &mut x);
        self.spans = spans;
        self.values = columns(x.as_ref());
        (system, report)
    }

    /// Conjugate gradients until what is left to gain is a small share of the squared error.
    ///
    /// The squared error is not known beforehand: it is measured, and again if it has changed much.
    fn iterate(&self, system: &System, x: &mut Mat<f64>) -> CgReport {
        let (equations, constant) = (&system.equations, self.constant());
        let mut error = equations.energy(&columns(x.as_ref()), constant);
        let mut total = 0;
        loop {
            let share = self.options.tolerance * error / 3.0;
            let report = conjugate_gradient(
                |x| over_columns(x, |x| equations.matrix.apply(x)),
                |x| over_columns(x, |x| system.inverse.apply(x)),
                |_| {},
                MatRef::from_column_major_slice(&equations.right, x.nrows(), 3),
                x,
                CgTolerance::Energy(share),
                self.options.max_iterations - total,
            );
            total += report.iterations;
            let before = error;
            error = equations.energy(&columns(x.as_ref()), constant);
            if !report.converged || report.iterations == 0 || error > 0.5 * before {
                return CgReport {
                    iterations: total,
                    ..report
                };
            }
        }
    }

    /// Weighted sum of the squares of the points around their mean.
    pub(crate) fn constant(&self) -> f64 {
        let weighted = self.samples.points().iter().zip(self.samples.weights());
        weighted
            .map(|(p, w)| w * (p - Point3::from(self.centre)).norm_squared())
            .sum()
    }

    /// The solid so far.
    pub(crate) fn spline(&self) -> TrivariateSpline {
        to_spline(self.spans, &self.values, self.centre)
    }

    /// Coordinates of the control points around the centre, one lattice after another.
    pub(crate) fn values(&self) -> &[f64] {
        &self.values
    }

    pub(crate) fn centre(&self) -> [f64; 3] {
        self.centre
    }
}

/// The spline of three lattices around a centre.
pub(crate) fn to_spline(spans: usize, values: &[f64], centre: [f64; 3]) -> TrivariateSpline {
    let lattice = values.len() / 3;
    let point = |at| (0..3).map(move |d| values[d * lattice + at] + centre[d]);
    let flat: Vec<f64> = (0..lattice).flat_map(point).collect();
    TrivariateSpline::from_flat(spans, &flat)
}

fn columns(x: MatRef<'_, f64>) -> Vec<f64> {
    x.col_iter().flat_map(|c| c.iter().copied()).collect()
}

fn over_columns(x: MatRef<'_, f64>, operator: impl FnOnce(&[f64]) -> Vec<f64>) -> Mat<f64> {
    let product = operator(&columns(x));
    MatRef::from_column_major_slice(&product, x.nrows(), x.ncols()).to_owned()
}

/// Weighted root mean square and maximum of the distances of samples from a solid.
pub(crate) fn residuals(samples: &VolumeSamples, spline: &TrivariateSpline) -> (f64, f64) {
    let distance = |(&at, point): (&[f64; 3], &Point3<f64>)| (spline.position(at) - point).norm();
    let distances: Vec<f64> = samples
        .parameters()
        .par_iter()
        .with_min_len(BATCH)
        .zip(samples.points())
        .map(distance)
        .collect();
    let weighted = distances.iter().zip(samples.weights());
    let squares: f64 = weighted.map(|(d, w)| w * d * d).sum();
    let max = distances.iter().copied().fold(0.0, f64::max);
    ((squares / samples.total_weight()).sqrt(), max)
}
