//! What is known of the frames of a run so far, and the measures over all of them.

use msplines_common::metrics::{UnitCubeError, VertexError, vertex_error};
use msplines_common::progress::Outcome;
use serde_json::json;

use super::ShownFrame;
use crate::animation::Loaded;
use crate::fit::Fitted;
use crate::input::LoadedInput;
use crate::measure::Measured;
use crate::record::{Checks, named};

/// What is known of the frames so far.
pub(super) struct Tally {
    dimension: usize,
    are_positions: bool,
    /// What errors of all frames are divided by.
    scale: f64,
    /// What the factor took that the evaluation of all frames shares, where there is one.
    pub(super) factor_seconds: Option<f64>,
    /// Construction and evaluation of every frame.
    pub(super) seconds: Vec<[f64; 2]>,
    errors: Vec<VertexError>,
    knots: Vec<usize>,
    pub(super) outcome: Outcome,
    pub(super) warnings: Vec<String>,
    /// Frames that pictures show.
    pub(super) shown: Vec<ShownFrame>,
    /// The spline of the last of them.
    pub(super) last_shown: Option<Fitted>,
    keeps_all: bool,
    /// Values of all frames, `[frame][vertex][component]`, where they are kept.
    pub(super) all: Vec<f64>,
}

impl Tally {
    /// Starts without a frame; values of all frames are kept where `keeps_all`.
    pub(super) fn start(animation: &Loaded, input: &LoadedInput, keeps_all: bool) -> Self {
        Self {
            dimension: animation.dimension,
            are_positions: animation.are_positions(),
            scale: animation.scale(&input.mesh),
            factor_seconds: None,
            seconds: Vec::new(),
            errors: Vec::new(),
            knots: Vec::new(),
            outcome: Outcome::Converged,
            warnings: Vec::new(),
            shown: Vec::new(),
            last_shown: None,
            keeps_all,
            all: Vec::new(),
        }
    }

    /// Adds a frame with its data and the values of its spline.
    pub(super) fn add(&mut self, fitted: Fitted, frame: ShownFrame, is_shown: bool) {
        let error = vertex_error(&frame.values, &frame.data, self.dimension, self.scale);
        self.errors.extend(error);
        self.knots.push(fitted.stored.knots().len());
        if matters(fitted.outcome) > matters(self.outcome) {
            self.outcome = fitted.outcome;
        }
        let number = frame.frame;
        let warnings = fitted.warnings.iter();
        self.warnings
            .extend(warnings.map(|text| format!("frame {number}: {text}")));
        if self.keeps_all {
            self.all.extend_from_slice(&frame.values);
        }
        if is_shown {
            self.shown.push(frame);
            self.last_shown = Some(fitted);
        }
    }

    /// Returns the number of frames.
    pub(super) fn frames(&self) -> usize {
        self.knots.len()
    }

    /// Returns the free coefficients of all frames.
    pub(super) fn coefficients(&self) -> u64 {
        (self.knots.iter().sum::<usize>() * self.dimension) as u64
    }

    /// Returns the errors over all vertices of all frames.
    pub(super) fn measured(&self, input: &LoadedInput) -> Measured {
        let [low, high] = input.mesh.bounding_box();
        let longest = (high - low).max();
        let error = self.error();
        let positions = error.as_ref().filter(|_| self.are_positions);
        Measured {
            unit_cube: positions.map(|error| UnitCubeError {
                rms: error.rms * error.scale / longest,
                max: error.max * error.scale / longest,
            }),
            error,
            distance: None,
        }
    }

    fn error(&self) -> Option<VertexError> {
        let count = self.errors.len() as f64;
        let mean = |of: fn(&VertexError) -> f64| self.errors.iter().map(of).sum::<f64>() / count;
        let mean_square = mean(|error| error.rms * error.rms);
        let max = self
            .errors
            .iter()
            .map(|error| error.max)
            .fold(0.0, f64::max);
        (count > 0.0).then(|| VertexError {
            kind: "vertices".to_owned(),
            // All frames have the same number of vertices.
            mean: mean(|error| error.mean),
            rms: mean_square.sqrt(),
            max,
            scale: self.scale,
            psnr_db: (mean_square > 0.0)
                .then(|| 10.0 * (self.dimension as f64 / mean_square).log10()),
        })
    }

    /// Returns flat values of the record. Knots are a mean over the frames, as the paper has it;
    /// seconds are medians, of wall time.
    pub(super) fn checks(&self) -> Checks {
        let psnr = || self.errors.iter().filter_map(|error| error.psnr_db);
        let [construct, evaluate] = [0, 1].map(|part| {
            let mut seconds: Vec<f64> = self.seconds.iter().map(|pair| pair[part]).collect();
            seconds.sort_by(f64::total_cmp);
            seconds.get(seconds.len() / 2).copied()
        });
        let knots = self.knots.iter().sum::<usize>() as f64;
        let mut checks = named([
            ("frames", json!(self.knots.len())),
            ("knots", json!(knots / self.knots.len() as f64)),
            ("construct_seconds_median", json!(construct)),
            ("evaluate_seconds_median", json!(evaluate)),
        ]);
        if let Some(seconds) = self.factor_seconds {
            checks.extend(named([("factor_seconds", json!(seconds))]));
        }
        if let (Some(low), Some(high)) = (psnr().reduce(f64::min), psnr().reduce(f64::max)) {
            checks.extend(named([
                ("psnr_min_db", json!(low)),
                ("psnr_max_db", json!(high)),
            ]));
        }
        checks
    }
}

/// Returns how much an outcome of a frame says about that of the run.
fn matters(outcome: Outcome) -> u8 {
    match outcome {
        Outcome::Converged => 0,
        Outcome::Stalled => 1,
        Outcome::MaxIterations => 2,
        Outcome::Stopped => 3,
    }
}
