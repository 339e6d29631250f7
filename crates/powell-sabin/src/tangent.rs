//! Tangent planes of nearly parallel vectors.
//!
//! Where the domain is needles, both derivatives at a vertex are nearly parallel, and what a rounding
//! leaves out of their plane turns the normal by itself over their angle. Two things prevent that:
//! vectors are rounded such that they stay in their plane, and products do not cancel.

use msplines_common::Vector3;

/// How many units in the last place each of two components may be moved.
const REACH: i32 = 16;

/// Sine of the angle between two vectors below which their rounding shows: above it, it turns their
/// normal by 1e-14 at most.
const THIN: f64 = 0.05;

/// Returns `a b - c d` to within rounding of the result.
///
/// # Reference
/// [Jeannerod2013] Algorithm 1, after Kahan: the error of one product is taken out of the other.
fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let product = c * d;
    let error = c.mul_add(-d, product);
    a.mul_add(b, -product) + error
}

/// Returns the vector product, each component to within rounding of itself.
pub(crate) fn cross(u: &Vector3<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(
        difference_of_products(u.y, v.z, u.z, v.y),
        difference_of_products(u.z, v.x, u.x, v.z),
        difference_of_products(u.x, v.y, u.y, v.x),
    )
}

/// Returns the vector times the power of two that makes its largest component about 1; nothing for
/// those without direction.
fn scaled(vector: &Vector3<f64>) -> Option<Vector3<f64>> {
    let largest = vector.amax();
    if !(largest > 0.0 && largest.is_finite()) {
        return None;
    }
    // Two steps, as the power that undoes the smallest numbers is none.
    let half = 0.5 * largest.log2().floor();
    let (first, second) = (half.floor(), half.ceil());
    Some(vector * (-first).exp2() * (-second).exp2())
}

/// Returns the unit normal of two vectors, if they span a plane.
pub(crate) fn unit_normal(u: &Vector3<f64>, v: &Vector3<f64>) -> Option<Vector3<f64>> {
    let (u, v) = (scaled(u)?, scaled(v)?);
    cross(&u, &v).try_normalize(f64::EPSILON)
}

/// Returns the inner product as if it were computed with twice the digits.
///
/// # Reference
/// [Ogita2005] Algorithm 5.3.
fn inner_product(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    let (mut sum, mut left) = (0.0_f64, 0.0_f64);
    for (x, y) in a.iter().zip(b.iter()) {
        let product = x * y;
        left += x.mul_add(*y, -product);
        let total = sum + product;
        let part = total - sum;
        left += (sum - (total - part)) + (product - part);
        sum = total;
    }
    sum + left
}

/// Returns two vectors that lie across `normal` but for rounding, those that are nearly parallel rounded
/// such that they tell it to the last digits.
pub(crate) fn kept_across(vectors: [Vector3<f64>; 2], normal: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let [Some(u), Some(v)] = vectors.each_ref().map(scaled) else {
        return vectors;
    };
    if cross(&u, &v).norm() > THIN * u.norm() * v.norm() {
        return vectors;
    }
    vectors.map(|vector| rounded_across(vector, normal))
}

/// Returns a vector near to one that lies across `normal` but for rounding, with components moved by
/// few units in their last place so that it is nearer to being across than rounding allows.
///
/// The multiples of those units are searched for the least inner product: of two components in
/// turn, the third one follows.
fn rounded_across(vector: Vector3<f64>, normal: &Vector3<f64>) -> Vector3<f64> {
    let unit = vector.map(|x| x.abs().max(f64::MIN_POSITIVE) * f64::EPSILON);
    let unit = unit.map(|x| x.log2().floor().exp2());
    let gains = unit.component_mul(normal);
    // The component that moves the product most is the one that follows.
    let last = gains.iamax();
    let [first, second] = [(last + 1) % 3, (last + 2) % 3];
    let product = inner_product(&vector, normal);
    if product == 0.0 || gains[last] == 0.0 || !product.is_finite() {
        return vector;
    }
    let mut best = (product.abs(), vector);
    for i in -REACH..=REACH {
        for j in -REACH..=REACH {
            let (i, j) = (f64::from(i), f64::from(j));
            let left = product + i * gains[first] + j * gains[second];
            let k = -(left / gains[last]).round();
            if (left + k * gains[last]).abs() >= best.0 {
                continue;
            }
            let mut moved = vector;
            for (at, steps) in [(first, i), (second, j), (last, k)] {
                moved[at] += steps * unit[at];
            }
            let product = inner_product(&moved, normal).abs();
            if product < best.0 {
                best = (product, moved);
            }
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::Random;

    #[test]
    fn planes_of_nearly_parallel_vectors_keep_their_normal() {
        let mut random = Random::new(5);
        let mut worst = [0.0_f64; 2];
        for _ in 0..200 {
            let mut vector = || Vector3::from_fn(|_, _| random.next() - 0.5);
            let normal = vector().normalize();
            let along = normal.cross(&vector()).normalize();
            let across = normal.cross(&along);
            // As a domain of needles has them: an angle of 1e-5 and lengths that differ.
            let plain = [3.0 * along, 0.7 * along + 1e-5 * across];
            let kept = kept_across(plain, &normal);
            for (was, is) in plain.iter().zip(&kept) {
                assert!((was - is).norm() < 64.0 * f64::EPSILON * was.norm());
            }
            for (worst, [u, v]) in worst.iter_mut().zip([plain, kept]) {
                let own = unit_normal(&u, &v).expect("a plane");
                *worst = worst.max(own.cross(&normal).norm());
            }
        }
        // Rounding over the angle, and less than a tenth of it.
        assert!(worst[0] > 1e-11 && worst[1] < 1e-12, "{worst:?}");
    }

    #[test]
    fn scales_do_not_matter() {
        for scale in [1e-300, 1e-160, 1.0, 1e160, 1e300] {
            let (u, v) = (Vector3::new(scale, 0.0, 0.0), Vector3::new(0.0, scale, 0.0));
            assert_eq!(unit_normal(&u, &v), Some(Vector3::z()));
            assert_eq!(kept_across([u, u], &Vector3::z()), [u, u]);
        }
        let parallel = Vector3::new(1.0, 2.0, 3.0);
        assert_eq!(unit_normal(&parallel, &(3.0 * parallel)), None);
        assert_eq!(unit_normal(&parallel, &Vector3::zeros()), None);
        let infinite = Vector3::new(f64::INFINITY, 0.0, 0.0);
        assert_eq!(unit_normal(&parallel, &infinite), None);
    }
}
