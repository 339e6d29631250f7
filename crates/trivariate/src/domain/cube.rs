//! The unit cube: its corners, edges and faces, and how they meet.
//!
//! # Notation
//! Bit `d` of a corner's number is its coordinate along axis `d`. Face `2 d + s` is where coordinate
//! `d` is `s`. A mask has bit `f` set where a point lies on face `f`: six bits, none inside.
//! Everything is seen from outside.

/// End corners of the edges: four along each axis, the lower corner first.
pub const EDGES: [[u8; 2]; 12] = [
    [0, 1],
    [2, 3],
    [4, 5],
    [6, 7],
    [0, 2],
    [1, 3],
    [4, 6],
    [5, 7],
    [0, 4],
    [1, 5],
    [2, 6],
    [3, 7],
];

/// Returns the coordinates of a corner.
#[must_use]
pub fn corner_position(corner: usize) -> [f64; 3] {
    std::array::from_fn(|axis| f64::from((corner >> axis & 1) as u8))
}

/// Returns the mask of the three faces of a corner.
#[must_use]
pub fn corner_mask(corner: usize) -> u8 {
    (0..3).fold(0, |mask, axis| {
        mask | 1 << (2 * axis + (corner >> axis & 1))
    })
}

/// Returns the mask of the two faces of an edge.
#[must_use]
pub fn edge_mask(edge: usize) -> u8 {
    let [a, b] = EDGES[edge].map(usize::from);
    corner_mask(a) & corner_mask(b)
}

/// Returns the edge between two corners, if there is one.
#[must_use]
pub fn edge_between(a: usize, b: usize) -> Option<usize> {
    let ends = [a.min(b), a.max(b)];
    EDGES.iter().position(|edge| edge.map(usize::from) == ends)
}

/// Returns the neighbours of a corner, counter-clockwise.
#[must_use]
pub fn corner_ring(corner: usize) -> [usize; 3] {
    // At the corner 0 the axes run clockwise; every reflection turns them around.
    let axes = if corner.count_ones().is_multiple_of(2) {
        [0, 2, 1]
    } else {
        [0, 1, 2]
    };
    axes.map(|axis| corner ^ 1 << axis)
}

/// Returns the two axes along a face, counter-clockwise.
#[must_use]
pub fn face_axes(face: usize) -> [usize; 2] {
    let axis = face / 2;
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    if face % 2 == 1 { [u, v] } else { [v, u] }
}

/// Returns the faces to the left and to the right of an edge, walking from its first corner.
#[must_use]
pub fn edge_sides(edge: usize) -> [usize; 2] {
    let [a, b] = EDGES[edge].map(usize::from);
    // Counter-clockwise from the edge, the next one bounds the face on the left.
    let ring = corner_ring(a);
    let at = ring.iter().position(|&other| other == b).unwrap_or(0);
    let side = |next: usize| {
        let shared = corner_mask(a) & corner_mask(b) & corner_mask(next);
        shared.trailing_zeros() as usize
    };
    [side(ring[(at + 1) % 3]), side(ring[(at + 2) % 3])]
}

/// Returns which coordinates of a point on the faces of `mask` may change if it is to stay there.
#[must_use]
pub fn free_axes(mask: u8) -> [bool; 3] {
    std::array::from_fn(|axis| mask >> (2 * axis) & 3 == 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_run_between_neighbours_and_lie_on_two_faces() {
        for (edge, [a, b]) in EDGES.iter().enumerate() {
            assert_eq!((a ^ b).count_ones(), 1);
            assert_eq!(edge_mask(edge).count_ones(), 2);
            assert_eq!(edge_between(usize::from(*b), usize::from(*a)), Some(edge));
            let [left, right] = edge_sides(edge);
            assert_eq!(1 << left | 1 << right, edge_mask(edge));
        }
        assert_eq!(edge_between(0, 7), None);
    }

    /// Left of an edge, that is along normal × direction, lies the inside of the face.
    #[test]
    fn sides_agree_with_cross_products() {
        for (edge, ends) in EDGES.iter().enumerate() {
            let [a, b] = ends.map(|c| nalgebra::Vector3::from(corner_position(c.into())));
            let [left, right] = edge_sides(edge);
            let outward = |face: usize| {
                let mut n = nalgebra::Vector3::zeros();
                n[face / 2] = if face % 2 == 1 { 1.0 } else { -1.0 };
                n
            };
            assert_eq!(outward(left).cross(&(b - a)), -outward(right));
        }
    }

    #[test]
    fn rings_turn_counter_clockwise_and_face_axes_have_outward_normals() {
        for corner in 0..8 {
            let centre = nalgebra::Vector3::from(corner_position(corner));
            let [p, q, r] =
                corner_ring(corner).map(|c| nalgebra::Vector3::from(corner_position(c)));
            let outward = centre - nalgebra::Vector3::repeat(0.5);
            assert!((q - p).cross(&(r - p)).dot(&outward) > 0.0);
        }
        for face in 0..6 {
            let [u, v] = face_axes(face);
            let mut axes = [nalgebra::Vector3::<f64>::zeros(); 2];
            axes[0][u] = 1.0;
            axes[1][v] = 1.0;
            let normal = axes[0].cross(&axes[1])[face / 2];
            assert_eq!(normal, if face % 2 == 1 { 1.0 } else { -1.0 });
        }
    }

    #[test]
    fn corners_are_fixed_and_edges_slide() {
        assert_eq!(free_axes(corner_mask(5)), [false; 3]);
        assert_eq!(free_axes(edge_mask(0)), [true, false, false]);
        assert_eq!(free_axes(1 << 3), [true, false, true]);
    }
}
