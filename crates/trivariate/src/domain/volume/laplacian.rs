//! Laplacians of solids.

use msplines_common::linalg::SymmetricMatrix;
use msplines_common::mesh::tet::{CELL_EDGES, CELL_FACES, TetMesh};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use super::options::VolumeWeights;

/// Cells of one task.
const CHUNK: usize = 1024;

/// Returns the Laplacian of a solid, positive semidefinite for [`VolumeWeights::Linear`], with zero
/// row sums.
///
/// # Reference
/// [Kim2014] Eq. (1), §4.2. Deviation: `w_ij` is the sum of `l_kl cot θ_kl / 6` over the edges kl
/// opposite to ij, as finite elements have it; the paper's own `l_ij cot θ_kl` reproduces no linear
/// function, and is an option.
#[must_use]
pub fn solid_laplacian(mesh: &TetMesh, weights: VolumeWeights) -> SymmetricMatrix {
    let topology = mesh.topology();
    let cells: Vec<[f64; 6]> = (0..mesh.cell_count() as u32)
        .into_par_iter()
        .with_min_len(CHUNK)
        .map(|cell| cell_weights(&mesh.tetrahedron(cell), weights))
        .collect();
    let mut by_edge = vec![0.0; topology.edges().len()];
    for (edges, weights) in topology.cell_edges().iter().zip(&cells) {
        for (&edge, weight) in edges.iter().zip(weights) {
            by_edge[edge as usize] += weight;
        }
    }
    let mut diagonal = vec![0.0; mesh.vertex_count()];
    let mut entries = Vec::with_capacity(by_edge.len() + diagonal.len());
    for (&[a, b], &weight) in topology.edges().iter().zip(&by_edge) {
        diagonal[a as usize] += weight;
        diagonal[b as usize] += weight;
        entries.push((b, a, -weight));
    }
    entries.extend(
        diagonal
            .iter()
            .zip(0u32..)
            .map(|(&sum, vertex)| (vertex, vertex, sum)),
    );
    SymmetricMatrix::from_lower_triplets(diagonal.len(), &entries)
}

/// Returns the weights of the edges of a cell, in the order of [`CELL_EDGES`].
///
/// With outward area vectors `n` of the faces, twice as long as the areas, and volume `V`, the
/// cotangent at edge kl between the faces opposite to i and j is `-n_i . n_j / (6 V l_kl)`.
fn cell_weights(corners: &[Point3<f64>; 4], weights: VolumeWeights) -> [f64; 6] {
    let normals: [Vector3<f64>; 4] =
        CELL_FACES.map(|[a, b, c]| (corners[b] - corners[a]).cross(&(corners[c] - corners[a])));
    let six_volumes =
        (corners[1] - corners[0]).dot(&(corners[2] - corners[0]).cross(&(corners[3] - corners[0])));
    CELL_EDGES.map(|[i, j]| {
        let linear = -normals[i].dot(&normals[j]) / (6.0 * six_volumes);
        match weights {
            VolumeWeights::Linear => linear,
            VolumeWeights::Literal => {
                let [k, l] = opposite(i, j);
                let own = (corners[j] - corners[i]).norm();
                6.0 * own * linear / (corners[l] - corners[k]).norm()
            }
        }
    })
}

fn opposite(i: usize, j: usize) -> [usize; 2] {
    let at = CELL_EDGES
        .iter()
        .position(|&edge| edge == [i, j])
        .unwrap_or(0);
    CELL_EDGES[5 - at]
}

#[cfg(test)]
mod tests {
    use msplines_common::mesh::shapes::box_solid;
    use msplines_common::mesh::tet::dihedral_angles;

    use super::*;

    fn skewed() -> TetMesh {
        let mesh = box_solid([4, 3, 5]);
        let wave = |p: &Point3<f64>| {
            Point3::new(
                p.x + 0.15 * (3.0 * p.y + p.z).sin(),
                0.7 * p.y + 0.1 * (2.0 * p.x - p.z).cos(),
                1.3 * p.z + 0.12 * (p.x + 5.0 * p.y).sin(),
            )
        };
        let mesh = mesh.with_positions(mesh.positions().iter().map(wave).collect());
        assert!(mesh.not_positive().is_empty());
        mesh
    }

    #[test]
    fn weights_are_lengths_times_cotangents() {
        let mesh = skewed();
        for cell in 0..mesh.cell_count() as u32 {
            let corners = mesh.tetrahedron(cell);
            let angles = dihedral_angles(&corners);
            let length = |e: usize| {
                let [a, b] = CELL_EDGES[e];
                (corners[b] - corners[a]).norm()
            };
            let linear = cell_weights(&corners, VolumeWeights::Linear);
            let literal = cell_weights(&corners, VolumeWeights::Literal);
            for e in 0..6 {
                let cotangent = 1.0 / angles[5 - e].tan();
                assert!((linear[e] - length(5 - e) * cotangent / 6.0).abs() < 1e-13);
                assert!((literal[e] - length(e) * cotangent).abs() < 1e-12);
            }
        }
    }

    /// Linear functions are harmonic inside: this is what the paper's own weights miss.
    #[test]
    fn linear_functions_are_reproduced() {
        let mesh = skewed();
        let residual = |weights: VolumeWeights| -> f64 {
            let laplacian = solid_laplacian(&mesh, weights);
            let inside = (0..mesh.vertex_count()).filter(|&v| {
                mesh.topology().boundary_vertex(v as u32) == msplines_common::mesh::NONE
            });
            inside
                .map(|vertex| {
                    let sum: Vector3<f64> = laplacian
                        .column(vertex)
                        .map(|(other, entry)| mesh.positions()[other].coords * entry)
                        .sum();
                    let size: f64 = laplacian.column(vertex).map(|(_, entry)| entry.abs()).sum();
                    sum.norm() / size
                })
                .fold(0.0, f64::max)
        };
        assert!(residual(VolumeWeights::Linear) < 1e-14);
        assert!(residual(VolumeWeights::Literal) > 1e-3);
    }
}
