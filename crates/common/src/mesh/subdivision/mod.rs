//! Subdivision of triangle meshes: planar, and by Loop's scheme.
//!
//! Both cut every face `f` into four: face `4 f + i` keeps corner `i` of `f` as its first corner,
//! face `4 f + 3` lies in the middle and starts at the midpoint of the first side. Vertices keep
//! their ids; after them come the new ones, in order of edges.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};

use super::topology::Topology;
use super::triangle::{SurfacePoint, TriangleMesh};

/// Where the vertices of a subdivided mesh lie on the mesh it came from.
#[derive(Clone, Debug, PartialEq)]
pub struct SubdivisionMap {
    /// Point of the original mesh for each vertex; the original vertices come first.
    pub points: Vec<SurfacePoint>,
    /// Number of rounds.
    pub rounds: u32,
}

impl SubdivisionMap {
    /// Returns the face of the original mesh in which a face of the subdivided one lies.
    #[must_use]
    pub fn ancestor(&self, face: u32) -> u32 {
        face >> (2 * self.rounds)
    }
}

/// Returns the mesh with each face cut into `4^rounds` congruent ones, and where its vertices lie
/// on the original mesh. The surface stays the same.
///
/// # Panics
/// If there are more half-edges than 32-bit ids.
#[must_use]
pub fn subdivide_midpoint(mesh: &TriangleMesh, rounds: u32) -> (TriangleMesh, SubdivisionMap) {
    let mut current = mesh.clone();
    let mut points: Vec<SurfacePoint> = (0..mesh.vertex_count() as u32)
        .map(|v| corner(mesh.topology(), v))
        .collect();
    for round in 0..rounds {
        let topology = current.topology();
        for edge in 0..topology.edge_count() as u32 {
            let half_edge = topology.edge_half_edge(edge);
            let mut at = [0.5; 3];
            at[(Topology::previous(half_edge) % 3) as usize] = 0.0;
            points.push(ascend(
                SurfacePoint {
                    face: half_edge / 3,
                    at,
                },
                round,
            ));
        }
        let mut positions = current.positions().to_vec();
        let middle = |edge: u32| {
            let [a, b] = topology
                .edge_vertices(edge)
                .map(|v| current.positions()[v as usize]);
            a + (b - a) * 0.5
        };
        positions.extend((0..topology.edge_count() as u32).map(middle));
        current = cut(topology, positions);
    }
    (current, SubdivisionMap { points, rounds })
}

/// Returns the pieces of the edges of a mesh on its subdivision, as pairs of vertices.
///
/// `fine` are the faces after `rounds` of either scheme; every edge has `2^rounds` pieces, which
/// stand one after another, in the order of [`Topology::edge_half_edge`].
///
/// # Panics
/// If `fine` has not `4^rounds` faces per face.
#[must_use]
pub fn edge_pieces(topology: &Topology, fine: &[[u32; 3]], rounds: u32) -> Vec<[u32; 2]> {
    assert_eq!(
        fine.len(),
        topology.face_count() << (2 * rounds),
        "faces of another subdivision"
    );
    let edges = 0..topology.edge_count() as u32;
    let mut halves: Vec<u32> = edges.map(|edge| topology.edge_half_edge(edge)).collect();
    for _ in 0..rounds {
        // Side i of face f runs along the first side of child i and the last one of child i + 1.
        let cut = |half_edge: &u32| {
            let (face, side) = (half_edge / 3, half_edge % 3);
            [3 * (4 * face + side), 3 * (4 * face + (side + 1) % 3) + 2]
        };
        halves = halves.iter().flat_map(cut).collect();
    }
    let ends = |half_edge: u32| {
        let (face, side) = (fine[(half_edge / 3) as usize], (half_edge % 3) as usize);
        [face[side], face[(side + 1) % 3]]
    };
    halves.into_iter().map(ends).collect()
}

/// Returns the mesh after `rounds` of Loop subdivision; a boundary becomes a cubic B-spline curve
/// that depends on the boundary alone.
///
/// # Reference
/// [Loop1987] vertex and edge masks. Deviation: boundaries follow the cubic B-spline masks.
///
/// # Panics
/// If there are more half-edges than 32-bit ids.
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
    if twin == super::NONE {
        return middle;
    }
    let apex = |h: u32| old[topology.origin(Topology::previous(h)) as usize];
    middle + ((apex(half_edge) - middle) + (apex(twin) - middle)) * 0.125
}

/// Returns some face corner at a vertex.
fn corner(topology: &Topology, vertex: u32) -> SurfacePoint {
    let half_edge = topology.vertex_half_edge(vertex);
    let mut at = [0.0; 3];
    at[(half_edge % 3) as usize] = 1.0;
    SurfacePoint {
        face: half_edge / 3,
        at,
    }
}

/// Returns a point of a mesh subdivided `rounds` times as a point of the original mesh. Exact:
/// the weights are dyadic.
fn ascend(point: SurfacePoint, rounds: u32) -> SurfacePoint {
    (0..rounds).fold(point, |SurfacePoint { face, at }, _| {
        // Corners of the child in the parent: corner i and the midpoints beside it, in order.
        let middle = |i: usize| {
            let mut weights = [0.5; 3];
            weights[(i + 2) % 3] = 0.0;
            weights
        };
        let corners = match (face % 4) as usize {
            3 => [middle(0), middle(1), middle(2)],
            i => {
                let mut own = [0.0; 3];
                own[i] = 1.0;
                [own, middle(i), middle((i + 2) % 3)]
            }
        };
        let sum = |k: usize| (0..3).map(|j| at[j] * corners[j][k]).sum();
        SurfacePoint {
            face: face / 4,
            at: std::array::from_fn(sum),
        }
    })
}

fn cut(topology: &Topology, positions: Vec<Point3<f64>>) -> TriangleMesh {
    let first = topology.vertex_count() as u32;
    let mut faces = Vec::with_capacity(4 * topology.face_count());
    for (face, &[a, b, c]) in topology.faces().iter().enumerate() {
        let [ab, bc, ca] = [0, 1, 2].map(|i| first + topology.edge(3 * face as u32 + i));
        faces.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    TriangleMesh::build(positions, faces).expect("a manifold stays one, within 32-bit ids")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Facts, shapes, zoo};

    #[test]
    fn the_pieces_of_an_edge_join_its_ends_in_a_straight_line() {
        let mesh = shapes::torus(2.0, 1.0, 60);
        let (fine, _) = subdivide_midpoint(&mesh, 2);
        let pieces = edge_pieces(mesh.topology(), fine.faces(), 2);
        assert_eq!(pieces.len(), 4 * mesh.topology().edge_count());
        for (edge, pieces) in pieces.chunks(4).enumerate() {
            let ends = mesh.topology().edge_vertices(edge as u32);
            assert_eq!([pieces[0][0], pieces[3][1]], ends);
            assert!(pieces.windows(2).all(|pair| pair[0][1] == pair[1][0]));
            let [a, b] = ends.map(|v| fine.positions()[v as usize]);
            for (index, piece) in pieces.iter().enumerate() {
                let expected = a + (b - a) * (index as f64 / 4.0);
                let found = fine.positions()[piece[0] as usize];
                assert!((found - expected).norm() < 1e-12);
            }
        }
    }

    #[test]
    fn planar_subdivision_keeps_surface_ids_and_topology() {
        for mesh in zoo::all() {
            let (fine, map) = subdivide_midpoint(&mesh, 2);
            let (before, after) = (Facts::measure(&mesh), Facts::measure(&fine));
            fine.topology().sanity_check();
            assert_eq!(after.genus, before.genus);
            assert_eq!(after.boundary_loops, before.boundary_loops);
            assert!((after.area / before.area - 1.0).abs() < 1e-12);
            assert_eq!(&fine.positions()[..mesh.vertex_count()], mesh.positions());
            for (point, position) in map.points.iter().zip(fine.positions()) {
                assert!((mesh.position(*point) - position).norm() < 1e-14);
            }
            for face in 0..fine.face_count() as u32 {
                let parent = mesh.face_normal(map.ancestor(face));
                assert!((fine.face_normal(face) * 16.0 - parent).norm() < 1e-12);
            }
        }
    }

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
        let n = 8u32;
        let place = |i: u32| {
            let (x, y) = (f64::from(i % n), f64::from(i / n));
            Point3::new(x + 0.5 * y, 0.75f64.sqrt() * y, 3.0 * x - y)
        };
        let mut faces = Vec::new();
        for a in (0..n * (n - 1)).filter(|i| i % n < n - 1) {
            faces.extend([[a, a + 1, a + n], [a + 1, a + n + 1, a + n]]);
        }
        let mesh = TriangleMesh::build((0..n * n).map(place).collect(), faces).unwrap();
        let (planar, _) = subdivide_midpoint(&mesh, 1);
        let smooth = subdivide_loop(&mesh, 1);
        for (a, b) in planar.positions().iter().zip(smooth.positions()) {
            let (y, x) = (a.y / 0.75f64.sqrt(), a.x - 0.5 * a.y / 0.75f64.sqrt());
            if (1.0..=6.0).contains(&x) && (1.0..=6.0).contains(&y) {
                assert!((a - b).norm() < 1e-14, "{a} {b}");
            }
        }
    }

    #[test]
    fn loop_subdivision_of_an_octahedron_is_known() {
        // Valence 4: inner = 3/8, weight (5/8 - 9/64) / 4 = 31/256; edges 3/8 + 3/8, 1/8 + 1/8.
        let x = [
            [1., 0., 0.],
            [0., 1., 0.],
            [-1., 0., 0.],
            [0., -1., 0.],
            [0., 0., 1.],
            [0., 0., -1.],
        ];
        let faces = [
            [0, 1, 4],
            [1, 2, 4],
            [2, 3, 4],
            [3, 0, 4],
            [1, 0, 5],
            [2, 1, 5],
            [3, 2, 5],
            [0, 3, 5],
        ];
        let mesh = TriangleMesh::build(x.map(Point3::from).to_vec(), faces.to_vec()).unwrap();
        let fine = subdivide_loop(&mesh, 1);
        assert!((fine.positions()[0].x - (1.0 - 4.0 * 31.0 / 256.0)).abs() < 1e-15);
        assert!((fine.positions()[6] - Point3::new(0.375, 0.375, 0.0)).norm() < 1e-15);
        let round = subdivide_loop(&shapes::sphere(12), 3);
        assert_eq!(round.vertex_count(), 10 * 64 + 2);
    }
}
