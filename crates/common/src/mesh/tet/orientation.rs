//! On which side of a plane a point lies, decided exactly.

use nalgebra::Point3;
use robust::{Coord3D, orient3d};

/// Sign of the volume of a tetrahedron.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Orientation {
    /// Inverted: two corners are in the wrong order.
    Negative,
    /// All four corners lie in one plane.
    Flat,
    /// As it should be.
    Positive,
}

/// Magnitudes between which products of three differences neither overflow nor underflow.
const SAFE: std::ops::RangeInclusive<f64> = 1e-90..=1e90;

/// Returns the exact sign of `(b - a) . ((c - a) x (d - a))` for finite corners.
///
/// Coordinates far from one are first scaled by a power of two. The sign is exact unless coordinates
/// of one tetrahedron differ by so many magnitudes that products of their last digits underflow.
/// About 10 ns where rounding cannot matter.
///
/// # Reference
/// [Shewchuk1997] §4.3, by the crate `robust`.
#[must_use]
pub fn orientation(corners: &[Point3<f64>; 4]) -> Orientation {
    let largest = corners.iter().map(|p| p.coords.amax()).fold(0.0, f64::max);
    let factor = if SAFE.contains(&largest) || largest == 0.0 || !largest.is_finite() {
        1.0
    } else {
        // In two steps, as the inverse of a subnormal number overflows.
        let near = if largest < 1e-200 {
            2f64.powi(600)
        } else {
            1.0
        };
        near * 2f64.powi(-((largest * near).log2() as i32))
    };
    let [a, b, c, d] = corners.map(|p| Coord3D {
        x: p.x * factor,
        y: p.y * factor,
        z: p.z * factor,
    });
    // Positive where `d` lies below the plane in which `a`, `b`, `c` run counter-clockwise.
    let below = orient3d(a, b, c, d);
    if below < 0.0 {
        Orientation::Positive
    } else if below > 0.0 {
        Orientation::Negative
    } else {
        Orientation::Flat
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Coordinates below 2^39 keep the products of three differences and their sum within 128 bits.
    const LIMIT: i64 = 1 << 39;

    fn exact(corners: [[i64; 3]; 4]) -> Orientation {
        let [a, b, c, d] = corners.map(|p| p.map(i128::from));
        let from = |p: [i128; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
        let ([p, q, r], [s, t, u], [v, w, x]) = (from(b), from(c), from(d));
        let volume = p * (t * x - u * w) + q * (u * v - s * x) + r * (s * w - t * v);
        match volume.signum() {
            1 => Orientation::Positive,
            0 => Orientation::Flat,
            _ => Orientation::Negative,
        }
    }

    fn computed(corners: [[i64; 3]; 4], scale: f64) -> Orientation {
        orientation(&corners.map(|p| Point3::from(p.map(|x| x as f64 * scale))))
    }

    fn point(limit: i64) -> impl Strategy<Value = [i64; 3]> {
        prop::array::uniform3(-limit..limit)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn signs_are_those_of_whole_numbers(corners in prop::array::uniform4(point(3))) {
            for scale in [1.0, 2f64.powi(-1000), 2f64.powi(1000)] {
                prop_assert_eq!(computed(corners, scale), exact(corners));
            }
        }

        #[test]
        fn nearly_flat_ones_are_told_apart(
            [a, b, c] in prop::array::uniform3(point(LIMIT / 4)),
            weights in prop::array::uniform2(-1i64..3),
            off in prop::array::uniform3(-1i64..=1),
        ) {
            let d = [0, 1, 2].map(|i| {
                a[i] + weights[0] * (b[i] - a[i]) / 2 + weights[1] * (c[i] - a[i]) / 2 + off[i]
            });
            for corners in [[a, b, c, d], [b, a, c, d], [d, b, c, a]] {
                prop_assert_eq!(computed(corners, 1.0), exact(corners));
            }
        }
    }

    #[test]
    fn far_from_the_origin_a_flat_one_stays_flat() {
        let at = |x, y, z| Point3::new(1e15 + x, 1e15 + y, 1e15 + z);
        let flat = [
            at(0., 0., 0.),
            at(1., 0., 1.),
            at(0., 1., 1.),
            at(1., 1., 2.),
        ];
        assert_eq!(orientation(&flat), Orientation::Flat);
        let mut raised = flat;
        raised[3].z += 0.125;
        assert_eq!(orientation(&raised), Orientation::Positive);
        raised[3].z -= 0.25;
        assert_eq!(orientation(&raised), Orientation::Negative);
    }
}
