//! How even the length of a holomorphic form is over a surface.

use msplines_common::operators::intrinsic::IntrinsicTriangulation;
use msplines_common::operators::triangle_area;
use nalgebra::{DMatrix, DVector};

use crate::basis::HolomorphicBasis;
use crate::descent::{Objective, minimise};

/// Faces that a form is judged by; the variance of a sample of so many is right to some percent.
pub(crate) const SAMPLES: usize = 8192;

/// Lengths below this part of the root mean square count as this part: the logarithm has poles at the
/// zeros of a form, and between two samples anything may happen there.
pub(crate) const FLOOR: f64 = 1e-2;

/// How even forms are: derivatives `q_k` of a basis on sampled faces.
#[derive(Clone, Debug)]
pub struct Uniformity {
    /// Per sample the real parts of all `q_k`, then their imaginary parts.
    rows: Vec<f64>,
    classes: usize,
    /// Part of the sampled area that belongs to each sample.
    weights: Vec<f64>,
    /// Square of the smallest length.
    floor: f64,
    /// That length over the root mean square.
    least: f64,
}

impl Uniformity {
    /// Samples the faces of the intrinsic triangulation evenly by number. O(g²) for each of 8192 at most.
    #[must_use]
    pub fn sample(basis: &HolomorphicBasis) -> Self {
        let triangulation = basis.triangulation();
        let (chosen, weights) = sampled(triangulation, SAMPLES);
        let samples = chosen.len();
        let classes = basis.classes();
        let (mut real, mut imaginary) = (
            DMatrix::zeros(samples, classes),
            DMatrix::zeros(samples, classes),
        );
        let mut sides = vec![[0.0; 3]; classes];
        for (sample, &face) in chosen.iter().enumerate() {
            basis.potentials().sides(face, &mut sides);
            for (k, along) in sides.iter().enumerate() {
                let [x, y] = gradient(triangulation.lengths[face], [along[0], along[2]]);
                real[(sample, k)] = 0.5 * x;
                imaginary[(sample, k)] = -0.5 * y;
            }
        }
        let c = basis.conjugation();
        let parts = [&real - &imaginary * c, &imaginary + &real * c];
        Self::from_parts(&parts, weights)
    }

    /// Returns the measure from the real and imaginary parts of all `q_k` on each sample.
    pub(crate) fn from_parts(parts: &[DMatrix<f64>; 2], weights: Vec<f64>) -> Self {
        let classes = parts[0].ncols();
        let samples = parts[0].nrows();
        let mut rows = Vec::with_capacity(2 * classes * samples);
        for sample in 0..samples {
            for part in parts {
                rows.extend((0..classes).map(|k| part[(sample, k)]));
            }
        }
        Self {
            rows,
            classes,
            weights,
            floor: 0.0,
            least: FLOOR,
        }
    }

    /// Returns the same measure with lengths below another part of the root mean square counted as that.
    pub(crate) fn with_least(self, least: f64) -> Self {
        Self { least, ..self }
    }

    /// Returns the same measure for coefficients `x` of which the old ones are `basis * x`.
    pub(crate) fn in_basis(&self, basis: &DMatrix<f64>) -> Self {
        let samples = self.weights.len();
        let part = |offset: usize| {
            DMatrix::from_fn(samples, self.classes, |sample, k| {
                self.rows[(2 * sample + offset) * self.classes + k]
            }) * basis
        };
        let changed = Self::from_parts(&[part(0), part(1)], self.weights.clone());
        let mut changed = changed.with_least(self.least);
        let squares: f64 = changed
            .rows
            .chunks_exact(2 * self.classes)
            .zip(&self.weights)
            .map(|(row, weight)| weight * row.iter().map(|q| q * q).sum::<f64>())
            .sum();
        changed.floor = self.least * self.least * squares / self.classes as f64;
        changed
    }

    /// Returns the same measure by so many of its samples at most.
    pub(crate) fn thinned(&self, count: usize) -> Self {
        let samples = self.weights.len();
        if samples <= count {
            return self.clone();
        }
        let chosen: Vec<usize> = (0..count).map(|i| i * samples / count).collect();
        let total: f64 = chosen.iter().map(|&s| self.weights[s]).sum();
        let row = |&s: &usize| &self.rows[2 * self.classes * s..2 * self.classes * (s + 1)];
        Self {
            rows: chosen.iter().flat_map(row).copied().collect(),
            weights: chosen.iter().map(|&s| self.weights[s] / total).collect(),
            ..*self
        }
    }

    /// Returns the derivatives of each form of the basis on the samples.
    pub(crate) fn columns(&self) -> Vec<Vec<[f64; 2]>> {
        let column = |k: usize| {
            let rows = self.rows.chunks_exact(2 * self.classes);
            rows.map(|row| [row[k], row[self.classes + k]]).collect()
        };
        (0..self.classes).map(column).collect()
    }

    /// Returns the part of the sampled area that belongs to each sample.
    pub(crate) fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Returns the area-weighted variance of `log |ω|` of the form whose real part has these coefficients
    /// in the harmonic basis. O(g) for each sample.
    ///
    /// # Panics
    /// If there are fewer coefficients than classes.
    #[must_use]
    pub fn variance(&self, coefficients: &DVector<f64>) -> f64 {
        let lengths = self.derivatives(coefficients);
        let squares = lengths.iter().zip(&self.weights);
        let square: f64 = squares.map(|([a, b], w)| w * (a * a + b * b)).sum();
        let floor = self.least * self.least * square;
        let logs = lengths
            .iter()
            .map(|[a, b]| 0.5 * (a * a + b * b + floor).ln());
        let logs: Vec<f64> = logs.collect();
        let mean = mean(&logs, &self.weights);
        let squares = logs.iter().zip(&self.weights);
        squares
            .map(|(log, w)| w * (log - mean) * (log - mean))
            .sum()
    }

    /// Returns coefficients of unit length of locally least variance, and that variance.
    pub(crate) fn minimise(&self, start: &DVector<f64>) -> (f64, DVector<f64>) {
        let unit = |x: &DVector<f64>| x / x.norm();
        let (_, x) = minimise(self, unit(start));
        let x = unit(&x);
        (self.variance(&x), x)
    }

    fn derivatives(&self, x: &DVector<f64>) -> Vec<[f64; 2]> {
        let product = |q: &[f64]| q.iter().zip(x).map(|(q, x)| q * x).sum::<f64>();
        let rows = self.rows.chunks_exact(2 * self.classes);
        rows.map(|row| {
            let (real, imaginary) = row.split_at(self.classes);
            [product(real), product(imaginary)]
        })
        .collect()
    }
}

impl Objective for Uniformity {
    /// The variance at `x / |x|`, and its derivatives by `x`.
    fn evaluate(&self, x: &DVector<f64>) -> (f64, DVector<f64>) {
        let norm = x.norm();
        let x = x / norm;
        let lengths = self.derivatives(&x);
        let squares: Vec<f64> = lengths
            .iter()
            .map(|[a, b]| a * a + b * b + self.floor)
            .collect();
        let logs: Vec<f64> = squares.iter().map(|s| 0.5 * s.ln()).collect();
        let mean = mean(&logs, &self.weights);
        let mut value = 0.0;
        let mut gradient = DVector::zeros(self.classes);
        let rows = self.rows.chunks_exact(2 * self.classes);
        for (((row, [a, b]), (log, square)), weight) in rows
            .zip(&lengths)
            .zip(logs.iter().zip(&squares))
            .zip(&self.weights)
        {
            value += weight * (log - mean) * (log - mean);
            let factor = 2.0 * weight * (log - mean) / square;
            let (real, imaginary) = row.split_at(self.classes);
            for (sum, (p, q)) in gradient.iter_mut().zip(real.iter().zip(imaginary)) {
                *sum += factor * (a * p + b * q);
            }
        }
        let radial = gradient.dot(&x);
        (value, (gradient - x * radial) / norm)
    }
}

/// Returns so many faces spread evenly by number, and the share of their area that each of them has.
pub(crate) fn sampled(
    triangulation: &IntrinsicTriangulation,
    most: usize,
) -> (Vec<usize>, Vec<f64>) {
    let faces = triangulation.faces.len();
    let samples = faces.min(most);
    let chosen: Vec<usize> = (0..samples).map(|i| i * faces / samples).collect();
    let areas = chosen
        .iter()
        .map(|&f| triangle_area(triangulation.lengths[f]));
    let areas: Vec<f64> = areas.collect();
    let total: f64 = areas.iter().sum();
    (chosen, areas.iter().map(|area| area / total).collect())
}

/// The gradient of a form on a face in the plane, corner 0 at the origin and side 0 along the first
/// axis; `along` are its values on sides 0 and 2.
pub(crate) fn gradient(lengths: [f64; 3], along: [f64; 2]) -> [f64; 2] {
    let [l, opposite, side] = lengths;
    let height = 2.0 * triangle_area(lengths) / l;
    let foot = (side * side + (l - opposite) * (l + opposite)) / (2.0 * l);
    let x = along[0] / l;
    [x, (-along[1] - foot * x) / height]
}

fn mean(values: &[f64], weights: &[f64]) -> f64 {
    values.iter().zip(weights).map(|(v, w)| v * w).sum()
}
