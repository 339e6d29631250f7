//! Barycentric coordinates as integers, on which orientation and containment are exact.

use std::cmp::Reverse;

use crate::mesh::triangle::SurfacePoint;

/// The integer that stands for one. A sum of two weights, and so every weight, fits the 53 bits of
/// a double exactly; a product of two fits 128 bits; rounding to it moves a point by less than the
/// rounding of its position does.
pub(super) const ONE: i64 = 1 << 50;

/// Twice the area of a whole face in units of the weights.
pub(super) const WHOLE: i128 = (ONE as i128) * (ONE as i128);

/// Barycentric coordinates in units of 1 / [`ONE`]: none is negative, their sum is exactly one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Weights(pub(super) [i64; 3]);

impl Weights {
    /// Returns the weights nearest to barycentric coordinates; what is negative becomes zero.
    pub(super) fn round(at: [f64; 3]) -> Self {
        let at = at.map(|x| x.max(0.0));
        let sum: f64 = at.iter().sum();
        let mut weights = at.map(|x| (x / sum * ONE as f64).round() as i64);
        // The largest takes up the rounding: it is at least a third, and a zero stays one.
        let mut order = [0, 1, 2];
        order.sort_by_key(|&i| Reverse(weights[i]));
        let [largest, second, third] = order;
        weights[largest] = ONE - weights[second] - weights[third];
        Self(weights)
    }

    /// Returns the weights of corner `corner`.
    pub(super) fn corner(corner: usize) -> Self {
        let mut weights = [0; 3];
        weights[corner] = ONE;
        Self(weights)
    }

    /// Returns the weights of the point on side `side`, from corner `side` to the next one, whose
    /// weight at the far end is `along`.
    pub(super) fn on_side(side: usize, along: i64) -> Self {
        let mut weights = [0; 3];
        weights[side] = ONE - along;
        weights[(side + 1) % 3] = along;
        Self(weights)
    }

    /// Returns the barycentric coordinates; the conversion is exact.
    pub(super) fn to_coordinates(self) -> [f64; 3] {
        self.0.map(|weight| weight as f64 / ONE as f64)
    }

    /// Returns the point of a face with these weights.
    pub(super) fn on_face(self, face: u32) -> SurfacePoint {
        SurfacePoint {
            face,
            at: self.to_coordinates(),
        }
    }

    /// Returns whether no two weights of the same corner differ by `distance` or more.
    pub(super) fn is_within(self, distance: i64, other: Self) -> bool {
        (0..3).all(|i| (self.0[i] - other.0[i]).abs() < distance)
    }
}

/// Returns twice the area of a triangle, exactly: [`WHOLE`] for the face itself, negative for a
/// triangle that is turned around.
pub(super) fn double_area([p, q, r]: [Weights; 3]) -> i128 {
    let [x, y] = [1, 2].map(|i| {
        let from = p.0[i];
        [i128::from(q.0[i] - from), i128::from(r.0[i] - from)]
    });
    x[0] * y[1] - y[0] * x[1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_one_exactly_and_zeros_stay() {
        for at in [
            [0.0, 0.1, 0.9],
            [1.0 / 3.0; 3],
            [0.7, 0.3, 0.0],
            [-1e-12, 0.5, 0.5 + 1e-12],
            [1.0, 0.0, 0.0],
            [1e-17, 0.5, 0.5],
        ] {
            let weights = Weights::round(at);
            assert_eq!(weights.0.iter().sum::<i64>(), ONE);
            for (before, after) in at.iter().zip(weights.to_coordinates()) {
                assert!(after >= 0.0 && (before - after).abs() < 2e-12);
                assert!(*before > 0.0 || after == 0.0);
            }
        }
    }

    #[test]
    fn the_face_itself_has_the_whole_area_and_a_line_none() {
        let corners = [0, 1, 2].map(Weights::corner);
        assert_eq!(double_area(corners), WHOLE);
        assert_eq!(double_area([corners[0], corners[2], corners[1]]), -WHOLE);
        let [p, q] = [1, ONE / 3].map(|along| Weights::on_side(1, along));
        assert_eq!(double_area([corners[1], p, q]), 0);
        assert!(double_area([corners[0], p, q]) > 0);
    }
}
