//! Estimates of the denominators of both scores, with random signs.

use msplines_common::linalg::Mat;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::knot_values::KnotValues;
use crate::target::Centred;

/// Random sign vectors per estimate: a rank correlation of 0.96 with the exact scores.
const PROBES: usize = 12;

/// Estimates that need one solve per probe.
pub(crate) struct Probes {
    /// `diag(Hᵀ C² H)` at the knots.
    pub(crate) scale: Vec<f64>,
    /// `|C B_ZZ⁻¹ e_j|²` at all vertices, zero at knots.
    pub(crate) insertion: Vec<f64>,
}

impl Probes {
    pub(crate) fn estimate(system: &KnotValues<'_>, target: &Centred, seed: u64) -> Self {
        let mut signs = random_signs(target.data.nrows(), seed);
        target.weigh(&mut signs);
        let solved = system.solve_free(signs.clone());
        let restricted = system.restrict_solved(&signs, &solved);
        Self {
            scale: mean_squares(&restricted),
            insertion: mean_squares(&solved),
        }
    }
}

/// Returns an estimate of `diag(Hᵀ C² H)`, which preconditions the normal equations.
pub(crate) fn probe_scale(system: &KnotValues<'_>, target: &Centred, seed: u64) -> Vec<f64> {
    Probes::estimate(system, target, seed).scale
}

/// Returns an estimate of `D = diag(S_T (Hᵀ C² H)⁻¹ S_T)`, with `Hᵀ C² H` replaced by its diagonal.
///
/// That makes all values too large by nearly the same factor, which no comparison sees.
pub(crate) fn removal_denominators(system: &KnotValues<'_>, scale: &[f64], seed: u64) -> Vec<f64> {
    let mut signs = random_signs(scale.len(), seed ^ 0x5eed);
    for side in 0..PROBES {
        scale
            .iter()
            .enumerate()
            .for_each(|(k, c)| signs[(k, side)] /= c.sqrt());
    }
    mean_squares(&system.coefficients(&system.extend(signs.as_ref())))
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
