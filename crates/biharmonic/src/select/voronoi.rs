//! Voronoi cells of knots along mesh edges.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

use msplines_common::mesh::{NONE, TriangleMesh};

/// A distance that orders totally; distances are finite and not negative.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Distance(pub(super) f64);

impl Eq for Distance {}

impl PartialOrd for Distance {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Distance {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

/// Vertices from which distances spread, the nearest first.
pub(super) type Front = BinaryHeap<Reverse<(Distance, u32)>>;

/// Edges and their lengths around each vertex, in flat arrays.
pub(crate) struct Graph {
    starts: Vec<usize>,
    neighbours: Vec<(u32, f64)>,
}

impl Graph {
    pub(crate) fn build(mesh: &TriangleMesh) -> Self {
        let (mut starts, mut neighbours) = (vec![0], Vec::new());
        for vertex in 0..mesh.vertex_count() as u32 {
            let here = mesh.positions()[vertex as usize];
            for other in mesh.topology().neighbours(vertex) {
                neighbours.push((other, (mesh.positions()[other as usize] - here).norm()));
            }
            starts.push(neighbours.len());
        }
        Self { starts, neighbours }
    }

    pub(crate) fn neighbours(&self, vertex: u32) -> &[(u32, f64)] {
        &self.neighbours[self.starts[vertex as usize]..self.starts[vertex as usize + 1]]
    }

    /// Spreads distances along edges, as long as they stay below `reach` and get smaller, from the
    /// vertices in `heap`, and tells of every step from one vertex to another.
    pub(super) fn spread(
        &self,
        heap: &mut Front,
        distance: &mut [f64],
        reach: f64,
        mut step: impl FnMut(u32, u32),
    ) {
        while let Some(Reverse((Distance(reached), vertex))) = heap.pop() {
            if reached > distance[vertex as usize] {
                continue;
            }
            for &(other, length) in self.neighbours(vertex) {
                let through = reached + length;
                if through < reach && through < distance[other as usize] {
                    distance[other as usize] = through;
                    step(vertex, other);
                    heap.push(Reverse((Distance(through), other)));
                }
            }
        }
    }

    /// Returns the nearest knot (as index into `knots`) of every vertex.
    pub(crate) fn cells(&self, knots: &[u32]) -> Vec<u32> {
        let vertices = self.starts.len() - 1;
        let mut distance = vec![f64::INFINITY; vertices];
        let mut cell = vec![NONE; vertices];
        let mut heap = BinaryHeap::new();
        for (k, &knot) in knots.iter().enumerate() {
            distance[knot as usize] = 0.0;
            cell[knot as usize] = k as u32;
            heap.push(Reverse((Distance(0.0), knot)));
        }
        self.spread(&mut heap, &mut distance, f64::INFINITY, |from, to| {
            cell[to as usize] = cell[from as usize];
        });
        cell
    }

    /// Returns, for each knot, the knots whose cells touch its own.
    pub(crate) fn adjacency(&self, cell: &[u32], knots: usize) -> Vec<BTreeSet<u32>> {
        let mut adjacency = vec![BTreeSet::new(); knots];
        for vertex in 0..cell.len() as u32 {
            let here = cell[vertex as usize];
            for &(other, _) in self.neighbours(vertex) {
                let there = cell[other as usize];
                if here != there && here != NONE && there != NONE {
                    adjacency[here as usize].insert(there);
                }
            }
        }
        adjacency
    }
}

/// Returns, for each of `knots` cells, the largest value at its vertices and the first vertex that has
/// it; zero where none is positive.
pub(super) fn largest_in_cells(cells: &[u32], values: &[f64], knots: usize) -> Vec<(f64, u32)> {
    let mut largest = vec![(0.0, 0); knots];
    for (vertex, (&cell, &value)) in cells.iter().zip(values).enumerate() {
        if value > largest[cell as usize].0 {
            largest[cell as usize] = (value, vertex as u32);
        }
    }
    largest
}
