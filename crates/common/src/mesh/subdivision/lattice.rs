//! A regular lattice and an octahedron, on which it is known what schemes give.

use nalgebra::Point3;

use crate::mesh::triangle::TriangleMesh;

/// Number of lattice points in each direction.
pub(super) const COUNT: u32 = 12;

/// Returns `COUNT²` points of the lattice of equilateral triangles with this height over it.
pub(super) fn lattice(height: impl Fn(f64, f64) -> f64) -> TriangleMesh {
    let n = COUNT;
    let place = |i: u32| {
        let (column, row) = (f64::from(i % n), f64::from(i / n));
        let (x, y) = (column + 0.5 * row, 0.75f64.sqrt() * row);
        Point3::new(x, y, height(x, y))
    };
    let mut faces = Vec::new();
    for a in (0..n * (n - 1)).filter(|i| i % n < n - 1) {
        faces.extend([[a, a + 1, a + n], [a + 1, a + n + 1, a + n]]);
    }
    TriangleMesh::build((0..n * n).map(place).collect(), faces)
        .expect("a lattice is an oriented manifold")
}

/// Returns whether a point lies at least this many rings inside of the lattice.
pub(super) fn is_inside(point: &Point3<f64>, rings: u32) -> bool {
    let row = point.y / 0.75f64.sqrt();
    let range = f64::from(rings)..=f64::from(COUNT - 1 - rings);
    range.contains(&row) && range.contains(&(point.x - 0.5 * row))
}

/// Returns a regular octahedron, whose vertices have valence 4.
pub(super) fn octahedron() -> TriangleMesh {
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
    TriangleMesh::build(x.map(Point3::from).to_vec(), faces.to_vec()).unwrap()
}
