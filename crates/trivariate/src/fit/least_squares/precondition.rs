//! An approximate inverse: the tensor product of masses, scaled to the diagonal of the matrix.
//!
//! The products of basis functions over samples are near to `M ⊗ M ⊗ M`, with a mass matrix `M` of each
//! direction in which all samples count by that parameter alone: exactly so where density is a product
//! of densities, and well for an inside with more samples on its faces. Bands solve it at once; the
//! diagonal says how far the samples are from it.

use msplines_common::bspline::{Axis, locate, weights};
use rayon::prelude::*;

use super::stencil::{REACH, products, values};
use crate::samples::VolumeSamples;

/// Entries of a row of the factor, before the diagonal.
const BAND: usize = 3;

/// Numbers that one task solves for, at least.
const BATCH: usize = 8192;

/// Share of evenly spread samples that is added to the masses, so that none is singular.
const EVEN: f64 = 1e-3;

/// `S (M ⊗ M ⊗ M)⁻¹ S` with a diagonal `S`.
#[derive(Clone, Debug)]
pub(crate) struct TensorMass {
    size: usize,
    /// For each direction rows of the lower factor, `factor[i][d]` in column `i - d`.
    factors: [Vec<[f64; BAND + 1]>; 3],
    scale: Vec<f64>,
}

impl TensorMass {
    /// The approximate inverse of the normal equations of samples with this positive diagonal.
    pub(crate) fn build(samples: &VolumeSamples, spans: usize, diagonal: &[f64]) -> Self {
        let size = spans + 3;
        let masses = [0, 1, 2].map(|axis| mass(samples, spans, axis));
        let scale = diagonal.iter().enumerate().map(|(at, entry)| {
            let [i, j, k] = [at % size, at / size % size, at / (size * size)];
            (masses[0][i][0] * masses[1][j][0] * masses[2][k][0] / entry).sqrt()
        });
        Self {
            size,
            scale: scale.collect(),
            factors: masses.each_ref().map(|mass| cholesky(mass)),
        }
    }

    /// Applies it to several columns, one lattice after another.
    pub(crate) fn apply(&self, x: &[f64]) -> Vec<f64> {
        let scaled = |values: &mut Vec<f64>| {
            for (value, scale) in values.iter_mut().zip(self.scale.iter().cycle()) {
                *value *= scale;
            }
        };
        let mut values = x.to_vec();
        scaled(&mut values);
        for (axis, factor) in self.factors.iter().enumerate() {
            let axis = Axis::of(&[self.size; 3], axis, 1);
            values
                .par_chunks_mut(axis.count * axis.inner)
                .with_min_len(BATCH / (axis.count * axis.inner))
                .for_each(|block| solve(factor, axis.inner, block));
        }
        scaled(&mut values);
        values
    }
}

/// Solves along an axis, for `inner` lines side by side.
fn solve(factor: &[[f64; BAND + 1]], inner: usize, block: &mut [f64]) {
    for (i, row) in factor.iter().enumerate() {
        let (before, now) = block.split_at_mut(i * inner);
        let now = &mut now[..inner];
        for d in 1..=BAND.min(i) {
            subtract(row[d], &before[(i - d) * inner..(i - d + 1) * inner], now);
        }
        scale(1.0 / row[0], now);
    }
    for i in (0..factor.len()).rev() {
        let (now, after) = block.split_at_mut((i + 1) * inner);
        let now = &mut now[i * inner..];
        for d in 1..=BAND.min(factor.len() - 1 - i) {
            subtract(factor[i + d][d], &after[(d - 1) * inner..d * inner], now);
        }
        scale(1.0 / factor[i][0], now);
    }
}

fn scale(factor: f64, now: &mut [f64]) {
    for value in now {
        *value *= factor;
    }
}

fn subtract(factor: f64, from: &[f64], now: &mut [f64]) {
    for (value, other) in now.iter_mut().zip(from) {
        *value -= factor * other;
    }
}

/// The mass matrix of one direction, `mass[i][d]` in column `i - d`: the mean of products over all samples
/// and a share of their integrals.
fn mass(samples: &VolumeSamples, spans: usize, axis: usize) -> Vec<[f64; BAND + 1]> {
    let even = products(spans + 3, values);
    let share = EVEN / spans as f64;
    let lower = |row: &[f64; 2 * REACH + 1]| std::array::from_fn(|d| share * row[REACH - d]);
    let mut rows: Vec<[f64; BAND + 1]> = even.iter().map(lower).collect();
    let total = samples.total_weight();
    for (at, weight) in samples.parameters().iter().zip(samples.weights()) {
        let (span, x) = locate(spans, at[axis]);
        let basis = weights(x);
        for (p, q) in (0..4).flat_map(|p| (0..=p).map(move |q| (p, q))) {
            rows[span + p][p - q] += weight / total * basis[p] * basis[q];
        }
    }
    rows
}

/// The lower factor of a matrix in bands.
fn cholesky(matrix: &[[f64; BAND + 1]]) -> Vec<[f64; BAND + 1]> {
    let mut factor = vec![[0.0; BAND + 1]; matrix.len()];
    for i in 0..matrix.len() {
        for d in (0..=BAND.min(i)).rev() {
            let column = i - d;
            let shared = (1..=BAND - d).filter(|&e| e <= column);
            let sum: f64 = shared.map(|e| factor[i][d + e] * factor[column][e]).sum();
            let rest = matrix[i][d] - sum;
            factor[i][d] = if d == 0 {
                rest.sqrt()
            } else {
                rest / factor[column][0]
            };
        }
    }
    factor
}
