//! Level sets of the latitude as loops, and where longitude begins on each of them.

use msplines_common::mesh::{Topology, TriangleMesh};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use super::error::CylinderError;

/// Rotations of a loop that are compared before the best one is refined, at most.
const ROTATIONS: usize = 256;

/// Steps of the golden section that refine it: to 10⁻⁶ of what lies between two of them.
const GOLDEN_STEPS: u32 = 30;

/// A closed polygon with its arc length.
pub(super) struct Loop {
    /// Corners, the first once more at the end.
    points: Vec<Point3<f64>>,
    /// Length up to each corner.
    lengths: Vec<f64>,
}

/// Edges that cross a level.
#[derive(Clone, Copy, Default)]
struct Crossed {
    /// The first of them.
    edge: u32,
    /// How many there are.
    count: usize,
}

/// Returns the level sets of `values` at ascending levels, counterclockwise seen against their
/// rise on a surface whose normals point outwards.
///
/// A vertex at a level counts as above it. So the edges that cross it are known exactly, and so is
/// whether they all belong to one loop.
pub(super) fn trace(
    surface: &TriangleMesh,
    values: &[f64],
    levels: &[f64],
) -> Result<Vec<Loop>, CylinderError> {
    let topology = surface.topology();
    let mut crossed = vec![Crossed::default(); levels.len()];
    for edge in 0..topology.edge_count() as u32 {
        let [a, b] = topology.edge_vertices(edge).map(|v| values[v as usize]);
        let from = levels.partition_point(|&level| level <= a.min(b));
        let to = levels.partition_point(|&level| level <= a.max(b));
        for level in &mut crossed[from..to] {
            if level.count == 0 {
                level.edge = edge;
            }
            level.count += 1;
        }
    }
    let pairs = crossed.par_iter().zip(levels);
    let loops = pairs.map(|(&crossed, &level)| one_loop(surface, values, level, crossed));
    // Of several errors, that of the lowest level.
    loops.collect::<Vec<_>>().into_iter().collect()
}

fn one_loop(
    surface: &TriangleMesh,
    values: &[f64],
    level: f64,
    crossed: Crossed,
) -> Result<Loop, CylinderError> {
    let topology = surface.topology();
    let above = |v: u32| values[v as usize] >= level;
    let half_edge = topology.edge_half_edge(crossed.edge);
    let start = if above(topology.origin(half_edge)) {
        half_edge
    } else {
        topology.twin(half_edge)
    };
    let (mut points, mut at) = (Vec::with_capacity(crossed.count + 1), start);
    while points.is_empty() || (at != start && points.len() < crossed.count) {
        let [high, low] = [topology.origin(at), topology.target(at)].map(|v| v as usize);
        let share = (level - values[low]) / (values[high] - values[low]);
        let [p, q] = [surface.positions()[low], surface.positions()[high]];
        points.push(p + (q - p) * share);
        at = following(topology, at, above);
    }
    if at != start || points.len() != crossed.count {
        return Err(CylinderError::NotOneLoop {
            level,
            vertex: topology.origin(start),
            crossed: crossed.count,
            traced: points.len(),
        });
    }
    points.push(points[0]);
    Ok(Loop::build(points))
}

/// The next half-edge that leads from above the level to below, through the face to the left.
fn following(topology: &Topology, half_edge: u32, above: impl Fn(u32) -> bool) -> u32 {
    let next = Topology::next(half_edge);
    if above(topology.target(next)) {
        topology.twin(next)
    } else {
        topology.twin(Topology::previous(half_edge))
    }
}

impl Loop {
    fn build(points: Vec<Point3<f64>>) -> Self {
        let mut lengths = vec![0.0; points.len()];
        for at in 1..points.len() {
            lengths[at] = lengths[at - 1] + (points[at] - points[at - 1]).norm();
        }
        Self { points, lengths }
    }

    /// Returns the same loop run through the other way.
    pub(super) fn reversed(mut self) -> Self {
        self.points.reverse();
        Self::build(self.points)
    }

    /// Returns `count` evenly spaced points, the first of them after a share of the length.
    fn sample(&self, start: f64, count: usize) -> Vec<Point3<f64>> {
        let total = self.lengths[self.lengths.len() - 1];
        let share = |j: usize| (start + j as f64 / count as f64).rem_euclid(1.0);
        (0..count).map(|j| self.at(share(j) * total)).collect()
    }

    /// The point after a length.
    fn at(&self, length: f64) -> Point3<f64> {
        let next = self.lengths.partition_point(|&l| l <= length);
        let next = next.clamp(1, self.points.len() - 1);
        let [from, to] = [self.lengths[next - 1], self.lengths[next]];
        let share = if to > from {
            ((length - from) / (to - from)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        self.points[next - 1] + (self.points[next] - self.points[next - 1]) * share
    }
}

/// Returns evenly spaced points of each loop, one loop after another, each of them begun where its
/// points lie nearest to those of the loop before.
pub(super) fn align(loops: &[Loop], meridians: usize) -> Vec<Point3<f64>> {
    let mut points: Vec<Point3<f64>> = Vec::with_capacity(loops.len() * meridians);
    for (at, next) in loops.iter().enumerate() {
        let start = if at == 0 {
            0.0
        } else {
            best_start(next, &points[(at - 1) * meridians..])
        };
        points.extend(next.sample(start, meridians));
    }
    points
}

/// The share of the length of a loop at which its evenly spaced points, in this order, lie nearest
/// to those of another.
fn best_start(next: &Loop, before: &[Point3<f64>]) -> f64 {
    let count = before.len();
    let points = next.sample(0.0, count);
    let centre = before.iter().map(|p| p.coords).sum::<Vector3<f64>>() / count as f64;
    let arms: Vec<Vector3<f64>> = before.iter().map(|p| p.coords - centre).collect();
    // Squared distances differ only by the products, as a rotation permutes the points.
    let product = |turn: usize| -> f64 {
        let turned = points[turn..].iter().chain(&points[..turn]);
        turned.zip(&arms).map(|(p, arm)| p.coords.dot(arm)).sum()
    };
    let stride = count.div_ceil(ROTATIONS);
    let turns = (0..count).step_by(stride);
    let scored = turns.map(|turn| (product(turn), turn));
    let best = scored.reduce(|a, b| if b.0 > a.0 { b } else { a });
    let turn = best.map_or(0, |best| best.1) as f64;
    let distance = |start: f64| -> f64 {
        let points = next.sample(start, count);
        let pairs = points.iter().zip(before);
        pairs.map(|(p, q)| (p - q).norm_squared()).sum()
    };
    let place = |turn: f64| turn / count as f64;
    golden_section(
        place(turn - stride as f64),
        place(turn + stride as f64),
        distance,
    )
}

/// Where a function with one minimum has it.
fn golden_section(mut low: f64, mut high: f64, function: impl Fn(f64) -> f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let mut inner = [high - golden * (high - low), low + golden * (high - low)];
    let mut found = inner.map(&function);
    for _ in 0..GOLDEN_STEPS {
        if found[0] <= found[1] {
            high = inner[1];
            inner = [high - golden * (high - low), inner[0]];
            found = [function(inner[0]), found[0]];
        } else {
            low = inner[0];
            inner = [inner[1], low + golden * (high - low)];
            found = [found[1], function(inner[1])];
        }
    }
    0.5 * (low + high)
}
