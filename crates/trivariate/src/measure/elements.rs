//! The 24 tetrahedra of a cell.

use robust::{Coord3D, orient3d};

/// Share of the product of the edges below which a determinant is computed exactly: far above the
/// rounding of its few products.
const DOUBTFUL: f64 = 1e-13;

/// Corners of the elements of a cell in units of half cells: cell centre, face centre, and two
/// neighbouring corners of the face, counterclockwise seen from outside.
const ELEMENTS: [[[usize; 3]; 4]; 24] = elements();

const fn elements() -> [[[usize; 3]; 4]; 24] {
    let around = [[0, 0], [2, 0], [2, 2], [0, 2]];
    let mut out = [[[1; 3]; 4]; 24];
    let mut at = 0;
    while at < 24 {
        let (axis, end, corner) = (at / 8, at / 4 % 2, at % 4);
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let (mut from, mut to) = (around[corner], around[(corner + 1) % 4]);
        if end == 0 {
            (from, to) = (to, from);
        }
        out[at][1][axis] = 2 * end;
        out[at][2] = [2 * end; 3];
        out[at][2][a] = from[0];
        out[at][2][b] = from[1];
        out[at][3] = [2 * end; 3];
        out[at][3][a] = to[0];
        out[at][3][b] = to[1];
        at += 1;
    }
    out
}

/// Places of the corners of the elements of a cell in a grid of `2 cells + 1` points in each direction.
pub(crate) struct Places([[usize; 4]; 24]);

impl Places {
    /// The places of the first cell.
    pub(crate) fn build(cells: usize) -> Self {
        let size = 2 * cells + 1;
        Self(ELEMENTS.map(|element| element.map(|[i, j, k]| i + size * (j + size * k))))
    }

    /// Those of cell `(i, j, k)`, the first index of which varies fastest.
    pub(crate) fn of_cell(&self, cells: usize, cell: usize) -> impl Iterator<Item = [usize; 4]> {
        let (i, j, k) = (cell % cells, cell / cells % cells, cell / (cells * cells));
        let size = 2 * cells + 1;
        let start = 2 * (i + size * (j + size * k));
        self.0
            .iter()
            .map(move |[a, b, c, d]| [start + a, start + b, start + c, start + d])
    }
}

/// Six times the signed volume, rounded.
#[inline]
pub(crate) fn determinant(points: &[[f64; 3]; 4]) -> f64 {
    let [o, p, q, r] = points;
    let a = [p[0] - o[0], p[1] - o[1], p[2] - o[2]];
    let b = [q[0] - o[0], q[1] - o[1], q[2] - o[2]];
    let c = [r[0] - o[0], r[1] - o[1], r[2] - o[2]];
    a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// Whether the signed volume is not positive, exactly.
#[inline]
pub(crate) fn is_degenerate(points: &[[f64; 3]; 4]) -> bool {
    let rough = determinant(points);
    let [o, p, q, r] = points;
    let length = |p: &[f64; 3]| (p[0] - o[0]).abs() + (p[1] - o[1]).abs() + (p[2] - o[2]).abs();
    let doubt = DOUBTFUL * length(p) * length(q) * length(r);
    if rough > doubt && rough > f64::MIN_POSITIVE {
        return false;
    }
    let [d, a, b, c] = points.map(|[x, y, z]| Coord3D { x, y, z });
    // Not a number is degenerate too.
    let exact = orient3d(a, b, c, d);
    exact <= 0.0 || exact.is_nan()
}
