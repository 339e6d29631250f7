//! One tetrahedron: its faces, edges, volume and angles.
//!
//! # Notation
//! Corners `0 1 2 3` are positively oriented: seen from corner 3, corners 0, 1, 2 run clockwise, and
//! `(p1 - p0) . ((p2 - p0) x (p3 - p0)) > 0`.

use nalgebra::Point3;

/// Corners of the face opposite to each corner, counter-clockwise as seen from outside.
pub const CELL_FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// Corners of each edge. Edges `e` and `5 - e` are opposite.
pub const CELL_EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// Returns the volume of a tetrahedron, negative if it is inverted, with the error of rounding.
#[must_use]
pub fn signed_volume([a, b, c, d]: &[Point3<f64>; 4]) -> f64 {
    (b - a).dot(&(c - a).cross(&(d - a))) / 6.0
}

/// Returns the dihedral angle at each edge of a tetrahedron in radians, in the order of
/// [`CELL_EDGES`]; those of an inverted one are the angles of its mirror image.
#[must_use]
pub fn dihedral_angles(corners: &[Point3<f64>; 4]) -> [f64; 6] {
    CELL_EDGES.map(|[i, j]| {
        let (k, l) = match (i, j) {
            (0, 1) => (2, 3),
            (0, 2) => (1, 3),
            (0, 3) => (1, 2),
            (1, 2) => (0, 3),
            (1, 3) => (0, 2),
            _ => (0, 1),
        };
        let axis = corners[j] - corners[i];
        let (u, v) = (
            axis.cross(&(corners[k] - corners[i])),
            axis.cross(&(corners[l] - corners[i])),
        );
        // The arc tangent keeps the digits of small angles, which the arc cosine loses.
        u.cross(&v).norm().atan2(u.dot(&v))
    })
}
