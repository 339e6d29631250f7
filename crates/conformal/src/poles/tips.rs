//! Vertices at the ends of a surface: those farthest from everything else.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use msplines_common::mesh::TriangleMesh;

/// Sources of distances, each as far from those before as can be.
const SOURCES: usize = 16;

/// Rise of the mean distance above the pass to the next higher vertex, over its largest value, that
/// makes a tip of a vertex: detours along edges make smaller ones everywhere.
const PROMINENCE: f64 = 0.02;

/// Most tips that are looked at.
const TIPS: usize = 16;

/// Distance of a source from a tip, over that of the sources from each other, below which it is the same.
const SAME: f64 = 0.5;

/// Lengths of edges by vertex.
struct Ways {
    starts: Vec<u32>,
    ends: Vec<(u32, f64)>,
}

impl Ways {
    fn of(mesh: &TriangleMesh) -> Self {
        let topology = mesh.topology();
        let at = mesh.positions();
        let mut ways = Self {
            starts: vec![0],
            ends: Vec::new(),
        };
        for vertex in 0..mesh.vertex_count() as u32 {
            let length = |v: u32| (at[v as usize] - at[vertex as usize]).norm();
            let beside = topology.neighbours(vertex).map(|v| (v, length(v)));
            ways.ends.extend(beside);
            ways.starts.push(ways.ends.len() as u32);
        }
        ways
    }

    fn from(&self, vertex: u32) -> &[(u32, f64)] {
        let range = [vertex, vertex + 1].map(|v| self.starts[v as usize] as usize);
        &self.ends[range[0]..range[1]]
    }

    /// Distances along edges from a vertex. O(n log n).
    fn distances(&self, source: u32) -> Vec<f64> {
        let mut distances = vec![f64::INFINITY; self.starts.len() - 1];
        distances[source as usize] = 0.0;
        // Bits of numbers that are not negative are in their order.
        let mut queue = BinaryHeap::from([Reverse((0, source))]);
        while let Some(Reverse((bits, vertex))) = queue.pop() {
            let here = f64::from_bits(bits);
            if here > distances[vertex as usize] {
                continue;
            }
            for &(next, length) in self.from(vertex) {
                let there = here + length;
                if there < distances[next as usize] {
                    distances[next as usize] = there;
                    queue.push(Reverse((there.to_bits(), next)));
                }
            }
        }
        distances
    }

    /// The vertices at which a function has a maximum of some prominence, most prominent first.
    fn maxima(&self, function: &[f64], least: f64) -> Vec<u32> {
        let mut order: Vec<u32> = (0..function.len() as u32).collect();
        order.sort_by(|&a, &b| function[b as usize].total_cmp(&function[a as usize]));
        // The highest vertex of the part that each vertex belongs to, along a path.
        let mut above: Vec<u32> = vec![u32::MAX; function.len()];
        let mut found = Vec::new();
        for &vertex in &order {
            above[vertex as usize] = vertex;
            for &(beside, _) in self.from(vertex) {
                if above[beside as usize] == u32::MAX {
                    continue;
                }
                let parts = [vertex, beside].map(|v| highest(&mut above, v));
                let [low, high] = if function[parts[0] as usize] <= function[parts[1] as usize] {
                    parts
                } else {
                    [parts[1], parts[0]]
                };
                if low != high {
                    let rise = function[low as usize] - function[vertex as usize];
                    found.push((rise, low));
                    above[low as usize] = high;
                }
            }
        }
        found.extend(order.first().map(|&top| (f64::INFINITY, top)));
        found.retain(|(rise, _)| *rise >= least);
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        found.into_iter().map(|(_, vertex)| vertex).collect()
    }
}

fn highest(above: &mut [u32], mut vertex: u32) -> u32 {
    while above[vertex as usize] != vertex {
        above[vertex as usize] = above[above[vertex as usize] as usize];
        vertex = above[vertex as usize];
    }
    vertex
}

/// Returns where the mean distance from everything else has its maxima, and then vertices far from
/// each other and from these. O(n log n) for each of sixteen sources.
///
/// # Reference
/// [Hilaga2001], the integral of geodesic distance. Deviation: the mean over sixteen sources, along edges.
pub(super) fn tips(mesh: &TriangleMesh) -> Vec<u32> {
    let ways = Ways::of(mesh);
    let vertices = 0..mesh.vertex_count() as u32;
    let farthest = |distances: &[f64]| {
        let reached = vertices
            .clone()
            .filter(|&v| distances[v as usize].is_finite());
        reached.fold(0, |best, v| {
            if distances[v as usize] > distances[best as usize] {
                v
            } else {
                best
            }
        })
    };
    // The end of a longest path, so that no number of a vertex counts.
    let centre = mesh
        .positions()
        .iter()
        .map(|p| p.coords)
        .sum::<nalgebra::Vector3<f64>>()
        / mesh.vertex_count() as f64;
    let out: Vec<f64> = (mesh.positions().iter())
        .map(|p| (p.coords - centre).norm())
        .collect();
    let mut sources = vec![farthest(&out)];
    let mut sums = vec![0.0; mesh.vertex_count()];
    let mut nearest = vec![f64::INFINITY; mesh.vertex_count()];
    let mut fields = Vec::new();
    let mut spacing = f64::INFINITY;
    for source in 0..SOURCES {
        let field = ways.distances(sources[source]);
        for (vertex, &distance) in field.iter().enumerate() {
            sums[vertex] += distance;
            nearest[vertex] = nearest[vertex].min(distance);
        }
        fields.push(field);
        let next = farthest(&nearest);
        spacing = nearest[next as usize];
        sources.push(next);
    }
    let largest = sums.iter().copied().fold(0.0, f64::max);
    let mut found = ways.maxima(&sums, PROMINENCE * largest);
    found.truncate(TIPS);
    for (source, field) in sources.iter().zip(&fields) {
        let is_new = found.iter().all(|&v| field[v as usize] > SAME * spacing);
        if is_new {
            found.push(*source);
        }
    }
    found.truncate(TIPS);
    found
}
