//! Tetrahedra, Delaunay meshes and self-intersections by CGAL.

use msplines_common::mesh::TriangleMesh;
use msplines_common::mesh::tet::Orientation;
use nalgebra::Point3;

use crate::{bindings, flat};

/// What CGAL finds on a tetrahedron by rational numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Volume, negative if it is inverted, rounded once.
    pub volume: f64,
    /// Dihedral angles in radians, in the order of `CELL_EDGES`.
    pub dihedral_angles: [f64; 6],
}

/// Delaunay tetrahedra of points.
#[derive(Clone, Debug)]
pub struct Delaunay {
    /// Corners of the tetrahedra.
    pub cells: Vec<[u32; 4]>,
    /// Volume of the points' convex hull.
    pub hull_volume: f64,
    /// Corners of the convex hull.
    pub hull_vertices: usize,
}

/// Returns CGAL's exact orientation of each tetrahedron.
#[must_use]
pub fn cgal_orientations(tetrahedra: &[[Point3<f64>; 4]]) -> Vec<Orientation> {
    let signs = bindings::cgal_orientations(&flat(tetrahedra.as_flattened()));
    let orientation = |sign: i8| match sign {
        1 => Orientation::Positive,
        0 => Orientation::Flat,
        _ => Orientation::Negative,
    };
    signs.into_iter().map(orientation).collect()
}

/// Returns CGAL's volume and dihedral angles of each tetrahedron.
#[must_use]
pub fn cgal_measured(tetrahedra: &[[Point3<f64>; 4]]) -> Vec<Measured> {
    let found = bindings::cgal_tetrahedra(&flat(tetrahedra.as_flattened()));
    let measured = |found: &bindings::Tetrahedron| Measured {
        volume: found.volume,
        // Its sign is that of the orientation.
        dihedral_angles: found.dihedral_degrees.map(|angle| angle.abs().to_radians()),
    };
    found.iter().map(measured).collect()
}

/// Returns CGAL's Delaunay tetrahedra of points, no two of which are equal.
#[must_use]
pub fn cgal_delaunay(points: &[Point3<f64>]) -> Delaunay {
    let found = bindings::cgal_delaunay(&flat(points));
    let (cells, _) = found.cells.as_chunks::<4>();
    Delaunay {
        cells: cells.to_vec(),
        hull_volume: found.hull_volume,
        hull_vertices: found.hull_vertices,
    }
}

/// Returns the pairs of faces that meet in CGAL's eyes where they should not, ascending.
///
/// # Panics
/// If CGAL does not take the mesh.
#[must_use]
pub fn cgal_self_intersections(mesh: &TriangleMesh) -> Vec<[u32; 2]> {
    let positions = flat(mesh.positions());
    let found = bindings::cgal_self_intersections(&positions, mesh.faces().as_flattened());
    let found = found.expect("CGAL takes the mesh");
    let (pairs, _) = found.as_chunks::<2>();
    let mut pairs: Vec<[u32; 2]> = pairs.iter().map(|&[a, b]| [a.min(b), a.max(b)]).collect();
    pairs.sort_unstable();
    pairs
}
