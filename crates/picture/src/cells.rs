//! The skin of a volume of cells, and of what is left when some are taken away.
//!
//! ```
//! use msplines_picture::cells::{cut_hexahedra, HalfSpace};
//! use nalgebra::{Point3, Vector3};
//!
//! let corner = |i: usize| Point3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
//! let points: Vec<_> = (0..8).map(corner).collect();
//! let upper = HalfSpace { point: Point3::new(0.5, 0.5, 0.9), normal: Vector3::z() };
//! let cells = [[0, 1, 3, 2, 4, 5, 7, 6]];
//! let skin = cut_hexahedra(&cells, |cell| !upper.holds_centre(&points, &cells[cell]));
//! assert_eq!(skin.outer.triangles.len(), 12);
//! ```

use nalgebra::{Point3, Vector3};

/// Faces that are seen, for surfaces and for the lines between them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Faces {
    /// Triangles, counter-clockwise from outside; a quadrangle gives two.
    pub triangles: Vec<[u32; 3]>,
    /// Sides of the faces, each once, without the diagonals of quadrangles.
    pub edges: Vec<[u32; 2]>,
}

/// The skin of the cells that are left, by where it comes from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Skin {
    /// Faces that were on the outside of the whole volume.
    pub outer: Faces,
    /// Faces that were inside and are laid open by the cut.
    pub fresh: Faces,
}

/// One side of a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// A point of the plane.
    pub point: Point3<f64>,
    /// Direction, of any length, in which the half-space extends.
    pub normal: Vector3<f64>,
}

impl HalfSpace {
    /// Returns whether the mean of a cell's corners lies inside; a cell whose indices have no
    /// points does not.
    ///
    /// A slab is what two half-spaces with opposite normals hold.
    #[must_use]
    pub fn holds_centre(&self, points: &[Point3<f64>], cell: &[u32]) -> bool {
        let mut sum = Vector3::zeros();
        for &vertex in cell {
            let Some(point) = points.get(vertex as usize) else {
                return false;
            };
            sum += point - self.point;
        }
        sum.dot(&self.normal) > 0.0
    }
}

/// Corners of the faces of a hexahedron, counter-clockwise from outside.
///
/// The first four corners run counter-clockwise about the bottom seen from above, the others lie
/// above them, as in VTK.
const HEXAHEDRON: [[usize; 4]; 6] = [
    [0, 3, 2, 1],
    [4, 5, 6, 7],
    [0, 1, 5, 4],
    [1, 2, 6, 5],
    [2, 3, 7, 6],
    [3, 0, 4, 7],
];

/// Corners of the faces of a tetrahedron, counter-clockwise from outside if the last corner is
/// above the first three, which run counter-clockwise seen from above.
const TETRAHEDRON: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

/// Returns the skin of the hexahedra for which `is_kept` holds; it is asked by number.
///
/// Corners are ordered as in VTK: counter-clockwise about the bottom, then about the top. Costs a
/// sort of all faces.
pub fn cut_hexahedra(cells: &[[u32; 8]], is_kept: impl Fn(usize) -> bool) -> Skin {
    let faces = |cell: usize| HEXAHEDRON.map(|face| face.map(|corner| cells[cell][corner]));
    skin(cells.len(), is_kept, faces)
}

/// Returns the skin of the tetrahedra for which `is_kept` holds; it is asked by number.
///
/// Seen from the last corner the first three run clockwise when looked at from below, as in VTK.
/// Costs a sort of all faces.
pub fn cut_tetrahedra(cells: &[[u32; 4]], is_kept: impl Fn(usize) -> bool) -> Skin {
    let faces = |cell: usize| TETRAHEDRON.map(|face| face.map(|corner| cells[cell][corner]));
    skin(cells.len(), is_kept, faces)
}

/// A face of a cell with its corners sorted, by which the face of the neighbour is found.
struct Side<const N: usize> {
    sorted: [u32; N],
    corners: [u32; N],
    kept: bool,
}

fn skin<const N: usize, const F: usize>(
    cells: usize,
    is_kept: impl Fn(usize) -> bool,
    faces: impl Fn(usize) -> [[u32; N]; F],
) -> Skin {
    let mut sides = Vec::with_capacity(cells * F);
    for cell in 0..cells {
        let kept = is_kept(cell);
        for corners in faces(cell) {
            let mut sorted = corners;
            sorted.sort_unstable();
            sides.push(Side {
                sorted,
                corners,
                kept,
            });
        }
    }
    // Stable, so that the order of the cells decides between equals.
    sides.sort_by_key(|side| side.sorted);
    let [mut outer, mut fresh] = [Vec::new(), Vec::new()];
    for pair in sides.chunk_by(|a, b| a.sorted == b.sorted) {
        let mut kept = pair.iter().filter(|side| side.kept);
        // Between two cells that are left nothing is seen.
        if let (Some(side), None) = (kept.next(), kept.next()) {
            if pair.len() == 1 {
                outer.push(side.corners);
            } else {
                fresh.push(side.corners);
            }
        }
    }
    Skin {
        outer: collect(&outer),
        fresh: collect(&fresh),
    }
}

fn collect<const N: usize>(faces: &[[u32; N]]) -> Faces {
    let fan = |face: &[u32; N]| {
        let face = *face;
        (2..N).map(move |i| [face[0], face[i - 1], face[i]])
    };
    let ring = |face: &[u32; N]| {
        let face = *face;
        (0..N).map(move |i| [face[i], face[(i + 1) % N]])
    };
    let sides = faces.iter().flat_map(ring);
    let mut edges: Vec<_> = sides.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    edges.sort_unstable();
    edges.dedup();
    Faces {
        triangles: faces.iter().flat_map(fan).collect(),
        edges,
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Point3, Vector3};

    use super::{Faces, HalfSpace, cut_hexahedra, cut_tetrahedra};

    /// Returns the corners and cells of a block of n x n x n unit cubes.
    fn block(n: u32) -> (Vec<Point3<f64>>, Vec<[u32; 8]>) {
        let m = n + 1;
        let grid = |n: u32| (0..n * n * n).map(move |i| [i % n, i / n % n, i / n / n]);
        let points = grid(m).map(|p| Point3::from(p.map(f64::from))).collect();
        let at = |x: u32, y: u32, z: u32| x + m * (y + m * z);
        let ring = [[0, 0], [1, 0], [1, 1], [0, 1]];
        let cells = grid(n).map(|[x, y, z]| {
            std::array::from_fn(|i| at(x + ring[i % 4][0], y + ring[i % 4][1], z + i as u32 / 4))
        });
        (points, cells.collect())
    }

    /// Returns six times the volume inside of closed faces.
    fn volume(points: &[Point3<f64>], faces: &[&Faces]) -> f64 {
        let triangles = faces.iter().flat_map(|faces| &faces.triangles);
        let corners = triangles.map(|face| face.map(|vertex| points[vertex as usize].coords));
        corners.map(|[a, b, c]| a.dot(&b.cross(&c))).sum()
    }

    #[test]
    fn a_block_without_its_middle_slab_has_the_counted_faces() {
        let (points, cells) = block(3);
        let whole = cut_hexahedra(&cells, |_| true);
        assert_eq!(whole.outer.triangles.len(), 2 * 54);
        assert_eq!(whole.outer.edges.len(), 108);
        assert_eq!(whole.fresh, Faces::default());
        let above = HalfSpace {
            point: Point3::new(0.0, 0.0, 1.0),
            normal: Vector3::z(),
        };
        let below = HalfSpace {
            point: Point3::new(0.0, 0.0, 2.0),
            normal: -Vector3::z(),
        };
        let gone = |cell: usize| {
            above.holds_centre(&points, &cells[cell]) && below.holds_centre(&points, &cells[cell])
        };
        let cut = cut_hexahedra(&cells, |cell| !gone(cell));
        // Bottom and top of nine faces and two rings of twelve; the cut opens nine on each side.
        assert_eq!(cut.outer.triangles.len(), 2 * (9 + 9 + 24));
        assert_eq!(cut.fresh.triangles.len(), 2 * 18);
        assert_eq!(cut.fresh.edges.len(), 2 * 24);
        assert!((volume(&points, &[&cut.outer, &cut.fresh]) - 6.0 * 18.0).abs() < 1e-9);
    }

    #[test]
    fn tetrahedra_have_their_faces_outwards() {
        let corners = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 1.0, 1.0],
        ];
        let points = corners.map(Point3::from);
        let cells = [[0, 1, 2, 3], [1, 2, 3, 4]];
        let one = cut_tetrahedra(&cells, |cell| cell == 0);
        assert_eq!(
            (one.outer.triangles.len(), one.fresh.triangles.len()),
            (3, 1)
        );
        assert!((volume(&points, &[&one.outer, &one.fresh]) - 1.0).abs() < 1e-12);
        let both = cut_tetrahedra(&cells, |_| true);
        assert_eq!(both.outer.triangles.len(), 6);
        assert!(volume(&points, &[&both.outer]) > 1.0);
    }

    #[test]
    fn no_cells_and_wrong_indices_do_no_harm() {
        assert_eq!(cut_hexahedra(&[], |_| true), super::Skin::default());
        let space = HalfSpace {
            point: Point3::origin(),
            normal: Vector3::x(),
        };
        assert!(!space.holds_centre(&[], &[7]));
        assert_eq!(
            cut_tetrahedra(&[[9, 9, 9, 9]], |_| false),
            super::Skin::default()
        );
    }
}
