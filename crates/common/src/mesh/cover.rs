//! The double cover of a surface with boundary.

use super::topology::TopologyError;
use super::triangle::TriangleMesh;

/// Returns two copies of a surface, the second one turned over, glued along their boundary, and the
/// vertex of the second copy that lies on each vertex.
///
/// Vertices and faces of the first copy keep their ids. A closed surface has no boundary to be glued
/// along, and gives two components.
///
/// # Errors
/// An inner edge that joins two boundary vertices: its two copies would be one edge of four faces.
pub fn double_cover(mesh: &TriangleMesh) -> Result<(TriangleMesh, Vec<u32>), TopologyError> {
    let topology = mesh.topology();
    let mut positions = mesh.positions().to_vec();
    let mut copies = Vec::with_capacity(mesh.vertex_count());
    for vertex in 0..mesh.vertex_count() as u32 {
        if topology.is_boundary_vertex(vertex) {
            copies.push(vertex);
        } else {
            copies.push(positions.len() as u32);
            positions.push(mesh.positions()[vertex as usize]);
        }
    }
    let turned = |&[a, b, c]: &[u32; 3]| [a, c, b].map(|v| copies[v as usize]);
    let mut faces = mesh.faces().to_vec();
    faces.extend(mesh.faces().iter().map(turned));
    Ok((TriangleMesh::build(positions, faces)?, copies))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Facts, zoo};

    #[test]
    fn a_cover_is_closed_and_twice_as_large() {
        let mesh = zoo::with_two_boundaries();
        let (cover, copies) = double_cover(&mesh).expect("a cover");
        let (half, whole) = (Facts::measure(&mesh), Facts::measure(&cover));
        assert_eq!(whole.boundary_loops, 0);
        assert_eq!(whole.genus, Some(1));
        assert!((whole.area / half.area - 2.0).abs() < 1e-12);
        for (v, &copy) in copies.iter().enumerate() {
            assert_eq!(cover.positions()[v], cover.positions()[copy as usize]);
        }
    }
}
