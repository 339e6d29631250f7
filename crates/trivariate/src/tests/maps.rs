//! Maps of the unit cube, and samples of them.

use msplines_common::Point3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::VolumeSamples;

/// The unit ball: a smooth boundary, so that the determinant is 0 on the twelve edges.
pub(super) fn ball(at: [f64; 3]) -> Point3<f64> {
    let [x, y, z] = at.map(|t| 2.0 * t - 1.0);
    let stretch = |a: f64, b: f64, c: f64| {
        a * (1.0 - (b * b + c * c) / 2.0 + b * b * c * c / 3.0)
            .max(0.0)
            .sqrt()
    };
    Point3::new(stretch(x, y, z), stretch(y, z, x), stretch(z, x, y))
}

/// A bar of length 4, bent by half a turn and twisted by a quarter.
pub(super) fn bent_bar(at: [f64; 3]) -> Point3<f64> {
    let (sin, cos) = (at[2] * 0.5 * std::f64::consts::PI).sin_cos();
    let (x, y) = (at[0] - 0.5, at[1] - 0.5);
    let (x, y) = (cos * x - sin * y, sin * x + cos * y);
    let (sin, cos) = (at[2] * std::f64::consts::PI).sin_cos();
    let radius = 1.5 + x;
    Point3::new(radius * cos, y, radius * sin)
}

/// A smooth map of the cube onto itself, with its inverse.
pub(super) fn shear(at: [f64; 3]) -> Point3<f64> {
    let x = at[0] + 0.1 * (std::f64::consts::TAU * at[1]).sin();
    let y = at[1] + 0.2 * x * x;
    Point3::new(x, y, at[2] + 0.3 * x * y)
}

/// Folds along a plane in the middle.
pub(super) fn folded(at: [f64; 3]) -> Point3<f64> {
    let x = at[0];
    Point3::new(x * (1.0 - x), at[1] + 0.3 * x, at[2])
}

/// Random parameters, a share of them on the boundary.
pub(super) fn parameters(count: usize, surface: f64, seed: u64) -> Vec<[f64; 3]> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    (0..count)
        .map(|_| {
            let mut at: [f64; 3] = std::array::from_fn(|_| random.random());
            if random.random::<f64>() < surface {
                at[random.random_range(0..3)] = f64::from(random.random_range(0..2_u8));
            }
            at
        })
        .collect()
}

/// Samples of a map.
pub(super) fn samples(map: fn([f64; 3]) -> Point3<f64>, count: usize, seed: u64) -> VolumeSamples {
    let parameters = parameters(count, 0.3, seed);
    let points = parameters.iter().map(|&at| map(at)).collect();
    VolumeSamples::build(parameters, points).expect("samples of a map")
}
