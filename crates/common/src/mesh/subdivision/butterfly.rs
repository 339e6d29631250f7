//! The modified butterfly scheme, which interpolates.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};

use super::cut;
use crate::mesh::NONE;
use crate::mesh::topology::Topology;
use crate::mesh::triangle::TriangleMesh;

/// Number of neighbours of a vertex in a regular triangular lattice.
const REGULAR: usize = 6;

/// Returns the mesh after `rounds` of modified butterfly subdivision: a smooth surface through all
/// its vertices. A boundary becomes a curve that depends on the boundary alone.
///
/// The limit is continuously differentiable, but not convex where the mesh is: it swings around
/// sharp edges.
///
/// # Reference
/// [Zorin1996] 8-point stencil with w = 0, stencils of extraordinary vertices, 4-point boundary.
/// Deviation: a vertex on the boundary or of valence 2 counts as regular, and where a wing of its
/// stencil would lie beyond the boundary, the opposite corner is mirrored in the middle of the side.
///
/// # Panics
/// If there are more half-edges than 32-bit ids, or two faces with more than one side in common.
#[must_use]
pub fn subdivide_butterfly(mesh: &TriangleMesh, rounds: u32) -> TriangleMesh {
    let mut current = mesh.clone();
    for _ in 0..rounds {
        let topology = current.topology();
        let old = current.positions();
        let edges = 0..topology.edge_count() as u32;
        let mut positions = old.to_vec();
        positions.extend(edges.map(|edge| edge_vertex(topology, old, edge)));
        current = cut(topology, positions);
    }
    current
}

fn edge_vertex(topology: &Topology, old: &[Point3<f64>], edge: u32) -> Point3<f64> {
    let half_edge = topology.edge_half_edge(edge);
    let twin = topology.twin(half_edge);
    if twin == NONE {
        return on_boundary(topology, old, half_edge);
    }
    let irregular = |&h: &u32| is_extraordinary(topology, topology.origin(h));
    let around = |h: u32| beside_extraordinary(topology, old, h);
    match ([half_edge, twin].map(|h| irregular(&h)), half_edge, twin) {
        ([true, true], a, b) => nalgebra::center(&around(a), &around(b)),
        ([true, false], a, _) => around(a),
        ([false, true], _, b) => around(b),
        ([false, false], a, b) => between_regular(topology, old, [a, b]),
    }
}

fn is_extraordinary(topology: &Topology, vertex: u32) -> bool {
    let valence = topology.outgoing(vertex).count();
    !topology.is_boundary_vertex(vertex) && valence > 2 && valence != REGULAR
}

/// Returns the vertex of a boundary edge: the four-point rule along the boundary.
fn on_boundary(topology: &Topology, old: &[Point3<f64>], half_edge: u32) -> Point3<f64> {
    let place = |vertex: u32| old[vertex as usize];
    let (from, to) = (topology.origin(half_edge), topology.target(half_edge));
    let middle = nalgebra::center(&place(from), &place(to));
    // Around a boundary vertex the first neighbour is the next one along it, the last the one before.
    let before = topology.neighbours(from).last();
    let after = topology.neighbours(to).next();
    let beyond = before.into_iter().chain(after);
    middle - beyond.map(|v| place(v) - middle).sum::<Vector3<f64>>() / 16.0
}

/// Returns the vertex of an edge between regular vertices, given by its two half-edges.
fn between_regular(topology: &Topology, old: &[Point3<f64>], edge: [u32; 2]) -> Point3<f64> {
    let place = |h: u32| old[topology.origin(h) as usize];
    let apex = |h: u32| place(Topology::previous(h));
    let middle = nalgebra::center(&place(edge[0]), &place(edge[1]));
    let wing = |side: u32| match topology.twin(side) {
        NONE => place(side) + (place(Topology::next(side)) - apex(side)),
        across => apex(across),
    };
    let offset = |half_edge: u32| {
        let wings = [Topology::next(half_edge), Topology::previous(half_edge)];
        let wings: Vector3<f64> = wings.iter().map(|&side| wing(side) - middle).sum();
        (apex(half_edge) - middle) / 8.0 - wings / 16.0
    };
    middle + (offset(edge[0]) + offset(edge[1]))
}

/// Returns the vertex of an edge that leaves an extraordinary vertex along a half-edge.
fn beside_extraordinary(topology: &Topology, old: &[Point3<f64>], half_edge: u32) -> Point3<f64> {
    let centre = topology.origin(half_edge);
    let here = old[centre as usize];
    let mut neighbours: Vec<u32> = topology.neighbours(centre).collect();
    // The weights are symmetric, so that the direction around the vertex is the same.
    let first = topology.outgoing(centre).position(|h| h == half_edge);
    neighbours.rotate_left(first.unwrap_or_default());
    let weights = extraordinary_weights(neighbours.len());
    let parts = neighbours.iter().zip(weights);
    here + parts
        .map(|(&v, weight)| (old[v as usize] - here) * weight)
        .sum::<Vector3<f64>>()
}

/// Returns the weights of the neighbours of an extraordinary vertex, from the end of the edge
/// around; its own weight is what they lack to one, 3/4.
fn extraordinary_weights(valence: usize) -> Vec<f64> {
    match valence {
        3 => vec![5.0 / 12.0, -1.0 / 12.0, -1.0 / 12.0],
        4 => vec![0.375, 0.0, -0.125, 0.0],
        _ => {
            let count = valence as f64;
            let weight = |j: usize| {
                let angle = TAU * j as f64 / count;
                (0.25 + angle.cos() + 0.5 * (2.0 * angle).cos()) / count
            };
            (0..valence).map(weight).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::lattice::{is_inside, lattice, octahedron};
    use super::super::subdivide_midpoint;
    use super::*;
    use crate::mesh::{Facts, shapes, zoo};

    #[test]
    fn butterfly_subdivision_keeps_vertices_and_topology_and_commutes_with_affine_maps() {
        for mesh in zoo::all() {
            let shear = |p: &Point3<f64>| Point3::new(2.0 * p.x + p.y, p.y - 3.0, p.z + 0.5 * p.x);
            let moved =
                |m: &TriangleMesh| m.with_positions(m.positions().iter().map(shear).collect());
            let fine = subdivide_butterfly(&mesh, 2);
            fine.topology().sanity_check();
            assert_eq!(&fine.positions()[..mesh.vertex_count()], mesh.positions());
            let (before, after) = (Facts::measure(&mesh), Facts::measure(&fine));
            assert_eq!(
                (before.genus, before.boundary_loops),
                (after.genus, after.boundary_loops)
            );
            let second = subdivide_butterfly(&moved(&mesh), 2);
            for (a, b) in moved(&fine).positions().iter().zip(second.positions()) {
                assert!((a - b).norm() < 1e-13);
            }
        }
    }

    #[test]
    fn the_weights_of_extraordinary_vertices_sum_to_a_quarter_and_are_symmetric() {
        for valence in (3..20).filter(|&valence| valence != REGULAR) {
            let weights = extraordinary_weights(valence);
            assert_eq!(weights.len(), valence);
            assert!((weights.iter().sum::<f64>() - 0.25).abs() < 1e-15);
            // The first frequency has the weight that takes half a step along a plane.
            let along = |(j, w): (usize, &f64)| w * (TAU * j as f64 / valence as f64).cos();
            let step: f64 = weights.iter().enumerate().map(along).sum();
            assert!((step - 0.5).abs() < 1e-15, "{valence}: {step}");
            for j in 1..valence {
                assert!((weights[j] - weights[valence - j]).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn a_plane_stays_one_also_along_its_boundary() {
        let bumpy = zoo::with_boundary();
        let flat = |p: &Point3<f64>| Point3::new(p.x, p.y, 0.3 * p.x - 2.0 * p.y + 1.0);
        let mesh = bumpy.with_positions(bumpy.positions().iter().map(flat).collect());
        for p in subdivide_butterfly(&mesh, 3).positions() {
            assert!((flat(p) - p).norm() < 1e-14);
        }
        // On a lattice every edge is halved, also beside the boundary, but for its corners.
        let mesh = lattice(|x, y| x + y);
        let (planar, _) = subdivide_midpoint(&mesh, 1);
        let smooth = subdivide_butterfly(&mesh, 1);
        for (a, b) in planar.positions().iter().zip(smooth.positions()) {
            assert!(!is_inside(a, 1) || (a - b).norm() < 1e-13, "{a} {b}");
        }
    }

    #[test]
    fn a_lattice_reproduces_cubic_polynomials_inside_and_no_quartic() {
        let cubic = |x: f64, y: f64| {
            let (x, y) = (x / 5.0, y / 5.0);
            x * x * x - 2.0 * x * x * y + 0.5 * x * y * y + 3.0 * y * y * y - x * y + y - 4.0
        };
        let error = |f: &dyn Fn(f64, f64) -> f64| {
            let fine = subdivide_butterfly(&lattice(f), 2);
            let inside = fine.positions().iter().filter(|p| is_inside(p, 3));
            inside
                .map(|p| (p.z - f(p.x, p.y)).abs())
                .fold(0.0, f64::max)
        };
        assert!(error(&cubic) < 1e-12, "{}", error(&cubic));
        assert!(error(&|x, _| (x / 5.0).powi(4)) > 1e-4);
    }

    #[test]
    fn vertices_of_an_octahedron_are_known() {
        // Both ends have valence 4: each stencil takes 3/4 of one end, 3/8 of the other and -1/8 of
        // the point opposite to that.
        let fine = subdivide_butterfly(&octahedron(), 1);
        assert!((fine.positions()[6] - Point3::new(0.625, 0.625, 0.0)).norm() < 1e-15);
    }

    #[test]
    fn on_a_lattice_the_error_falls_with_the_fourth_power_of_the_edge_length() {
        let error = |step: f64| {
            // Even around a point inside, where its fourth derivative is largest.
            let f = |x: f64, y: f64| (step * (x - 8.0 + 0.5 * (y - 4.5))).cos();
            let fine = subdivide_butterfly(&lattice(f), 1);
            let inside = fine.positions().iter().filter(|p| is_inside(p, 2));
            inside
                .map(|p| (p.z - f(p.x, p.y)).abs())
                .fold(0.0, f64::max)
        };
        let order = (error(0.2) / error(0.1)).log2();
        assert!((order - 4.0).abs() < 0.1, "{order}");
    }

    #[test]
    fn a_sphere_stays_rounder_than_its_planar_subdivision() {
        let mesh = shapes::sphere(642);
        let error = |fine: &TriangleMesh| {
            let radius = |p: &Point3<f64>| (p.coords.norm() - 1.0).abs();
            fine.positions().iter().map(radius).fold(0.0, f64::max)
        };
        let smooth = subdivide_butterfly(&mesh, 3);
        let facts = Facts::measure(&smooth);
        assert_eq!((facts.genus, facts.boundary_loops), (Some(0), 0));
        let (planar, _) = subdivide_midpoint(&mesh, 3);
        // The lattice of a geodesic sphere has kinks, which take some of the order.
        assert!(error(&smooth) < 0.1 * error(&planar));
    }

    #[test]
    fn a_single_triangle_and_valences_three_and_five_are_subdivided() {
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Point3::from);
        let mesh = TriangleMesh::build(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
        let fine = subdivide_butterfly(&mesh, 3);
        assert_eq!(fine.face_count(), 64);
        assert!(fine.positions().iter().all(|p| p.z == 0.0));
        // Around each end of an edge of a tetrahedron: 5/12 of the other end, -1/12 of both others.
        let corners = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]];
        let corners = corners.map(|p| Point3::from(p.map(f64::from)));
        let faces = vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
        let fine = TriangleMesh::build(corners.to_vec(), faces).unwrap();
        let fine = subdivide_butterfly(&fine, 1);
        let expected = Point3::new(4.0 / 3.0, 0.0, 0.0);
        assert!((fine.positions()[4] - expected).norm() < 1e-15);
        let round = subdivide_butterfly(&shapes::sphere(12), 3);
        assert_eq!(round.vertex_count(), 10 * 64 + 2);
    }
}
