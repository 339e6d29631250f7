//! Choices that the energy leaves open.
//!
//! Where a part of a network hangs together with the rest by few arcs that say little, it may be
//! seen from either side at nearly the same energy. The cycles of the two differ, and those that
//! span less area are more likely meant.

use std::collections::BTreeSet;

use nalgebra::{Point3, Vector3};

use super::energy::Field;
use super::search::{Move, groups};
use super::trace::{Tracer, after};

/// Differences of energy that tell nothing: a thirtieth of what a face is worth. The energies of
/// equally likely choices were seen to differ by a fifth of this.
const TIE: f64 = 0.01;

/// Area must fall by this fraction, so that rounding decides nothing.
const LESS: f64 = 1e-6;

/// Samples on each piece of an arc for areas.
const SAMPLES: usize = 2;

/// Mirrors groups of junctions that leave the energy nearly as it is and lessen the area.
pub(super) fn settle(field: &Field<'_>, chosen: &mut [u32]) {
    let arcs = field.graph.arcs().iter();
    let samples = arcs.map(|arc| {
        arc.shape
            .samples(SAMPLES)
            .into_iter()
            .map(|s| s.0)
            .collect()
    });
    let samples: Vec<Vec<Point3<f64>>> = samples.collect();
    let mut tracer = Tracer::new(field);
    for group in groups(field, chosen) {
        let mirror = Move::mirror(field, chosen, &group);
        if mirror.weigh(field, chosen, &mut tracer).abs() > TIE {
            continue;
        }
        let before = area_around(field, chosen, &group, &samples);
        mirror.apply(chosen);
        if area_around(field, chosen, &group, &samples) > before * (1.0 - LESS) {
            Move::mirror(field, chosen, &group).apply(chosen);
        }
    }
}

/// Returns the area of the cycles through some junctions.
fn area_around(
    field: &Field<'_>,
    chosen: &[u32],
    around: &[usize],
    samples: &[Vec<Point3<f64>>],
) -> f64 {
    let mut seen = BTreeSet::new();
    let mut sum = 0.0;
    for &v in around {
        for &start in &field.graph.junctions()[v].half_edges {
            let mut points: Vec<Vector3<f64>> = Vec::new();
            let mut h = start;
            while seen.insert(h) {
                let along = &samples[h as usize / 2];
                if h % 2 == 0 {
                    points.extend(along[1..].iter().map(|p| p.coords));
                } else {
                    points.extend(along.iter().rev().skip(1).map(|p| p.coords));
                }
                h = after(field, chosen, h);
            }
            sum += fan_area(&points);
        }
    }
    sum
}

/// Returns twice the area of the triangles between a closed polygon and its mean.
fn fan_area(points: &[Vector3<f64>]) -> f64 {
    let mean = points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64;
    let next = points.iter().cycle().skip(1);
    let twice = points.iter().zip(next);
    twice
        .map(|(p, q)| (p - mean).cross(&(q - mean)).norm())
        .sum()
}
