//! How far a map of a triangulated surface is from conformal: angle distortion, conformal factor,
//! flips.
//!
//! # Notation
//! On one triangle the map is linear. With complex coordinates it is `z ↦ p z + q z̄`, its singular
//! values are `|p| + |q|` and `||p| - |q||`, and it keeps orientation where `|p| > |q|`.

pub use msplines_common::operators::triangle_area as area;
use nalgebra::Vector3;
use robust::{Coord, Coord3D, orient2d, orient3d};
use serde::{Deserialize, Serialize};

/// What a linear map does to one triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Larger singular value over the smaller one: 1 is conformal, infinite a degenerate image.
    pub anisotropy: f64,
    /// Root of the product of the singular values: the conformal factor, a ratio of lengths.
    pub scale: f64,
    /// Whether the image is oriented the other way or has no area, as far as rounding tells.
    pub flipped: bool,
}

/// What a map does to a whole surface; every statistic is weighted by the areas of the surface, and
/// taken over the triangles that keep their orientation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Distortion {
    /// Mean of the ratio of the singular values; 1 is conformal.
    pub angle_mean: f64,
    /// Median of that ratio.
    pub angle_p50: f64,
    /// 99th percentile of that ratio.
    pub angle_p99: f64,
    /// 99th over 1st percentile of the conformal factor, a ratio of lengths.
    pub scale_spread: f64,
    /// Triangles whose image is oriented the other way or has no area.
    pub flips: usize,
}

impl Distortion {
    /// Returns the statistics of stretches and the areas of their triangles; triangles without area
    /// count as flips only.
    #[must_use]
    pub fn of(stretches: &[Stretch], areas: &[f64]) -> Self {
        let mut weighted: Vec<(f64, f64, f64)> = stretches
            .iter()
            .zip(areas)
            .filter(|(stretch, area)| **area > 0.0 && !stretch.flipped)
            .map(|(stretch, &area)| (stretch.anisotropy, stretch.scale, area))
            .collect();
        let total: f64 = weighted.iter().map(|entry| entry.2).sum();
        let angle_mean = weighted.iter().map(|(k, _, area)| k * area).sum::<f64>() / total;
        weighted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let angles: Vec<_> = weighted.iter().map(|&(k, _, area)| (k, area)).collect();
        weighted.sort_by(|a, b| a.1.total_cmp(&b.1));
        let scales: Vec<_> = weighted.iter().map(|&(_, s, area)| (s, area)).collect();
        Self {
            angle_mean,
            angle_p50: percentile(&angles, 0.5 * total),
            angle_p99: percentile(&angles, 0.99 * total),
            scale_spread: percentile(&scales, 0.99 * total) / percentile(&scales, 0.01 * total),
            flips: stretches.iter().filter(|stretch| stretch.flipped).count(),
        }
    }
}

/// Returns the first of ascending values at which the weights reach `weight`.
fn percentile(ascending: &[(f64, f64)], weight: f64) -> f64 {
    let mut sum = 0.0;
    for &(value, own) in ascending {
        sum += own;
        if sum >= weight {
            return value;
        }
    }
    ascending.last().map_or(f64::NAN, |entry| entry.0)
}

/// Returns the stretch of a triangle of the given sides whose edges have the images `edges`.
///
/// Side and edge `i` run from corner `i` to corner `i + 1 (mod 3)`.
#[must_use]
pub fn stretch(sides: [f64; 3], edges: [[f64; 2]; 3]) -> Stretch {
    // The triangle in the plane: side 0 along the first axis, the last corner at `along + i height`.
    let base = sides[0];
    let height = 2.0 * area(sides) / base;
    let along = (sides[2] * sides[2] + (base - sides[1]) * (base + sides[1])) / (2.0 * base);
    let columns: [[f64; 2]; 2] = {
        let first = edges[0].map(|x| x / base);
        let second = [0, 1].map(|i| (-edges[2][i] - along * first[i]) / height);
        [first, second]
    };
    let [[a, b], [c, d]] = columns;
    let p = 0.5 * (a + d).hypot(b - c);
    let q = 0.5 * (a - d).hypot(b + c);
    // (p - q)(p + q) is the determinant; written out it does not cancel.
    let determinant = a * d - b * c;
    Stretch {
        anisotropy: (p + q) * (p + q) / determinant.abs(),
        scale: determinant.abs().sqrt(),
        flipped: determinant.is_nan() || determinant <= 0.0,
    }
}

/// Returns the stretch of each triangle under a closed form: `edges[h]` is the image of half-edge
/// `h = 3 f + i` and `lengths[f][i]` its length.
///
/// # Panics
/// If there is not one image per half-edge.
#[must_use]
pub fn flat_stretches(lengths: &[[f64; 3]], edges: &[[f64; 2]]) -> Vec<Stretch> {
    assert_eq!(3 * lengths.len(), edges.len(), "one image per half-edge");
    let images = edges.as_chunks::<3>().0;
    let both = lengths.iter().zip(images);
    both.map(|(&sides, &edges)| stretch(sides, edges)).collect()
}

/// Returns the distortion of a map into the plane, given by the images of the half-edges.
///
/// Flips are judged to rounding, from the edges; see [`flat_stretches`]. Cost O(n log n).
///
/// # Panics
/// If there is not one image per half-edge.
#[must_use]
pub fn measure_flat(lengths: &[[f64; 3]], edges: &[[f64; 2]]) -> Distortion {
    Distortion::of(&flat_stretches(lengths, edges), &areas(lengths))
}

/// Returns the distortion of a map into the plane, given by the images of the vertices; flips are
/// judged exactly.
///
/// # Panics
/// If a face names a vertex without image, or there are not three lengths per face.
#[must_use]
pub fn measure_planar(faces: &[[u32; 3]], lengths: &[[f64; 3]], points: &[[f64; 2]]) -> Distortion {
    let mut distortion = measure_flat(lengths, &planar_edges(faces, points));
    distortion.flips = planar_flips(faces, points).len();
    distortion
}

/// Returns the distortion of a map onto the unit sphere, whose triangles stand for their chords'
/// plane triangles; flips are judged exactly.
///
/// # Panics
/// If a face names a vertex without image, or there are not three lengths per face.
#[must_use]
pub fn measure_spherical(
    faces: &[[u32; 3]],
    lengths: &[[f64; 3]],
    points: &[Vector3<f64>],
) -> Distortion {
    let mut distortion = Distortion::of(
        &spherical_stretches(faces, lengths, points),
        &areas(lengths),
    );
    distortion.flips = spherical_flips(faces, points).len();
    distortion
}

/// Returns the stretch of each triangle into the plane triangle of its corners' images, whose
/// orientation is not judged.
///
/// # Panics
/// If a face names a vertex without image, or there are not three lengths per face.
#[must_use]
pub fn spherical_stretches(
    faces: &[[u32; 3]],
    lengths: &[[f64; 3]],
    points: &[Vector3<f64>],
) -> Vec<Stretch> {
    assert_eq!(faces.len(), lengths.len(), "lengths of every face");
    faces
        .iter()
        .zip(lengths)
        .map(|(corners, &sides)| stretch(sides, chords(corners.map(|v| points[v as usize]))))
        .collect()
}

/// Returns the edge vector of each half-edge of faces with corners in the plane.
#[must_use]
pub fn planar_edges(faces: &[[u32; 3]], points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let edge = |[a, b]: [u32; 2]| {
        let [a, b] = [a, b].map(|v| points[v as usize]);
        [b[0] - a[0], b[1] - a[1]]
    };
    let sides = faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    sides.map(edge).collect()
}

/// Returns the faces whose corners in the plane do not turn left.
///
/// # Reference
/// [Shewchuk1997] §4.3, by the crate `robust`.
#[must_use]
pub fn planar_flips(faces: &[[u32; 3]], points: &[[f64; 2]]) -> Vec<u32> {
    let turns_left = |corners: &[u32; 3]| {
        let [a, b, c] = corners
            .map(|v| points[v as usize])
            .map(|[x, y]| Coord { x, y });
        orient2d(a, b, c) > 0.0
    };
    failing(faces, turns_left)
}

/// Returns the faces whose corners `a`, `b`, `c` on the unit sphere have not `det[a, b, c] > 0`.
///
/// # Reference
/// [Shewchuk1997] §4.3, by the crate `robust`.
#[must_use]
pub fn spherical_flips(faces: &[[u32; 3]], points: &[Vector3<f64>]) -> Vec<u32> {
    let origin = Coord3D {
        x: 0.0,
        y: 0.0,
        z: 0.0,
    };
    let turns_left = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|v| points[v as usize]).map(|p| Coord3D {
            x: p.x,
            y: p.y,
            z: p.z,
        });
        orient3d(a, b, c, origin) > 0.0
    };
    failing(faces, turns_left)
}

fn failing(faces: &[[u32; 3]], holds: impl Fn(&[u32; 3]) -> bool) -> Vec<u32> {
    let ids = 0..faces.len() as u32;
    ids.filter(|&f| !holds(&faces[f as usize])).collect()
}

/// Returns the edge vectors of a triangle in space, in a frame of its plane.
fn chords([a, b, c]: [Vector3<f64>; 3]) -> [[f64; 2]; 3] {
    let (ab, ac) = (b - a, c - a);
    let length = ab.norm();
    let (along, height) = (ab.dot(&ac) / length, ab.cross(&ac).norm() / length);
    [[length, 0.0], [along - length, height], [-along, -height]]
}

fn areas(lengths: &[[f64; 3]]) -> Vec<f64> {
    lengths.iter().map(|&sides| area(sides)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A few roundings of numbers of order one.
    const ROUNDING: f64 = 1e-14;

    const SIDES: [f64; 3] = [3.0, 4.0, 5.0];

    /// The images of the edges of that right triangle under the matrix with columns `x` and `y`.
    fn images(x: [f64; 2], y: [f64; 2]) -> [[f64; 2]; 3] {
        let at = |s: f64, t: f64| [s * x[0] + t * y[0], s * x[1] + t * y[1]];
        [at(3.0, 0.0), at(0.0, 4.0), at(-3.0, -4.0)]
    }

    #[test]
    fn singular_values_of_a_known_matrix_are_found() {
        // A rotation of diag(6, 2) by 30 degrees after one of 0.
        let (s, c) = (0.5, 0.75_f64.sqrt());
        let found = stretch(SIDES, images([6.0 * c, 6.0 * s], [-2.0 * s, 2.0 * c]));
        assert!((found.anisotropy - 3.0).abs() < ROUNDING);
        assert!((found.scale - 12.0_f64.sqrt()).abs() < ROUNDING);
        assert!(!found.flipped);
        let turned = stretch(SIDES, images([2.0, 0.0], [0.0, -2.0]));
        assert!(turned.flipped && (turned.anisotropy - 1.0).abs() < ROUNDING);
        assert!(stretch(SIDES, images([1.0, 0.0], [2.0, 0.0])).flipped);
    }

    #[test]
    fn percentiles_are_weighted_by_area() {
        let stretch = |anisotropy: f64, scale: f64| Stretch {
            anisotropy,
            scale,
            flipped: anisotropy > 5.0,
        };
        let all = [3.5, 1.0, 2.0, 9.0].map(|k| stretch(k, 4.0 / k));
        let found = Distortion::of(&all, &[1.0, 4.0, 0.0, 7.0]);
        assert_eq!((found.angle_mean, found.angle_p50), (1.5, 1.0));
        assert_eq!((found.angle_p99, found.scale_spread), (3.5, 3.5));
        assert_eq!(found.flips, 1);
    }

    #[test]
    fn orientation_on_the_sphere_is_exact() {
        let tiny = 1e-13;
        let points = [
            Vector3::new(tiny, 0.0, 1.0),
            Vector3::new(0.0, tiny, 1.0),
            Vector3::new(0.0, 0.0, 1.0),
        ];
        assert!(spherical_flips(&[[2, 0, 1]], &points).is_empty());
        assert_eq!(spherical_flips(&[[0, 2, 1], [0, 0, 1]], &points), [0, 1]);
    }
}
