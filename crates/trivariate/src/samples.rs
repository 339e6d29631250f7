//! What a fit is given: points of a solid with their parameters.

use msplines_common::Point3;
use msplines_common::bspline::locate;

use crate::error::FitError;

/// Points of a solid, their parameters in the unit cube and their weights.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeSamples {
    parameters: Vec<[f64; 3]>,
    points: Vec<Point3<f64>>,
    weights: Vec<f64>,
}

impl VolumeSamples {
    /// Returns samples of weight 1.
    ///
    /// # Errors
    /// As [`weighted`](Self::weighted).
    pub fn build(parameters: Vec<[f64; 3]>, points: Vec<Point3<f64>>) -> Result<Self, FitError> {
        let weights = vec![1.0; parameters.len()];
        Self::weighted(parameters, points, weights)
    }

    /// Returns samples with their weights.
    ///
    /// # Errors
    /// Arrays of different lengths; a parameter outside of the unit cube; a point that is not finite; a
    /// negative weight; no positive weight.
    pub fn weighted(
        parameters: Vec<[f64; 3]>,
        points: Vec<Point3<f64>>,
        weights: Vec<f64>,
    ) -> Result<Self, FitError> {
        if parameters.len() != points.len() || points.len() != weights.len() {
            return Err(FitError::Lengths {
                parameters: parameters.len(),
                points: points.len(),
                weights: weights.len(),
            });
        }
        let outside = |p: &[f64; 3]| !p.iter().all(|t| (0.0..=1.0).contains(t));
        if let Some(sample) = parameters.iter().position(outside) {
            return Err(FitError::Parameter { sample });
        }
        let infinite = |p: &Point3<f64>| !p.iter().all(|x| x.is_finite());
        if let Some(sample) = points.iter().position(infinite) {
            return Err(FitError::Point { sample });
        }
        let bad = |w: &f64| !(0.0..f64::INFINITY).contains(w);
        if let Some(sample) = weights.iter().position(bad) {
            let weight = weights[sample];
            return Err(FitError::Weight { sample, weight });
        }
        if !weights.iter().any(|&w| w > 0.0) {
            return Err(FitError::NoSamples);
        }
        Ok(Self {
            parameters,
            points,
            weights,
        })
    }

    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there are none; never, once built.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Parameters in the unit cube.
    #[must_use]
    pub fn parameters(&self) -> &[[f64; 3]] {
        &self.parameters
    }

    /// Points of the solid.
    #[must_use]
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// Weights.
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Sum of the weights.
    pub(crate) fn total_weight(&self) -> f64 {
        self.weights.iter().sum()
    }

    /// The samples in the order of the spans they lie in, the first index fastest, and where each span
    /// begins.
    pub(crate) fn by_span(&self, spans: usize) -> (Vec<u32>, Vec<usize>) {
        let span = |p: &[f64; 3]| {
            let [i, j, k] = p.map(|t| locate(spans, t).0);
            i + spans * (j + spans * k)
        };
        let keys: Vec<u32> = self.parameters.iter().map(|p| span(p) as u32).collect();
        let mut starts = vec![0; spans.pow(3) + 1];
        for &key in &keys {
            starts[key as usize + 1] += 1;
        }
        for at in 1..starts.len() {
            starts[at] += starts[at - 1];
        }
        let mut next = starts.clone();
        let mut order = vec![0; keys.len()];
        for (sample, &key) in keys.iter().enumerate() {
            order[next[key as usize]] = sample as u32;
            next[key as usize] += 1;
        }
        (order, starts)
    }
}
