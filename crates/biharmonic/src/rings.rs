//! Voronoi cells of the knots, and the rings of cells around a knot.
//!
//! Two knots are neighbours where a mesh edge joins their cells. The 0-ring of a knot is the knot
//! itself, its r-ring all knots that at most `r` steps between neighbours lead to.

use std::collections::BTreeSet;

use msplines_common::mesh::TriangleMesh;

use crate::select::voronoi::Graph;

/// Cells, their vertices and their neighbours; knots are named by their index.
#[derive(Debug)]
pub(crate) struct Rings {
    /// The cell of each vertex.
    cell: Vec<u32>,
    neighbours: Vec<Vec<u32>>,
    starts: Vec<usize>,
    members: Vec<u32>,
}

impl Rings {
    /// Finds the cells along mesh edges, in about `n log n`.
    pub(crate) fn build(mesh: &TriangleMesh, knots: &[u32]) -> Self {
        Self::along(&Graph::build(mesh), knots)
    }

    /// Finds the cells along the edges of a graph.
    pub(crate) fn along(graph: &Graph, knots: &[u32]) -> Self {
        let cell = graph.cells(knots);
        let adjacency = graph.adjacency(&cell, knots.len());
        let neighbours = adjacency
            .into_iter()
            .map(|around| around.into_iter().collect())
            .collect();
        let mut starts = vec![0usize; knots.len() + 1];
        cell.iter().for_each(|&c| starts[c as usize + 1] += 1);
        for c in 0..knots.len() {
            starts[c + 1] += starts[c];
        }
        let mut next = starts.clone();
        let mut members = vec![0u32; cell.len()];
        for (vertex, &c) in cell.iter().enumerate() {
            members[next[c as usize]] = vertex as u32;
            next[c as usize] += 1;
        }
        Self {
            cell,
            neighbours,
            starts,
            members,
        }
    }

    /// Returns the cell of every vertex.
    pub(crate) fn cells(&self) -> &[u32] {
        &self.cell
    }

    /// Returns the number of cells.
    pub(crate) fn len(&self) -> usize {
        self.neighbours.len()
    }

    /// Returns the cell of a vertex.
    pub(crate) fn cell(&self, vertex: usize) -> usize {
        self.cell[vertex] as usize
    }

    /// Returns the vertices of a cell, ascending.
    pub(crate) fn members(&self, cell: u32) -> &[u32] {
        &self.members[self.starts[cell as usize]..self.starts[cell as usize + 1]]
    }

    /// Returns the neighbours of a knot, ascending.
    pub(crate) fn neighbours(&self, knot: usize) -> &[u32] {
        &self.neighbours[knot]
    }

    /// Returns the knots of a ring, ascending, the centre among them.
    pub(crate) fn around(&self, centre: usize, rings: u32) -> Vec<u32> {
        let mut found = BTreeSet::from([centre as u32]);
        let mut front = vec![centre as u32];
        for _ in 0..rings {
            let mut next = Vec::new();
            for &knot in &front {
                let around = self.neighbours[knot as usize].iter().copied();
                next.extend(around.filter(|&other| found.insert(other)));
            }
            front = next;
        }
        found.into_iter().collect()
    }

    /// Returns for each cell the ring around `centre` it lies in, `limit` for those beyond.
    pub(crate) fn distances(&self, centre: usize, limit: u8) -> Vec<u8> {
        let mut distance = vec![limit; self.len()];
        distance[centre] = 0;
        let mut front = vec![centre as u32];
        for ring in 1..limit {
            let mut next = Vec::new();
            for &knot in &front {
                for &other in &self.neighbours[knot as usize] {
                    if distance[other as usize] > ring {
                        distance[other as usize] = ring;
                        next.push(other);
                    }
                }
            }
            front = next;
        }
        distance
    }
}
