//! The largest eigenvalue of a symmetric operator.
//!
//! # Notation
//! `A Q = Q T + β q eᵀ` with orthonormal columns of `Q`, kept so by orthogonalising twice. An eigenvalue of
//! `T` with eigenvector `s` is at most `β |s_last|` from one of `A`.

use msplines_common::linalg::{Mat, MatRef, column};
use nalgebra::DMatrix;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Steps between two looks at the eigenvalues, and most of all.
const LOOK: usize = 8;
const MOST: usize = 240;

/// An eigenvalue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extreme {
    pub(super) value: f64,
    /// How far it may be from a true one.
    pub(super) bound: f64,
}

/// Returns the largest eigenvalue of a positive operator of a size, to a relative accuracy if so many steps
/// give it; the bound says whether they did. The cost is an application and `O(size k)` in step `k`.
pub(super) fn largest(
    size: usize,
    apply: impl Fn(MatRef<'_, f64>) -> Mat<f64>,
    accuracy: f64,
    seed: u64,
) -> Extreme {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut next: Vec<f64> = (0..size).map(|_| random.random::<f64>() - 0.5).collect();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let (mut diagonal, mut beside) = (Vec::new(), Vec::new());
    let mut found = Extreme {
        value: 0.0,
        bound: f64::INFINITY,
    };
    let mut length = norm(&next);
    while length > 0.0 && basis.len() < size.min(MOST) {
        next.iter_mut().for_each(|x| *x /= length);
        let image = apply(Mat::from_fn(size, 1, |i, _| next[i]).as_ref());
        basis.push(next);
        next = column(image.as_ref(), 0).to_vec();
        let before = norm(&next);
        for round in 0..2 {
            for (k, q) in basis.iter().enumerate() {
                let along = dot(q, &next);
                next.iter_mut().zip(q).for_each(|(x, q)| *x -= along * q);
                if round == 0 && k + 1 == basis.len() {
                    diagonal.push(along);
                }
            }
        }
        length = norm(&next);
        // What is left of a whole invariant space is rounding.
        if length <= f64::EPSILON * before {
            length = 0.0;
        }
        let whole = length == 0.0 || basis.len() == size;
        if whole || basis.len().is_multiple_of(LOOK) {
            found = top(&diagonal, &beside, length);
            if whole || found.bound <= accuracy * found.value {
                break;
            }
        }
        beside.push(length);
    }
    found
}

/// Returns the largest eigenvalue of a tridiagonal matrix, and how much its vector weighs at the end.
fn top(diagonal: &[f64], beside: &[f64], length: f64) -> Extreme {
    let n = diagonal.len();
    let entry = |i: usize, j: usize| match i.abs_diff(j) {
        0 => diagonal[i],
        1 => beside[i.min(j)],
        _ => 0.0,
    };
    let eigen = DMatrix::from_fn(n, n, entry).symmetric_eigen();
    let (place, value) = eigen.eigenvalues.argmax();
    let bound = length * eigen.eigenvectors[(n - 1, place)].abs();
    Extreme { value, bound }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_eigenvalue_of_a_path_is_found() {
        // 2 on the diagonal, -1 beside it: 4 sin²(π n / (2n + 2)).
        let n = 60;
        let path = |x: MatRef<'_, f64>| {
            Mat::from_fn(n, 1, |i, _| {
                let beside = |j: usize| if j < n { x[(j, 0)] } else { 0.0 };
                2.0 * x[(i, 0)] - beside(i.wrapping_sub(1)) - beside(i + 1)
            })
        };
        let found = largest(n, path, 1e-12, 5);
        let half = std::f64::consts::FRAC_PI_2 * n as f64 / (n + 1) as f64;
        let due = 4.0 * half.sin().powi(2);
        assert!((found.value - due).abs() < 1e-11, "{found:?} {due}");
        assert!(found.bound < 1e-10, "{found:?}");
    }

    #[test]
    fn few_steps_say_that_they_were_few() {
        let far = |x: MatRef<'_, f64>| Mat::from_fn(4000, 1, |i, _| (i + 1) as f64 * x[(i, 0)]);
        let found = largest(4000, far, 1e-9, 1);
        assert!(
            found.value <= 4000.0 + 1e-6 && found.value + found.bound >= 3999.0,
            "{found:?}"
        );
    }
}
