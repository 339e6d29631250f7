//! Möbius maps of the unit sphere: centring, and stereographic coordinates.

use nalgebra::{Matrix3, Vector3};

use crate::untangle::tangent_frame;

/// Newton steps of the centring; it converges quadratically in less than ten.
const MAX_STEPS: usize = 60;

/// Length of the mean vector that counts as zero.
const CENTRED: f64 = 1e-13;

/// Longest step: an inversion about a point farther out squeezes the whole sphere together.
const LONGEST: f64 = 0.5;

/// Moves unit vectors by the Möbius map that makes their weighted mean zero.
///
/// # Reference
/// [Baden2018]. Deviation: steps are cut to a length at which the mean shrinks.
pub(super) fn centre(points: &mut Vec<Vector3<f64>>, weights: &[f64]) {
    let total: f64 = weights.iter().sum();
    let mut mean = weighted_mean(points, weights, total);
    for _ in 0..MAX_STEPS {
        if mean.norm() <= CENTRED {
            break;
        }
        let mut step = newton_step(points, weights, total, mean);
        let mut improved = false;
        for _ in 0..20 {
            let moved: Vec<_> = points.iter().map(|&p| inversion(p, step)).collect();
            let next = weighted_mean(&moved, weights, total);
            if next.norm() < mean.norm() {
                (*points, mean, improved) = (moved, next, true);
                break;
            }
            step *= 0.5;
        }
        if !improved {
            break;
        }
    }
}

fn newton_step(
    points: &[Vector3<f64>],
    weights: &[f64],
    total: f64,
    mean: Vector3<f64>,
) -> Vector3<f64> {
    let outer: Matrix3<f64> = points
        .iter()
        .zip(weights)
        .map(|(p, &w)| (Matrix3::identity() - p * p.transpose()) * (2.0 * w / total))
        .sum();
    let step = -outer.try_inverse().map_or(mean, |inverse| inverse * mean);
    let length = step.norm();
    if length > LONGEST {
        step * (LONGEST / length)
    } else {
        step
    }
}

fn weighted_mean(points: &[Vector3<f64>], weights: &[f64], total: f64) -> Vector3<f64> {
    let both = points.iter().zip(weights);
    both.map(|(p, &w)| p * w).sum::<Vector3<f64>>() / total
}

/// Returns the image of a point of the unit sphere under the Möbius map of the ball that takes the
/// origin to about `2 c`.
fn inversion(p: Vector3<f64>, c: Vector3<f64>) -> Vector3<f64> {
    let q = p + c;
    (q * ((1.0 - c.norm_squared()) / q.norm_squared()) + c).normalize()
}

/// Returns stereographic coordinates from a unit vector `pole`.
pub(super) fn stereographic(points: &[Vector3<f64>], pole: Vector3<f64>) -> Vec<[f64; 2]> {
    // The frame seen from outside, opposite to the pole.
    let [first, second] = tangent_frame(-pole);
    let project = |p: &Vector3<f64>| {
        // 1 - p·pole without cancellation.
        let height = 0.5 * (p - pole).norm_squared();
        if height == 0.0 {
            [f64::INFINITY; 2]
        } else {
            [p.dot(&first) / height, p.dot(&second) / height]
        }
    };
    points.iter().map(project).collect()
}
