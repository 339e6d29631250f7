//! Estimates of the denominators of insertions, with random signs.

use msplines_common::linalg::Mat;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::knot_values::KnotValues;
use crate::target::Centred;

/// Random sign vectors per estimate: as many as one pass over a factor serves. The standard error of
/// such a mean of squares is at most `√(2 / 16)`, a third.
const PROBES: usize = 16;

/// Returns estimates of `|C B_ZZ⁻¹ e_j|²` at all vertices, zero at knots.
pub(crate) fn insertion_denominators(
    system: &KnotValues<'_>,
    target: &Centred,
    seed: u64,
) -> Vec<f64> {
    let mut signs = random_signs(target.data.nrows(), seed);
    target.weigh(&mut signs);
    mean_squares(&system.solve_free(signs))
}

fn random_signs(rows: usize, seed: u64) -> Mat<f64> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let bits: Vec<u32> = (0..rows).map(|_| random.random()).collect();
    Mat::from_fn(rows, PROBES, |row, probe| {
        if bits[row] >> probe & 1 == 1 {
            1.0
        } else {
            -1.0
        }
    })
}

fn mean_squares(probes: &Mat<f64>) -> Vec<f64> {
    let squares = |row| {
        (0..PROBES)
            .map(|probe| probes[(row, probe)].powi(2))
            .sum::<f64>()
    };
    (0..probes.nrows())
        .map(|row| squares(row) / PROBES as f64)
        .collect()
}
