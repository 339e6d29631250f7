//! Planar subdivision: every edge is halved, and the surface stays.

use super::cut;
use crate::mesh::topology::Topology;
use crate::mesh::triangle::{SurfacePoint, TriangleMesh};

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
/// If there are more half-edges than 32-bit ids, or two faces with more than one side in common.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Facts, zoo};

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
}
