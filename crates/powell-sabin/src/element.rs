//! The macro triangle: nine numbers at its corners, nineteen Bézier ordinates, six quadratics.
//!
//! # Notation
//! Corners `V_i`, points `R_i` of the split on side `i` from `V_i` to `V_(i+1)`, incentre `Z`; `e_i`
//! the vector of side `i`, `l_i` the share of the way along it at which `R_i` stands, `z` the
//! barycentric coordinates of `Z`. Micro triangle `2 i` is `(V_i, R_i, Z)`, `2 i + 1` is
//! `(R_i, V_(i+1), Z)`. The nine numbers are value, derivative by `u` and derivative by `v` at corner
//! 0, then corner 1, then corner 2.
//!
//! Gradients are linear on each micro triangle and are interpolated between those at `V`, `R` and
//! `Z`. Two micro triangles of a face share these numbers, so that gradients do not jump there by
//! a single bit, however thin the triangles are.
//!
//! # Reference
//! [PowellSabin1977]; [Dierckx1997]; [He2005] Eq. (1).

use crate::vector::{add, cross, dot, norm, scale, sub, turn};

/// Bézier ordinates of a macro triangle.
pub const ORDINATES: usize = 19;

/// Where the ordinates of each kind start; one for each corner or side.
const CORNER: usize = 0;
const TAIL: usize = 3;
const HEAD: usize = 6;
const CORNER_CENTRE: usize = 9;
const SPLIT: usize = 12;
const SPLIT_CENTRE: usize = 15;
const CENTRE: usize = 18;

/// A point of a macro triangle on one of its micro triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MicroPoint {
    /// The micro triangle, 0 to 5.
    pub micro: usize,
    /// Barycentric coordinates on it.
    pub at: [f64; 3],
}

/// A face of the domain with its Powell-Sabin split.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MacroTriangle {
    edges: [[f64; 2]; 3],
    splits: [f64; 3],
    incentre: [f64; 3],
    area: f64,
}

impl MacroTriangle {
    /// Returns the triangle of these sides, split at these shares of them and at its incentre.
    #[must_use]
    pub(crate) fn new(edges: [[f64; 2]; 3], splits: [f64; 3]) -> Self {
        let lengths = edges.map(norm);
        let perimeter: f64 = lengths.iter().sum();
        Self {
            edges,
            splits,
            incentre: [0, 1, 2].map(|i| lengths[(i + 1) % 3] / perimeter),
            area: 0.5 * cross(edges[0], edges[1]),
        }
    }

    /// Returns the flat area.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Returns the barycentric coordinates of the incentre.
    #[must_use]
    pub fn incentre(&self) -> [f64; 3] {
        self.incentre
    }

    /// Returns the share of the way along each side at which it is split.
    #[must_use]
    pub fn splits(&self) -> [f64; 3] {
        self.splits
    }

    /// Returns the vectors of the three sides.
    #[must_use]
    pub fn edges(&self) -> [[f64; 2]; 3] {
        self.edges
    }

    /// Returns the vector from corner `i` to the incentre.
    pub(crate) fn centre_from(&self, i: usize) -> [f64; 2] {
        let (next, last) = ((i + 1) % 3, (i + 2) % 3);
        sub(
            scale(self.incentre[next], self.edges[i]),
            scale(self.incentre[last], self.edges[last]),
        )
    }

    /// Returns the vector from the point of the split on side `i` to the incentre.
    fn centre_from_split(&self, i: usize) -> [f64; 2] {
        sub(self.centre_from(i), scale(self.splits[i], self.edges[i]))
    }

    /// Returns the area of the triangle of side `i` and the incentre.
    fn side_area(&self, i: usize) -> f64 {
        self.incentre[(i + 2) % 3] * self.area
    }

    /// Returns the area of a micro triangle.
    #[must_use]
    pub fn micro_area(&self, micro: usize) -> f64 {
        let i = micro / 2;
        let share = if micro.is_multiple_of(2) {
            self.splits[i]
        } else {
            1.0 - self.splits[i]
        };
        share * self.side_area(i)
    }

    /// Returns the gradients of the barycentric coordinates of a micro triangle.
    pub(crate) fn micro_gradients(&self, micro: usize) -> [[f64; 2]; 3] {
        let i = micro / 2;
        let double = 2.0 * self.micro_area(micro);
        let from_split = self.centre_from_split(i);
        let centre = scale(0.5 / self.side_area(i), turn(self.edges[i]));
        if micro.is_multiple_of(2) {
            let split = scale(-1.0 / double, turn(self.centre_from(i)));
            [scale(1.0 / double, turn(from_split)), split, centre]
        } else {
            let split = scale(1.0 / double, turn(self.centre_from((i + 1) % 3)));
            [split, scale(-1.0 / double, turn(from_split)), centre]
        }
    }

    /// Returns the barycentric coordinates of the corners of a micro triangle.
    #[must_use]
    pub fn micro_corners(&self, micro: usize) -> [[f64; 3]; 3] {
        let i = micro / 2;
        let next = (i + 1) % 3;
        let (mut corner, mut split) = ([0.0; 3], [0.0; 3]);
        split[i] = 1.0 - self.splits[i];
        split[next] = self.splits[i];
        if micro.is_multiple_of(2) {
            corner[i] = 1.0;
            [corner, split, self.incentre]
        } else {
            corner[next] = 1.0;
            [split, corner, self.incentre]
        }
    }

    /// Returns the micro triangle that holds a point given in barycentric coordinates.
    #[must_use]
    pub fn locate(&self, at: [f64; 3]) -> MicroPoint {
        let ratio = |i: usize| at[i] / self.incentre[i];
        // The corner opposite to side i is i + 2.
        let side = (0..3).fold(0, |best, i| {
            if ratio((i + 2) % 3) < ratio((best + 2) % 3) {
                i
            } else {
                best
            }
        });
        let (next, share) = ((side + 1) % 3, self.splits[side]);
        let centre = ratio((side + 2) % 3);
        let tail = at[side] - centre * self.incentre[side];
        let head = at[next] - centre * self.incentre[next];
        if head * (1.0 - share) <= tail * share {
            let split = head / share;
            MicroPoint {
                micro: 2 * side,
                at: [tail - (1.0 - share) * split, split, centre],
            }
        } else {
            let split = tail / (1.0 - share);
            MicroPoint {
                micro: 2 * side + 1,
                at: [split, head - share * split, centre],
            }
        }
    }

    /// Returns the Bézier ordinates of nine numbers at the corners.
    ///
    /// In this order: `V_i`; between `V_i` and `R_i`; between `R_i` and `V_(i+1)`; between `V_i` and
    /// `Z`; `R_i`; between `R_i` and `Z`; `Z`: three each but the last.
    ///
    /// # Reference
    /// [Dierckx1997]; [He2005] Eq. (1).
    #[must_use]
    pub fn ordinates(&self, corners: &[f64; 9]) -> [f64; ORDINATES] {
        let mut out = [0.0; ORDINATES];
        let gradient = |i: usize| [corners[3 * i + 1], corners[3 * i + 2]];
        for i in 0..3 {
            let next = (i + 1) % 3;
            let (edge, share) = (self.edges[i], self.splits[i]);
            out[CORNER + i] = corners[3 * i];
            out[TAIL + i] = corners[3 * i] + 0.5 * share * dot(gradient(i), edge);
            out[HEAD + i] = corners[3 * next] - 0.5 * (1.0 - share) * dot(gradient(next), edge);
            out[CORNER_CENTRE + i] = corners[3 * i] + 0.5 * dot(gradient(i), self.centre_from(i));
        }
        for i in 0..3 {
            let share = self.splits[i];
            let between = |tail: f64, head: f64| (1.0 - share) * tail + share * head;
            out[SPLIT + i] = between(out[TAIL + i], out[HEAD + i]);
            let centre = (out[CORNER_CENTRE + i], out[CORNER_CENTRE + (i + 1) % 3]);
            out[SPLIT_CENTRE + i] = between(centre.0, centre.1);
            out[CENTRE] += self.incentre[i] * centre.0;
        }
        out
    }

    /// Returns the gradients at `V_i`, `R_i` and `Z`: three, three and one.
    ///
    /// At `R_i` the derivative along the edge is that of two quadratics that meet there, and the
    /// derivative across, along `R_i Z`, is interpolated linearly between the corners.
    #[must_use]
    pub fn gradients(&self, corners: &[f64; 9]) -> [[f64; 2]; 7] {
        let mut out = [[0.0; 2]; 7];
        for i in 0..3 {
            out[i] = [corners[3 * i + 1], corners[3 * i + 2]];
        }
        let mut planes = [0.0; 3];
        for i in 0..3 {
            let next = (i + 1) % 3;
            let (tail, head, share) = (out[i], out[next], self.splits[i]);
            let bend =
                2.0 * (corners[3 * next] - corners[3 * i]) - dot(add(tail, head), self.edges[i]);
            let mean = add(scale(1.0 - share, tail), scale(share, head));
            let across = turn(self.centre_from_split(i));
            out[3 + i] = sub(mean, scale(0.5 * bend / self.side_area(i), across));
            // Relative to corner 0, so that equal large values cancel without a trace.
            planes[i] = 2.0 * (corners[3 * i] - corners[0]) + dot(tail, self.centre_from(i));
        }
        for (i, plane) in planes.into_iter().enumerate() {
            let opposite = self.edges[(i + 1) % 3];
            out[6] = add(out[6], scale(0.5 * plane / self.area, turn(opposite)));
        }
        out
    }

    /// Returns the second derivatives `[uu, uv, vv]` on a micro triangle from the gradients at its
    /// macro triangle's seven points.
    pub(crate) fn hessian(&self, gradients: &[[f64; 2]; 7], micro: usize) -> [f64; 3] {
        let [first, second, centre] = gradient_places(micro).map(|at| gradients[at]);
        let [along_first, along_second, _] = self.micro_gradients(micro);
        let (a, b) = (sub(first, centre), sub(second, centre));
        let entry = |i: usize, j: usize| a[i] * along_first[j] + b[i] * along_second[j];
        [entry(0, 0), 0.5 * (entry(0, 1) + entry(1, 0)), entry(1, 1)]
    }
}

/// Returns where the six ordinates of a micro triangle `(P, Q, Z)` stand among the nineteen: those of
/// `P`, `Q`, `Z`, `PQ`, `QZ`, `PZ`.
#[must_use]
pub fn micro_ordinates(micro: usize) -> [usize; 6] {
    let i = micro / 2;
    let next = (i + 1) % 3;
    if micro.is_multiple_of(2) {
        [
            CORNER + i,
            SPLIT + i,
            CENTRE,
            TAIL + i,
            SPLIT_CENTRE + i,
            CORNER_CENTRE + i,
        ]
    } else {
        [
            SPLIT + i,
            CORNER + next,
            CENTRE,
            HEAD + i,
            CORNER_CENTRE + next,
            SPLIT_CENTRE + i,
        ]
    }
}

/// Returns which of the seven gradients belong to the corners of a micro triangle.
pub(crate) fn gradient_places(micro: usize) -> [usize; 3] {
    let i = micro / 2;
    if micro.is_multiple_of(2) {
        [i, 3 + i, 6]
    } else {
        [3 + i, (i + 1) % 3, 6]
    }
}

/// Returns the value of nineteen ordinates at a point.
#[must_use]
pub fn value(ordinates: &[f64; ORDINATES], point: &MicroPoint) -> f64 {
    let b = micro_ordinates(point.micro).map(|at| ordinates[at]);
    let [p, q, r] = point.at;
    p * (p * b[0] + 2.0 * q * b[3])
        + q * (q * b[1] + 2.0 * r * b[4])
        + r * (r * b[2] + 2.0 * p * b[5])
}

/// Returns the gradient at a point from those at the seven points.
#[must_use]
pub(crate) fn gradient(gradients: &[[f64; 2]; 7], point: &MicroPoint) -> [f64; 2] {
    let terms = gradient_places(point.micro).into_iter().zip(point.at);
    terms.fold([0.0; 2], |sum, (at, weight)| {
        add(sum, scale(weight, gradients[at]))
    })
}
