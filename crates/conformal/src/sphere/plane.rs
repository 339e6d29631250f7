//! The map into the plane with one triangle at infinity, and its correction in two charts.
//!
//! # Notation
//! `z` is the coordinate of the plane and `y = 1 / z`, both with one row per vertex.

use msplines_common::linalg::{FactorError, Mat, Ordering, SymmetricMatrix};
use msplines_common::operators::intrinsic::IntrinsicTriangulation;
use msplines_common::progress::Stages;
use nalgebra::Vector3;

use super::error::SphereError;
use crate::extension::Extension;
use crate::measure::area;

/// Corrections of both charts. The third changes values by less than a thousandth; from then on
/// the map only drifts by Möbius maps.
pub(super) const SWEEPS: usize = 3;

/// Each chart is free up to this modulus of its own coordinate, so that they overlap.
const OVERLAP: f64 = 1.6;

/// Steps towards the median of the plane, which only has to lie among the vertices.
const MEDIAN_STEPS: usize = 30;

/// Moduli below this count as this where a vertex is inverted only to be held: on meshes of a few
/// triangles a held vertex may lie at zero.
const LEAST_MODULUS: f64 = 1e-2;

/// What the map into the plane is made from.
pub(super) struct Chart<'a> {
    pub(super) laplacian: &'a SymmetricMatrix,
    pub(super) ordering: &'a Ordering,
    pub(super) triangulation: &'a IntrinsicTriangulation,
    pub(super) areas: &'a [f64],
}

impl Chart<'_> {
    /// Returns the image of each vertex on the unit sphere, after both charts were corrected.
    pub(super) fn corrected(
        &self,
        z: &Mat<f64>,
        stages: &mut Stages<'_, '_>,
    ) -> Result<Vec<Vector3<f64>>, SphereError> {
        stages.enter()?;
        let mut z = z.clone();
        self.centre(&mut z);
        let modulus: Vec<f64> = (0..z.nrows()).map(|v| z[(v, 0)].hypot(z[(v, 1)])).collect();
        let outer: Vec<bool> = modulus.iter().map(|&r| r > 1.0 / OVERLAP).collect();
        let inner: Vec<bool> = modulus.iter().map(|&r| r < OVERLAP).collect();
        let outside = Extension::factor(self.laplacian, self.ordering, outer.clone())?;
        let inside = Extension::factor(self.laplacian, self.ordering, inner.clone())?;
        let mut y = Mat::zeros(z.nrows(), 2);
        for _ in 0..SWEEPS {
            stages.enter()?;
            invert_where(&z, &inner, &mut y);
            outside.extend(&mut y);
            invert_where(&y, &outer, &mut z);
            inside.extend(&mut z);
        }
        let place = |v: usize| {
            if inner[v] {
                lift(z[(v, 0)], z[(v, 1)])
            } else {
                let [x, y, height]: [f64; 3] = lift(y[(v, 0)], y[(v, 1)]).into();
                Vector3::new(x, -y, -height)
            }
        };
        Ok((0..z.nrows()).map(place).collect())
    }

    /// Returns the image of each vertex on the unit sphere, the middle of the triangle at the pole.
    pub(super) fn uncorrected(&self, z: &Mat<f64>) -> Vec<Vector3<f64>> {
        let moduli = (0..z.nrows()).map(|v| z[(v, 0)].hypot(z[(v, 1)]));
        // The triangle at infinity stays inside a hemisphere.
        let radius = weighted_median(moduli, self.areas).clamp(f64::MIN_POSITIVE, 0.5);
        let place = |v: usize| lift(z[(v, 0)] / radius, z[(v, 1)] / radius);
        (0..z.nrows()).map(place).collect()
    }

    /// Returns the harmonic map whose best-shaped triangle is held, with everything else inside.
    ///
    /// # Reference
    /// [Tutte1963]; [Floater1997].
    pub(super) fn outside_a_triangle(&self) -> Result<Mat<f64>, FactorError> {
        let faces = &self.triangulation.faces;
        let mut best = (f64::NEG_INFINITY, 0);
        for (face, &sides) in self.triangulation.lengths.iter().enumerate() {
            let [a, b, c] = faces[face];
            let quality = area(sides) / sides.iter().map(|l| l * l).sum::<f64>();
            if a != b && b != c && c != a && quality > best.0 {
                best = (quality, face);
            }
        }
        let mut z = Mat::zeros(self.laplacian.size(), 2);
        let mut free = vec![true; self.laplacian.size()];
        for (i, &corner) in faces[best.1].iter().enumerate() {
            // Seen from inside the triangle turns right.
            let (sine, cosine) = (-std::f64::consts::TAU * i as f64 / 3.0).sin_cos();
            (z[(corner as usize, 0)], z[(corner as usize, 1)]) = (cosine, sine);
            free[corner as usize] = false;
        }
        Extension::factor(self.laplacian, self.ordering, free)?.extend(&mut z);
        Ok(z)
    }

    /// Moves the geometric median by area to zero, and half of the area into the unit circle.
    ///
    /// # Reference
    /// [Weiszfeld1937].
    fn centre(&self, z: &mut Mat<f64>) {
        let total: f64 = self.areas.iter().sum();
        let mut middle = [0, 1].map(|side| {
            let terms = (0..z.nrows()).map(|v| z[(v, side)] * self.areas[v]);
            terms.sum::<f64>() / total
        });
        for _ in 0..MEDIAN_STEPS {
            let mut sums = [0.0; 3];
            for (v, area) in self.areas.iter().enumerate() {
                let distance = (z[(v, 0)] - middle[0]).hypot(z[(v, 1)] - middle[1]);
                let weight = area / distance.max(f64::EPSILON);
                let terms = [weight * z[(v, 0)], weight * z[(v, 1)], weight];
                (0..3).for_each(|i| sums[i] += terms[i]);
            }
            middle = [sums[0] / sums[2], sums[1] / sums[2]];
        }
        for side in 0..2 {
            (0..z.nrows()).for_each(|v| z[(v, side)] -= middle[side]);
        }
        let moduli = (0..z.nrows()).map(|v| z[(v, 0)].hypot(z[(v, 1)]));
        let radius = weighted_median(moduli, self.areas).max(f64::EPSILON);
        (0..2).for_each(|side| (0..z.nrows()).for_each(|v| z[(v, side)] /= radius));
    }
}

/// Writes the inverses of `from` to the rows of `to` that are valid in `from`'s chart.
fn invert_where(from: &Mat<f64>, valid: &[bool], to: &mut Mat<f64>) {
    for v in (0..from.nrows()).filter(|&v| valid[v]) {
        let (re, im) = (from[(v, 0)], from[(v, 1)]);
        let square = (re * re + im * im).max(LEAST_MODULUS * LEAST_MODULUS);
        (to[(v, 0)], to[(v, 1)]) = (re / square, -im / square);
    }
}

fn weighted_median(values: impl Iterator<Item = f64>, weights: &[f64]) -> f64 {
    let mut sorted: Vec<(f64, f64)> = values.zip(weights.iter().copied()).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * sorted.iter().map(|entry| entry.1).sum::<f64>();
    let mut sum = 0.0;
    for &(value, weight) in &sorted {
        sum += weight;
        if sum >= half {
            return value;
        }
    }
    0.0
}

/// Returns the point of the unit sphere with a stereographic coordinate, zero at the north pole.
fn lift(re: f64, im: f64) -> Vector3<f64> {
    let square = re * re + im * im;
    let scale = 1.0 / (1.0 + square);
    Vector3::new(2.0 * re * scale, 2.0 * im * scale, (1.0 - square) * scale)
}
