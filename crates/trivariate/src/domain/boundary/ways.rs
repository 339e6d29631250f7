//! Ways on a surface that keep clear of paths.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

use msplines_common::mesh::NONE;

use super::options::RoutingOptions;
use super::route::{CORNER, FREE, Router, Task};
use crate::domain::cube::EDGES;

impl Router {
    /// Returns the shortest path that keeps clear of all others.
    pub(super) fn shortest(&self, task: &Task, factors: Option<&[f64]>) -> Option<Vec<u32>> {
        let count = self.surface.vertex_count();
        let (mut distance, mut from) = (vec![f64::INFINITY; count], vec![NONE; count]);
        let mut heap = BinaryHeap::new();
        let [start, end] = task.ends;
        distance[start as usize] = 0.0;
        // Lengths are not negative, so that their bits are in their order.
        heap.push(Reverse((0u64, start)));
        while let Some(Reverse((bits, vertex))) = heap.pop() {
            let here = f64::from_bits(bits);
            if vertex == end {
                return Some(backwards(&from, end));
            }
            if here > distance[vertex as usize] {
                continue;
            }
            for other in self.surface.topology().neighbours(vertex) {
                let leaves = vertex != start || task.doors[0].contains(&other);
                let enters = if other == end {
                    task.doors[1].contains(&vertex)
                } else {
                    self.owner[other as usize] == FREE
                };
                if !(leaves && enters) {
                    continue;
                }
                let there = here + self.length(vertex, other, factors);
                if there < distance[other as usize] {
                    distance[other as usize] = there;
                    from[other as usize] = vertex;
                    heap.push(Reverse((there.to_bits(), other)));
                }
            }
        }
        None
    }

    pub(super) fn length(&self, a: u32, b: u32, factors: Option<&[f64]>) -> f64 {
        let weight = |v: u32| {
            let factor = factors.map_or(1.0, |factors| factors[v as usize]);
            factor * self.ground[v as usize]
        };
        let [p, q] = [a, b].map(|v| self.surface.positions()[v as usize]);
        (q - p).norm() * 0.5 * (weight(a) + weight(b))
    }

    /// Returns whether an edge belongs to a path.
    fn on_path(&self, a: u32, b: u32) -> bool {
        let next = |path: &Vec<u32>| path.windows(2).any(|step| step == [a, b] || step == [b, a]);
        match (self.owner[a as usize], self.owner[b as usize]) {
            (FREE, _) | (_, FREE) => false,
            (CORNER, CORNER) => self.paths.iter().any(next),
            (CORNER, path) | (path, CORNER) => next(&self.paths[path as usize]),
            (one, other) => one == other && next(&self.paths[one as usize]),
        }
    }

    /// Returns the edges between blocked vertices in the part of the surface where a path must run,
    /// except those of paths.
    pub(super) fn blocked_edges(&self, task: &Task) -> Vec<[u32; 2]> {
        let topology = self.surface.topology();
        let mut seen = vec![false; self.surface.face_count()];
        let mut queue = VecDeque::new();
        for &face in &task.first_faces {
            if !std::mem::replace(&mut seen[face as usize], true) {
                queue.push_back(face);
            }
        }
        let mut blocked = Vec::new();
        while let Some(face) = queue.pop_front() {
            for half_edge in 3 * face..3 * face + 3 {
                let (a, b) = (topology.origin(half_edge), topology.target(half_edge));
                if self.on_path(a, b) {
                    continue;
                }
                let other = topology.twin(half_edge) / 3;
                if !std::mem::replace(&mut seen[other as usize], true) {
                    queue.push_back(other);
                }
                if self.owner[a as usize] != FREE && self.owner[b as usize] != FREE {
                    blocked.push([a.min(b), a.max(b)]);
                }
            }
        }
        blocked.sort_unstable();
        blocked.dedup();
        blocked
    }

    /// Returns how much longer every vertex counts for one path because others are near.
    pub(super) fn factors(&self, edge: usize, options: &RoutingOptions) -> Vec<f64> {
        let farthest = (3.0 * options.reach).ceil() as u32;
        let ends = EDGES[edge].map(|corner| self.corners[usize::from(corner)]);
        let mut rings = vec![NONE; self.owner.len()];
        let mut queue = VecDeque::new();
        for (vertex, &owner) in self.owner.iter().enumerate() {
            let vertex = vertex as u32;
            if owner != FREE && owner != edge as u8 && !ends.contains(&vertex) {
                rings[vertex as usize] = 0;
                queue.push_back(vertex);
            }
        }
        while let Some(vertex) = queue.pop_front() {
            let ring = rings[vertex as usize] + 1;
            if ring > farthest {
                break;
            }
            for other in self.surface.topology().neighbours(vertex) {
                if rings[other as usize] == NONE {
                    rings[other as usize] = ring;
                    queue.push_back(other);
                }
            }
        }
        let by_ring: Vec<f64> = (0..=farthest)
            .map(|ring| {
                1.0 + options.repulsion * (-(f64::from(ring) / options.reach).powi(2)).exp()
            })
            .collect();
        rings
            .iter()
            .map(|&ring| by_ring.get(ring as usize).copied().unwrap_or(1.0))
            .collect()
    }
}

/// Returns the path that ends in a vertex, from its start.
fn backwards(from: &[u32], end: u32) -> Vec<u32> {
    let mut path = vec![end];
    while let Some(&before) = from
        .get(path[path.len() - 1] as usize)
        .filter(|&&v| v != NONE)
    {
        path.push(before);
    }
    path.reverse();
    path
}
