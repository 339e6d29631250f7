//! Which leaves are split next, and how.

use msplines_common::evaluate::Order;
use rayon::prelude::*;

use super::samples::Sorted;
use crate::complex::{Point, UNITS};
use crate::options::Refinement;
use crate::spline::TSpline;
use crate::tmesh::Axis;

/// Samples on a leaf below which it is not split: its parts would hold the surface at none. Finer than
/// the samples, a surface meets them and goes anywhere between.
const FEWEST: usize = 4;

/// Returns the leaves by the sum of their errors, the worst first, without those that have none or few
/// samples.
pub(super) fn ranked(spline: &TSpline, sorted: &Sorted, errors: &[f64], exponent: f64) -> Vec<u32> {
    let caps = spline.space().caps();
    let leaves = spline.space().mesh().leaves().len();
    let scores: Vec<f64> = (0..leaves)
        .into_par_iter()
        .map(|leaf| {
            let terms = sorted.on(leaf).map(|i| {
                let sample = &sorted.samples[i];
                // What a cap decides, no split of a leaf can better.
                let rest = caps.at(sample.at).map_or(1.0, |cap| 1.0 - cap.phi.0[0]);
                sample.weight * (rest * errors[i]).powf(exponent)
            });
            terms.sum()
        })
        .collect();
    let mut order: Vec<u32> = (0..leaves as u32)
        .filter(|&l| scores[l as usize] > 0.0 && sorted.on(l as usize).len() >= FEWEST)
        .collect();
    order.sort_by(|&a, &b| {
        scores[b as usize]
            .total_cmp(&scores[a as usize])
            .then(a.cmp(&b))
    });
    order
}

/// Returns along which axis each of these leaves is to be halved: that in which the surface bends.
pub(super) fn directed(spline: &TSpline, leaves: &[u32], options: &Refinement) -> Vec<(u32, Axis)> {
    let all = spline.space().mesh().leaves();
    let centres: Vec<Point> = leaves
        .iter()
        .map(|&leaf| {
            let leaf = all[leaf as usize];
            let middle = |[low, high]: [i64; 2]| low as f64 + 0.5 * (high - low) as f64;
            Point {
                cylinder: leaf.cylinder,
                x: middle(leaf.x),
                y: middle(leaf.y),
            }
        })
        .collect();
    let bends = spline.evaluate(&centres, Order::Second).second;
    let axis = |(&leaf, [xx, _, yy]): (&u32, &[msplines_common::Vector3<f64>; 3])| {
        let [w, h] = all[leaf as usize].size().map(|s| s as f64 / UNITS);
        let (along, across) = (xx.norm() * w * w, yy.norm() * h * h);
        let axis = if along > options.ratio * across {
            Axis::X
        } else if across > options.ratio * along {
            Axis::Y
        } else {
            Axis::Both
        };
        (leaf, axis)
    };
    leaves.iter().zip(&bends).map(axis).collect()
}
