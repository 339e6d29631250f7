//! Graphs over small Delaunay triangulations of the plane.

use msplines_common::Point3;
use msplines_common::mesh::TriangleMesh;
use msplines_powell_sabin::FlatDomain;

/// Corners of the plate and points inside of it, far enough from a grid that no two faces are alike.
const PLATE: [[f64; 2]; 12] = [
    [0.0, 0.3],
    [0.9, 0.0],
    [2.1, 0.1],
    [3.0, 0.7],
    [2.9, 1.8],
    [1.9, 2.3],
    [0.7, 2.2],
    [0.1, 1.4],
    [1.0, 0.9],
    [2.0, 0.8],
    [1.5, 1.6],
    [2.3, 1.5],
];

/// Vertices along the sides of the hill.
const SIDES: [usize; 2] = [8, 6];
/// Sides of the rectangle below it.
const EXTENT: [f64; 2] = [4.0, 3.0];
/// By how much rows inside are shifted, and their points beyond, over the spacing.
const SHIFT: f64 = 0.22;
const JITTER: f64 = 0.15;

/// Returns a flat plate.
pub(super) fn plate() -> TriangleMesh {
    over(&PLATE, |_| 0.0)
}

/// Returns a hill with a hollow beside it.
pub(super) fn hill() -> TriangleMesh {
    let [columns, rows] = SIDES;
    let is_inside = |i: usize, count: usize| i > 0 && i + 1 < count;
    let point = |row: usize, column: usize| {
        let seed = (row * columns + column) as f64;
        // Rows inside are shifted against each other, and their points a little besides.
        let side = if row.is_multiple_of(2) { -SHIFT } else { SHIFT };
        let off = if is_inside(row, rows) && is_inside(column, columns) {
            [
                side + JITTER * (13.0 * seed).sin(),
                JITTER * (79.0 * seed).sin(),
            ]
        } else {
            [0.0; 2]
        };
        [
            EXTENT[0] * (column as f64 + off[0]) / (columns - 1) as f64,
            EXTENT[1] * (row as f64 + off[1]) / (rows - 1) as f64,
        ]
    };
    let rows = 0..rows;
    let points: Vec<[f64; 2]> = rows
        .flat_map(|row| (0..columns).map(move |column| (row, column)))
        .map(|(row, column)| point(row, column))
        .collect();
    over(&points, |[x, y]| {
        let bump = |cx: f64, cy: f64, width: f64| {
            (-((x - cx).powi(2) + (y - cy).powi(2)) / (width * width)).exp()
        };
        1.3 * bump(1.7, 1.4, 0.9) - 0.5 * bump(3.2, 1.9, 0.7)
    })
}

/// Returns the graph of a function over the Delaunay triangulation of points in the plane.
fn over(points: &[[f64; 2]], height: impl Fn([f64; 2]) -> f64) -> TriangleMesh {
    let flat = FlatDomain::planar(points).expect("distinct points that are on no line");
    let lifted = points
        .iter()
        .map(|&[x, y]| Point3::new(x, y, height([x, y])));
    flat.mesh().with_positions(lifted.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plate_and_hill_are_disks_over_the_plane() {
        for mesh in [plate(), hill()] {
            assert_eq!(mesh.topology().euler_characteristic(), 1);
            assert_eq!(mesh.topology().boundary_loops().len(), 1);
            for face in 0..mesh.face_count() as u32 {
                assert!(mesh.face_normal(face).z > 0.0);
            }
        }
        assert_eq!((plate().vertex_count(), hill().vertex_count()), (12, 48));
    }
}
