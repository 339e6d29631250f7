//! Laws of the way from a soup to a mesh.

use msplines_common::mesh::polygon::PolygonMesh;
use msplines_common::mesh::{Policy, PolygonSoup, accept, preflight};
use nalgebra::Point3;

/// Ends a face.
const END: u8 = 255;

/// Holds acceptance and repair to their laws, on points of a coarse lattice.
///
/// The first byte is the number of points, a byte each gives their places, and all others are corners.
pub fn soup(bytes: &[u8]) {
    let Some((&count, rest)) = bytes.split_first() else {
        return;
    };
    let count = usize::from(count % 32).min(rest.len());
    let (places, corners) = rest.split_at(count);
    let digits = |b: u8| [b % 6, b / 6 % 6, b / 36].map(f64::from);
    let mut soup = PolygonSoup {
        positions: places.iter().map(|&b| Point3::from(digits(b))).collect(),
        ..PolygonSoup::default()
    };
    for face in corners.split(|&b| b == END) {
        // Some name a vertex before the first or after the last one.
        soup.push_face(face.iter().map(|&v| i64::from(v % 34) - 1));
    }
    let clean = preflight(&soup).defects.is_empty();
    if let Ok(accepted) = accept(&soup, Policy::Refuse) {
        assert!(clean);
        accepted.mesh.topology().sanity_check();
    }
    if let Ok(control) = PolygonMesh::accept(&soup) {
        assert_eq!(control.vertex_count(), count);
    }
    if let Ok(accepted) = accept(&soup, Policy::Repair) {
        let mesh = &accepted.mesh;
        mesh.topology().sanity_check();
        let again = PolygonSoup::from_triangles(mesh.positions().to_vec(), mesh.faces());
        assert_eq!(preflight(&again).defects, Vec::new());
    }
}
