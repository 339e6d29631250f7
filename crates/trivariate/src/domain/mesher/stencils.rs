//! The part of one lattice tetrahedron that is inside.
//!
//! # Notation
//! `+`, `-` and `0` are corners inside, outside and on the boundary; a cut lies on every edge from
//! `+` to `-`. Where two tetrahedra share a face with corners `+ + -`, both must split the
//! quadrilateral of its two cuts alike: from the corner whose edge to `-` is the shorter one to the
//! cut on the longer one, and between equal ones from the corner of the lower number.

/// A corner of a lattice tetrahedron.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// Number of the lattice point.
    pub(super) point: u32,
    /// Whether its coordinates are odd: edges between points of one parity are long.
    pub(super) odd: bool,
    /// 1 inside, 0 on the boundary, -1 outside.
    pub(super) value: i8,
    /// Its vertex, if it is not outside.
    pub(super) vertex: u32,
}

/// At most three tetrahedra, whose union is the inside of a lattice tetrahedron.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pieces {
    cells: [[u32; 4]; 3],
    count: usize,
}

impl Pieces {
    fn of<const N: usize>(pieces: [[u32; 4]; N]) -> Self {
        let mut cells = [[0; 4]; 3];
        cells[..N].copy_from_slice(&pieces);
        Self { cells, count: N }
    }

    /// Returns the vertices of each.
    pub(super) fn cells(&self) -> &[[u32; 4]] {
        &self.cells[..self.count]
    }
}

/// Returns the pieces of a tetrahedron with at least one corner inside, in no particular
/// orientation. `cut` is the vertex of the cut between two corners, the first inside; `better` tells
/// whether the first of two sets of pieces has the better angles.
pub(super) fn pieces(
    corners: &[Corner; 4],
    cut: impl Fn(&Corner, &Corner) -> u32,
    better: impl Fn(&Pieces, &Pieces) -> bool,
) -> Pieces {
    let mut sorted = *corners;
    // Insides first, then the boundary, then outsides; between them the order does not matter.
    sorted.sort_by_key(|corner| -corner.value);
    let [a, b, c, d] = &sorted;
    let signs = sorted.map(|corner| corner.value);
    match signs {
        [1, 1, 1, -1] => {
            let diagonals = [diagonal(a, b, d), diagonal(b, c, d), diagonal(a, c, d)];
            let cuts = [cut(a, d), cut(b, d), cut(c, d)];
            // The rule is an order of the corners, so that one of them has both diagonals.
            prism([a.vertex, b.vertex, c.vertex], cuts, diagonals).unwrap_or_default()
        }
        [1, 1, 0, -1] => {
            let (p, q) = if diagonal(a, b, d) { (a, b) } else { (b, a) };
            let [from_p, from_q] = [cut(p, d), cut(q, d)];
            Pieces::of([
                [p.vertex, q.vertex, from_q, c.vertex],
                [p.vertex, from_q, from_p, c.vertex],
            ])
        }
        [1, 1, -1, -1] => {
            let first = [a.vertex, cut(a, c), cut(a, d)];
            let second = [b.vertex, cut(b, c), cut(b, d)];
            let with = |free| {
                let diagonals = [diagonal(a, b, c), free, diagonal(a, b, d)];
                prism(first, second, diagonals)
            };
            // The fourth side is on the boundary and may be split either way.
            match (with(true), with(false)) {
                (Some(one), Some(two)) if better(&one, &two) => one,
                (_, Some(two)) => two,
                (Some(one), None) => one,
                (None, None) => Pieces::default(),
            }
        }
        _ => {
            let vertex = |corner: &Corner| {
                if corner.value < 0 {
                    cut(a, corner)
                } else {
                    corner.vertex
                }
            };
            Pieces::of([[vertex(a), vertex(b), vertex(c), vertex(d)]])
        }
    }
}

/// Returns whether the quadrilateral between two corners inside and one outside is split from `a` to
/// the cut next to `b`, not from `b` to the cut next to `a`.
fn diagonal(a: &Corner, b: &Corner, outside: &Corner) -> bool {
    match (a.odd == outside.odd, b.odd == outside.odd) {
        (false, true) => true,
        (true, false) => false,
        _ => a.point < b.point,
    }
}

/// Returns the three tetrahedra of a prism between two triangles. Sides are split from the first
/// triangle at its corners 0, 1, 0 to the second at 1, 2, 2 where `diagonals` are true, else from
/// the second to the first; `None` if they run around in a ring.
fn prism(first: [u32; 3], second: [u32; 3], diagonals: [bool; 3]) -> Option<Pieces> {
    // An order of the corners in which each diagonal goes from an earlier corner of the first
    // triangle to a later one of the second.
    let [x, y, z] = match diagonals {
        [true, true, true] => [0, 1, 2],
        [true, false, true] => [0, 2, 1],
        [false, true, true] => [1, 0, 2],
        [false, true, false] => [1, 2, 0],
        [true, false, false] => [2, 0, 1],
        [false, false, false] => [2, 1, 0],
        [true, true, false] | [false, false, true] => return None,
    };
    Some(Pieces::of([
        [first[x], first[y], first[z], second[z]],
        [first[x], first[y], second[y], second[z]],
        [first[x], second[x], second[y], second[z]],
    ]))
}
