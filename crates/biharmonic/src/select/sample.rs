//! Poisson-disk samples, of even density or denser where the surface bends.
//!
//! The latter are the first candidates of the selection, and both are selections of their own to
//! compare it with. The density that follows the bending is `(c |A⁻¹ L A⁻¹ L S|)^0.4` with the
//! weights `c` of the vertices, smoothed: a quarter of the order at which a spline of fourth
//! order needs knots, tempered because the finest scale of a scan is noise.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::voronoi::{Distance, Graph};
use crate::Space;
use crate::target::Centred;

/// Power of the bi-Laplacian that the density follows.
const DENSITY_POWER: f64 = 0.4;

/// Radii are at most so many times the median one.
const LARGEST_RADIUS: f64 = 6.0;

/// Steps of the search for the radius that gives the number of samples asked for.
const RADIUS_STEPS: u32 = 12;

/// Returns about `wanted` vertices and at least `least`, ascending.
pub(super) fn sample(
    space: &Space,
    target: &Centred,
    wanted: usize,
    least: usize,
    seed: u64,
) -> Vec<u32> {
    let vertices = target.data.nrows();
    // A sample this dense would leave out vertices at random: rather start from all of them.
    if 2 * wanted > vertices {
        return (0..vertices as u32).collect();
    }
    let graph = Graph::build(space.mesh());
    let radii = relative_radii(space, target, &graph);
    let order = random_order(vertices, seed);
    let (mut low, mut high) = (0.0, largest_scale(space, wanted));
    let mut best: Vec<u32> = (0..vertices as u32).collect();
    for _ in 0..RADIUS_STEPS {
        let middle = 0.5 * (low + high);
        let found = disks(&graph, &radii, middle, &order);
        let enough = found.len() >= wanted.max(least);
        *(if enough { &mut low } else { &mut high }) = middle;
        let close = enough && found.len() < best.len();
        if close {
            best = found;
        }
        if close && best.len() as f64 <= 1.03 * wanted as f64 {
            break;
        }
    }
    best.sort_unstable();
    best
}

/// How the density of a sample varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Density {
    /// Not at all: blue noise.
    Even,
    /// With the bi-Laplacian of the data.
    Curvature,
}

/// Returns exactly `count` vertices, at least one and at most all, ascending.
///
/// A sample of hardly fewer is filled up with the vertices farthest from it, as multiples of their
/// own radius.
pub(super) fn exact_sample(
    space: &Space,
    target: &Centred,
    count: usize,
    density: Density,
    seed: u64,
) -> Vec<u32> {
    let vertices = target.data.nrows();
    let graph = Graph::build(space.mesh());
    let radii = match density {
        Density::Even => vec![1.0; vertices],
        Density::Curvature => relative_radii(space, target, &graph),
    };
    let order = random_order(vertices, seed);
    let (mut low, mut high) = (0.0, largest_scale(space, count));
    let mut best = vec![order[0].1];
    for _ in 0..RADIUS_STEPS {
        let middle = 0.5 * (low + high);
        let found = disks(&graph, &radii, middle, &order);
        *(if found.len() > count {
            &mut low
        } else {
            &mut high
        }) = middle;
        if found.len() <= count && found.len() > best.len() {
            best = found;
        }
        if best.len() == count {
            break;
        }
    }
    fill(&graph, &radii, count, &mut best);
    best.sort_unstable();
    best
}

/// Adds the vertex farthest from the sample, as a multiple of its own radius, until there are `count`.
fn fill(graph: &Graph, radii: &[f64], count: usize, sample: &mut Vec<u32>) {
    let mut distance = vec![f64::INFINITY; radii.len()];
    sample
        .iter()
        .for_each(|&seed| approach(graph, &mut distance, seed));
    let mut taken = vec![false; radii.len()];
    sample.iter().for_each(|&seed| taken[seed as usize] = true);
    let relative = |distance: &[f64], v: u32| Distance(distance[v as usize] / radii[v as usize]);
    let mut farthest: BinaryHeap<(Distance, Reverse<u32>)> = (0..radii.len() as u32)
        .map(|v| (relative(&distance, v), Reverse(v)))
        .collect();
    while sample.len() < count {
        let Some((known, Reverse(vertex))) = farthest.pop() else {
            return;
        };
        if taken[vertex as usize] {
            continue;
        }
        let now = relative(&distance, vertex);
        if now < known {
            // The sample has come closer since.
            farthest.push((now, Reverse(vertex)));
            continue;
        }
        sample.push(vertex);
        taken[vertex as usize] = true;
        approach(graph, &mut distance, vertex);
    }
}

/// Lowers distances to the sample after `seed` has joined it.
fn approach(graph: &Graph, distance: &mut [f64], seed: u32) {
    let mut heap = BinaryHeap::from([Reverse((Distance(0.0), seed))]);
    distance[seed as usize] = 0.0;
    graph.spread(&mut heap, distance, f64::INFINITY, |_, _| {});
}

/// Returns all vertices in the order in which disks are tried.
fn random_order(vertices: usize, seed: u64) -> Vec<(u64, u32)> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut order: Vec<(u64, u32)> = (0..vertices as u32).map(|v| (random.random(), v)).collect();
    order.sort_unstable();
    order
}

/// Returns a radius of which far fewer than `wanted` disks cover the surface.
fn largest_scale(space: &Space, wanted: usize) -> f64 {
    let area: f64 = space.operators().mass.iter().sum();
    4.0 * (area / wanted as f64).sqrt()
}

/// Returns the radius of the disk of each vertex, with median 1.
fn relative_radii(space: &Space, target: &Centred, graph: &Graph) -> Vec<f64> {
    let data = &target.data;
    let coefficients = space.coefficients(data);
    let mass = &space.operators().mass;
    let mut density: Vec<f64> = (0..data.nrows())
        .map(|v| {
            let square: f64 = (0..data.ncols())
                .map(|c| coefficients[(v, c)].powi(2))
                .sum();
            (target.weight(v) * square.sqrt() / mass[v]).powf(DENSITY_POWER)
        })
        .collect();
    for _ in 0..2 {
        density = (0..density.len() as u32)
            .map(|v| {
                let around = graph.neighbours(v);
                let sum: f64 = around.iter().map(|n| density[n.0 as usize]).sum();
                0.5 * density[v as usize] + 0.5 * sum / around.len().max(1) as f64
            })
            .collect();
    }
    let mut radii: Vec<f64> = density.iter().map(|d| 1.0 / d.sqrt()).collect();
    let mut sorted = radii.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted[sorted.len() / 2];
    for radius in &mut radii {
        let relative = *radius / median;
        // Flat data has no density: all radii alike.
        *radius = if relative.is_finite() {
            relative.min(LARGEST_RADIUS)
        } else {
            1.0
        };
    }
    radii
}

/// Takes vertices in `order` as long as no disk covers them.
fn disks(graph: &Graph, radii: &[f64], scale: f64, order: &[(u64, u32)]) -> Vec<u32> {
    let mut covered = vec![false; radii.len()];
    let mut distance = vec![f64::INFINITY; radii.len()];
    let mut touched = Vec::new();
    let mut heap = BinaryHeap::new();
    let mut taken = Vec::new();
    for &(_, seed) in order {
        if covered[seed as usize] {
            continue;
        }
        taken.push(seed);
        let radius = scale * radii[seed as usize];
        distance[seed as usize] = 0.0;
        touched.push(seed);
        heap.push(Reverse((Distance(0.0), seed)));
        graph.spread(&mut heap, &mut distance, radius, |_, to| touched.push(to));
        for v in touched.drain(..) {
            covered[v as usize] = true;
            distance[v as usize] = f64::INFINITY;
        }
    }
    taken
}
