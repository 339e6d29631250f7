//! The graph Laplacian of a mesh and the quadratic form `‖L x‖²` that its surfaces minimise.
//!
//! # Notation
//! `L = I - D⁻¹ W` with the adjacency `W` and its row sums `D`; `K = D - W`, so that
//! `Lᵀ L = K D⁻² K`.

use std::collections::VecDeque;

use msplines_common::linalg::{Mat, MatRef, Ordering, SymmetricMatrix};
use msplines_common::mesh::TriangleMesh;
use rayon::prelude::*;

use crate::error::FitError;

/// Rows that one task computes: a fixed number, so that results do not depend on threads.
const ROWS_PER_TASK: usize = 8192;

/// What the connectivity of a mesh alone decides, and all least-squares meshes on it share: the
/// graph Laplacian and an elimination order. Their factors differ, as the controls are in the matrix.
#[derive(Clone, Debug)]
pub struct Space {
    mesh: TriangleMesh,
    starts: Vec<usize>,
    neighbours: Vec<u32>,
    /// `Lᵀ L`.
    normal: SymmetricMatrix,
    /// An elimination order for `Lᵀ L` and its principal submatrices.
    ordering: Ordering,
}

impl Space {
    /// Assembles the graph Laplacian of a mesh and orders it.
    ///
    /// # Errors
    /// A mesh too large to be ordered.
    pub fn assemble(mesh: &TriangleMesh) -> Result<Self, FitError> {
        let topology = mesh.topology();
        let mut starts = vec![0];
        let mut neighbours = Vec::with_capacity(2 * topology.edge_count());
        for vertex in 0..topology.vertex_count() as u32 {
            neighbours.extend(topology.neighbours(vertex));
            starts.push(neighbours.len());
        }
        let normal = normal_matrix(&starts, &neighbours);
        let ordering = Ordering::nested_dissection(&normal)?;
        Ok(Self {
            mesh: mesh.clone(),
            starts,
            neighbours,
            normal,
            ordering,
        })
    }

    /// Returns the mesh.
    #[must_use]
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    pub(crate) fn size(&self) -> usize {
        self.starts.len() - 1
    }

    pub(crate) fn neighbours(&self, vertex: usize) -> &[u32] {
        &self.neighbours[self.starts[vertex]..self.starts[vertex + 1]]
    }

    pub(crate) fn normal(&self) -> &SymmetricMatrix {
        &self.normal
    }

    pub(crate) fn ordering(&self) -> &Ordering {
        &self.ordering
    }

    /// Returns the edges from each vertex to the nearest of `sources`, none if out of reach.
    pub(crate) fn hops(&self, sources: &[u32]) -> Vec<u32> {
        let mut hops = vec![u32::MAX; self.size()];
        let mut queue = VecDeque::new();
        for &source in sources {
            hops[source as usize] = 0;
            queue.push_back(source as usize);
        }
        while let Some(vertex) = queue.pop_front() {
            for &other in self.neighbours(vertex) {
                if hops[other as usize] == u32::MAX {
                    hops[other as usize] = hops[vertex] + 1;
                    queue.push_back(other as usize);
                }
            }
        }
        hops
    }

    /// Returns `Lᵀ L x`, summed over differences so that constants give exact zeros.
    pub(crate) fn normal_product(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        let mut out = Mat::zeros(x.nrows(), x.ncols());
        for side in 0..x.ncols() {
            let column: Vec<f64> = x.col(side).iter().copied().collect();
            let scaled = self.differences(&column, |sum, degree| sum / (degree * degree));
            let product = self.differences(&scaled, |sum, _| sum);
            out.col_mut(side)
                .iter_mut()
                .zip(product)
                .for_each(|(value, p)| *value = p);
        }
        out
    }

    /// Returns `finish(sum over neighbours of x_i - x_j, degree)` for every vertex.
    fn differences(&self, x: &[f64], finish: impl Fn(f64, f64) -> f64 + Sync) -> Vec<f64> {
        let mut out = vec![0.0; x.len()];
        out.par_chunks_mut(ROWS_PER_TASK)
            .enumerate()
            .for_each(|(task, chunk)| {
                for (offset, value) in chunk.iter_mut().enumerate() {
                    let vertex = task * ROWS_PER_TASK + offset;
                    let around = self.neighbours(vertex);
                    let sum = around
                        .iter()
                        .map(|&other| x[vertex] - x[other as usize])
                        .sum();
                    *value = finish(sum, around.len() as f64);
                }
            });
        out
    }
}

fn normal_matrix(starts: &[usize], neighbours: &[u32]) -> SymmetricMatrix {
    let size = starts.len() - 1;
    let mut entries = Vec::with_capacity(size + neighbours.len() / 2);
    let mut weights = Vec::with_capacity(size);
    for vertex in 0..size as u32 {
        let around = &neighbours[starts[vertex as usize]..starts[vertex as usize + 1]];
        let before = around.iter().filter(|&&other| other < vertex);
        entries.extend(before.map(|&other| (vertex, other, -1.0)));
        entries.push((vertex, vertex, around.len() as f64));
        weights.push(1.0 / (around.len() as f64).powi(2));
    }
    SymmetricMatrix::from_lower_triplets(size, &entries).congruence(&weights)
}
