//! Loop's scheme, which smooths.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};

use super::cut;
use crate::mesh::NONE;
use crate::mesh::topology::Topology;
use crate::mesh::triangle::TriangleMesh;

/// Returns the mesh after `rounds` of Loop subdivision; a boundary becomes a cubic B-spline curve
/// that depends on the boundary alone.
///
/// # Reference
/// [Loop1987] vertex and edge masks. Deviation: boundaries follow the cubic B-spline masks.
///
/// # Panics
/// If there are more half-edges than 32-bit ids, or two faces with more than one side in common.
#[must_use]
pub fn subdivide_loop(mesh: &TriangleMesh, rounds: u32) -> TriangleMesh {
    let mut current = mesh.clone();
    for _ in 0..rounds {
        let topology = current.topology();
        let old = current.positions();
        let mut positions: Vec<Point3<f64>> = (0..old.len() as u32)
            .map(|v| old_vertex(topology, old, v))
            .collect();
        let edges = 0..topology.edge_count() as u32;
        positions.extend(edges.map(|edge| edge_vertex(topology, old, edge)));
        current = cut(topology, positions);
    }
    current
}

fn old_vertex(topology: &Topology, old: &[Point3<f64>], vertex: u32) -> Point3<f64> {
    let here = old[vertex as usize];
    let neighbours: Vec<u32> = topology.neighbours(vertex).collect();
    let towards =
        |ids: &[u32]| -> Vector3<f64> { ids.iter().map(|&v| old[v as usize] - here).sum() };
    if topology.is_boundary_vertex(vertex) {
        return here + towards(&[neighbours[0], neighbours[neighbours.len() - 1]]) * 0.125;
    }
    let valence = neighbours.len() as f64;
    let inner = 0.375 + 0.25 * (TAU / valence).cos();
    here + towards(&neighbours) * ((0.625 - inner * inner) / valence)
}

fn edge_vertex(topology: &Topology, old: &[Point3<f64>], edge: u32) -> Point3<f64> {
    let half_edge = topology.edge_half_edge(edge);
    let twin = topology.twin(half_edge);
    let [a, b] = topology.edge_vertices(edge).map(|v| old[v as usize]);
    let middle = a + (b - a) * 0.5;
    if twin == NONE {
        return middle;
    }
    let apex = |h: u32| old[topology.origin(Topology::previous(h)) as usize];
    middle + ((apex(half_edge) - middle) + (apex(twin) - middle)) * 0.125
}

#[cfg(test)]
mod tests {
    use super::super::lattice::{is_inside, lattice, octahedron};
    use super::super::subdivide_midpoint;
    use super::*;
    use crate::mesh::{Facts, shapes, zoo};

    #[test]
    fn loop_subdivision_keeps_topology_and_commutes_with_affine_maps() {
        for mesh in zoo::all() {
            let shear = |p: &Point3<f64>| Point3::new(2.0 * p.x + p.y, p.y - 3.0, p.z + 0.5 * p.x);
            let moved =
                |m: &TriangleMesh| m.with_positions(m.positions().iter().map(shear).collect());
            let (first, second) = (
                moved(&subdivide_loop(&mesh, 2)),
                subdivide_loop(&moved(&mesh), 2),
            );
            first.topology().sanity_check();
            assert_eq!(Facts::measure(&first).genus, Facts::measure(&mesh).genus);
            for (a, b) in first.positions().iter().zip(second.positions()) {
                assert!((a - b).norm() < 1e-13);
            }
        }
    }

    #[test]
    fn loop_subdivision_reproduces_planes_and_keeps_regular_lattices() {
        // On a regular lattice with linear data every vertex must stay and every edge be halved;
        // the boundary smooths corners, so only points two rings inside are compared.
        let mesh = lattice(|x, y| 3.0 * x - y);
        let (planar, _) = subdivide_midpoint(&mesh, 1);
        let smooth = subdivide_loop(&mesh, 1);
        for (a, b) in planar.positions().iter().zip(smooth.positions()) {
            if is_inside(a, 1) {
                assert!((a - b).norm() < 1e-13, "{a} {b}");
            }
        }
    }

    #[test]
    fn loop_subdivision_of_an_octahedron_is_known() {
        // Valence 4: inner = 3/8, weight (5/8 - 9/64) / 4 = 31/256; edges 3/8 + 3/8, 1/8 + 1/8.
        let fine = subdivide_loop(&octahedron(), 1);
        assert!((fine.positions()[0].x - (1.0 - 4.0 * 31.0 / 256.0)).abs() < 1e-15);
        assert!((fine.positions()[6] - Point3::new(0.375, 0.375, 0.0)).norm() < 1e-15);
        let round = subdivide_loop(&shapes::sphere(12), 3);
        assert_eq!(round.vertex_count(), 10 * 64 + 2);
    }
}
