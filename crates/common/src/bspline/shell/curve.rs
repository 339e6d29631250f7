//! Bézier curves in space.

use nalgebra::{Point3, Vector4};

/// A polynomial or rational Bézier curve, whose degree is the number of its points less one.
#[derive(Clone, Debug, PartialEq)]
pub struct BezierCurve {
    /// Control points.
    pub points: Vec<Point3<f64>>,
    /// Rational weights, one for each point; absent where all are 1. Points are not multiplied by them.
    pub weights: Option<Vec<f64>>,
}

impl BezierCurve {
    /// Returns the curve over the parameters from `from` to `to`, by de Casteljau's algorithm.
    ///
    /// The error of rounding is a few units in the last place of the largest control point for each
    /// degree.
    ///
    /// # Panics
    /// Unless `0 <= from < to <= 1`, or if the weights are not one for each point.
    #[must_use]
    pub fn piece(&self, [from, to]: [f64; 2]) -> Self {
        assert!(0.0 <= from && from < to && to <= 1.0, "a piece of [0, 1]");
        let mut row = self.homogeneous();
        if to < 1.0 {
            keep_start(&mut row, [1.0 - to, to]);
        }
        if from > 0.0 {
            row.reverse();
            // Of [0, to], seen from its end, by the very products that give a piece before it its end.
            let cut = from / to;
            keep_start(&mut row, [cut, 1.0 - cut]);
            row.reverse();
        }
        let points = row.iter().map(|p| Point3::from(p.xyz() / p.w)).collect();
        let is_rational = self.weights.is_some();
        let weights = is_rational.then(|| row.iter().map(|p| p.w).collect());
        Self { points, weights }
    }

    /// Returns the point at a parameter.
    ///
    /// # Panics
    /// If there are no points, or the weights are not one for each point.
    #[must_use]
    pub fn position(&self, at: f64) -> Point3<f64> {
        let mut row = self.homogeneous();
        keep_start(&mut row, [1.0 - at, at]);
        let end = row.last().expect("a curve has points");
        Point3::from(end.xyz() / end.w)
    }

    /// Points times their weights, and the weights.
    fn homogeneous(&self) -> Vec<Vector4<f64>> {
        if let Some(weights) = &self.weights {
            assert_eq!(weights.len(), self.points.len(), "a weight for each point");
        }
        let weight = |at: usize| self.weights.as_ref().map_or(1.0, |weights| weights[at]);
        let points = self.points.iter().enumerate();
        points
            .map(|(at, p)| p.coords.push(1.0) * weight(at))
            .collect()
    }
}

/// Replaces coefficients by those of the part from the start to the parameter at which two
/// coefficients next to each other have these weights.
fn keep_start(row: &mut [Vector4<f64>], [before, after]: [f64; 2]) {
    for step in 1..row.len() {
        for i in (step..row.len()).rev() {
            row[i] = row[i - 1] * before + row[i] * after;
        }
    }
}
