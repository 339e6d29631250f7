//! Subdivision of triangle meshes: planar, by Loop's scheme, and by the modified butterfly scheme.
//!
//! All cut every face `f` into four: face `4 f + i` keeps corner `i` of `f` as its first corner,
//! face `4 f + 3` lies in the middle and starts at the midpoint of the first side. Vertices keep
//! their ids; after them come the new ones, in order of edges.

mod butterfly;
mod loop_scheme;
mod midpoint;

#[cfg(test)]
mod lattice;

use nalgebra::Point3;

pub use butterfly::subdivide_butterfly;
pub use loop_scheme::subdivide_loop;
pub use midpoint::{SubdivisionMap, subdivide_midpoint};

use super::topology::Topology;
use super::triangle::TriangleMesh;

/// Returns the pieces of the edges of a mesh on its subdivision, as pairs of vertices.
///
/// `fine` are the faces after `rounds` of any scheme; every edge has `2^rounds` pieces, which
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

/// Returns the mesh of four faces for each one, whose vertices have these positions.
fn cut(topology: &Topology, positions: Vec<Point3<f64>>) -> TriangleMesh {
    let first = topology.vertex_count() as u32;
    let mut faces = Vec::with_capacity(4 * topology.face_count());
    for (face, &[a, b, c]) in topology.faces().iter().enumerate() {
        let [ab, bc, ca] = [0, 1, 2].map(|i| first + topology.edge(3 * face as u32 + i));
        faces.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    TriangleMesh::build(positions, faces)
        .expect("a manifold stays one if each two faces share one side, within 32-bit ids")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

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
}
