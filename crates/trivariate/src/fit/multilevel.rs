//! Multilevel B-splines: corrections that double in resolution.
//!
//! # Notation
//! A sample of residual `z` asks each of the 64 control points around it for `w z / sum of w²`, `w` the
//! product of its three basis functions; a control point takes the mean of what it is asked for,
//! weighted by `w²`.
//!
//! # Reference
//! [Kim2014] Eq. (2), §5; [LeeWolbergShin1997] Eq. (3), Eq. (5), §3.

use std::ops::ControlFlow;

use msplines_common::Vector3;
use msplines_common::bspline::{locate, weights};
use msplines_common::progress::{Observer, Outcome, Progress};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::doubling;
use crate::error::FitError;
pub use crate::options::Multilevel as Options;
use crate::samples::VolumeSamples;
use crate::spline::TrivariateSpline;

/// Samples that one task evaluates.
const BATCH: usize = 4096;

/// A fit, level by level.
#[derive(Clone, Debug, PartialEq)]
pub struct MultilevelFit {
    /// All levels added up on the finest lattice.
    pub spline: TrivariateSpline,
    /// What each level adds, coarsest first.
    pub corrections: Vec<TrivariateSpline>,
    /// Residuals after each level.
    pub levels: Vec<Level>,
    /// `MaxIterations` where a residual was asked for and not reached.
    pub outcome: Outcome,
}

/// Residuals after a level.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Level {
    /// Spans in each direction.
    pub spans: usize,
    /// Weighted root mean square of the distances of the samples.
    pub rms: f64,
    /// Largest distance of a sample.
    pub max: f64,
    /// Control points with a sample in their support.
    pub supported: usize,
}

impl MultilevelFit {
    /// Returns the solid after `levels` levels, on the lattice of the last of them: a level of detail.
    /// All levels if there are fewer.
    ///
    /// # Reference
    /// [Kim2014] Fig. 9, §6.
    ///
    /// # Panics
    /// Never: lattices of a fit have a refinement.
    #[must_use]
    pub fn at_level(&self, levels: usize) -> TrivariateSpline {
        sum(&self.corrections[..levels.clamp(1, self.corrections.len())])
    }
}

/// Corrections added up on the lattice of the last one.
fn sum(corrections: &[TrivariateSpline]) -> TrivariateSpline {
    let mut total = corrections[0].clone();
    for correction in &corrections[1..] {
        let refined = total
            .refined()
            .expect("as many spans as the next level has");
        total = refined.plus(correction);
    }
    total
}

/// Returns the multilevel B-spline of samples; one fit of a single level if the options name one.
///
/// Control points that no sample sees are 0 in the correction of a level. Weights of samples multiply
/// what they ask for. Levels are added up by exact refinement. Costs about 64 times the samples
/// for each level.
///
/// # Reference
/// [Kim2014] Eq. (2), §5; [LeeWolbergShin1997] §3, §4. Deviation: samples may have weights.
///
/// # Errors
/// Levels that do not double, or a stopping residual that means nothing.
pub fn fit(
    samples: &VolumeSamples,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<MultilevelFit, FitError> {
    let (coarsest, finest) = (options.coarsest, options.finest);
    let Some(spans) = doubling(coarsest, finest) else {
        return Err(FitError::Levels { coarsest, finest });
    };
    if !(0.0..f64::INFINITY).contains(&options.stop_rms) {
        return Err(FitError::Number {
            name: "stop_rms",
            value: options.stop_rms,
            range: "of at least 0",
        });
    }
    let mut state = State::sorted(samples, finest);
    let (mut corrections, mut levels) = (Vec::new(), Vec::new());
    let mut outcome = Outcome::Converged;
    let total = spans.len() as u64;
    for (done, &n) in spans.iter().enumerate() {
        let (lattice, supported) = state.approximate(n);
        state.subtract(n, &lattice);
        let (rms, max) = state.residuals();
        let flat: Vec<f64> = lattice.iter().flat_map(|c| [c[0], c[1], c[2]]).collect();
        corrections.push(TrivariateSpline::from_flat(n, &flat));
        levels.push(Level {
            spans: n,
            rms,
            max,
            supported,
        });
        if options.stop_rms > 0.0 {
            let reached = rms <= options.stop_rms;
            outcome = [Outcome::MaxIterations, Outcome::Converged][usize::from(reached)];
            if reached {
                break;
            }
        }
        let progress = Progress::new("fit", done as u64 + 1, total).with_objective(rms);
        if observer(&progress) == ControlFlow::Break(()) && n < finest {
            outcome = Outcome::Stopped;
            break;
        }
    }
    Ok(MultilevelFit {
        spline: sum(&corrections),
        corrections,
        levels,
        outcome,
    })
}

/// Samples in the order of the finest spans, so that neighbours share control points in the cache.
struct State {
    parameters: Vec<[f64; 3]>,
    weights: Vec<f64>,
    residuals: Vec<Vector3<f64>>,
}

impl State {
    fn sorted(samples: &VolumeSamples, finest: usize) -> Self {
        let (order, _) = samples.by_span(finest);
        let pick = |&at: &u32| at as usize;
        Self {
            parameters: order
                .iter()
                .map(|at| samples.parameters()[pick(at)])
                .collect(),
            weights: order.iter().map(|at| samples.weights()[pick(at)]).collect(),
            residuals: order
                .iter()
                .map(|at| samples.points()[pick(at)].coords)
                .collect(),
        }
    }

    /// The lattice of one level, three coordinates and a sum of weights at each place, and how many
    /// places a sample sees.
    fn approximate(&self, spans: usize) -> (Vec<[f64; 4]>, usize) {
        let size = spans + 3;
        let mut lattice = vec![[0.0; 4]; size.pow(3)];
        for ((parameter, &weight), z) in self
            .parameters
            .iter()
            .zip(&self.weights)
            .zip(&self.residuals)
        {
            let (start, [u, v, w]) = basis(spans, *parameter);
            let squares = [u, v, w].map(|row| row.iter().map(|b| b * b).sum::<f64>());
            let asked = z / squares.iter().product::<f64>();
            for (jk, vw) in (0..16).map(|jk| (jk, v[jk % 4] * w[jk / 4])) {
                let at = start + size * (jk % 4 + size * (jk / 4));
                for (place, b) in lattice[at..at + 4].iter_mut().zip(u) {
                    let b = b * vw;
                    let square = weight * b * b;
                    let cube = square * b;
                    place[0] += cube * asked.x;
                    place[1] += cube * asked.y;
                    place[2] += cube * asked.z;
                    place[3] += square;
                }
            }
        }
        let mut supported = 0;
        for place in &mut lattice {
            if place[3] > 0.0 {
                supported += 1;
                *place = [place[0], place[1], place[2], 1.0].map(|c| c / place[3]);
            }
        }
        (lattice, supported)
    }

    /// Takes the values of a lattice from the residuals.
    fn subtract(&mut self, spans: usize, lattice: &[[f64; 4]]) {
        let size = spans + 3;
        let batches = self.residuals.par_chunks_mut(BATCH);
        batches
            .zip(self.parameters.par_chunks(BATCH))
            .for_each(|(residuals, parameters)| {
                for (residual, parameter) in residuals.iter_mut().zip(parameters) {
                    let (start, [u, v, w]) = basis(spans, *parameter);
                    let mut value = [0.0; 4];
                    for (jk, vw) in (0..16).map(|jk| (jk, v[jk % 4] * w[jk / 4])) {
                        let at = start + size * (jk % 4 + size * (jk / 4));
                        for (place, b) in lattice[at..at + 4].iter().zip(u) {
                            let b = b * vw;
                            for (sum, c) in value.iter_mut().zip(place) {
                                *sum += b * c;
                            }
                        }
                    }
                    *residual -= Vector3::new(value[0], value[1], value[2]);
                }
            });
    }

    /// Weighted root mean square and largest norm of the residuals.
    fn residuals(&self) -> (f64, f64) {
        let (mut squares, mut total, mut max) = (0.0, 0.0, 0.0_f64);
        for (residual, weight) in self.residuals.iter().zip(&self.weights) {
            squares += weight * residual.norm_squared();
            total += weight;
            max = max.max(residual.norm());
        }
        ((squares / total).sqrt(), max)
    }
}

/// First control point of the span of a parameter, and the basis functions of the three directions.
fn basis(spans: usize, parameter: [f64; 3]) -> (usize, [[f64; 4]; 3]) {
    let located = parameter.map(|t| locate(spans, t));
    let size = spans + 3;
    let start = located[0].0 + size * (located[1].0 + size * located[2].0);
    (start, located.map(|(_, x)| weights(x)))
}
