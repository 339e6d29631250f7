//! Triangles of a polygon.

use nalgebra::{Point3, Vector3};

/// Polygons with more corners than this become a plain fan: clipping ears takes quadratic time.
const LARGEST_CLIPPED: usize = 1024;

/// Returns a polygon's triangles as triples of corner numbers, oriented as the polygon.
///
/// A quad is cut along the diagonal that leaves the larger smallest angle. A larger polygon loses
/// its ear of largest smallest angle, seen along its average normal, until a triangle is left; a
/// polygon without a proper ear, which crosses itself, becomes a fan.
pub(super) fn triangulate(corners: &[Point3<f64>]) -> Vec<[usize; 3]> {
    match corners.len() {
        0..3 => Vec::new(),
        3 => vec![[0, 1, 2]],
        4 => quad(corners),
        n if n <= LARGEST_CLIPPED => clip_ears(corners),
        n => (1..n - 1).map(|i| [0, i, i + 1]).collect(),
    }
}

fn quad(p: &[Point3<f64>]) -> Vec<[usize; 3]> {
    let normal = newell_normal(p);
    let quality = |t: [usize; 3]| ear_quality(t.map(|i| p[i]), &normal);
    let (first, second) = ([[0, 1, 2], [0, 2, 3]], [[1, 2, 3], [1, 3, 0]]);
    let worst = |pair: [[usize; 3]; 2]| quality(pair[0]).min(quality(pair[1]));
    if worst(second) > worst(first) {
        second.to_vec()
    } else {
        first.to_vec()
    }
}

fn clip_ears(p: &[Point3<f64>]) -> Vec<[usize; 3]> {
    let normal = newell_normal(p);
    let mut ring: Vec<usize> = (0..p.len()).collect();
    let mut triangles = Vec::with_capacity(p.len() - 2);
    let mut quality: Vec<f64> = (0..ring.len())
        .map(|i| ear_at(p, &ring, i, &normal))
        .collect();
    while ring.len() > 3 {
        let n = ring.len();
        let best = (0..n).fold(
            0,
            |best, i| if quality[i] > quality[best] { i } else { best },
        );
        triangles.push([ring[(best + n - 1) % n], ring[best], ring[(best + 1) % n]]);
        ring.remove(best);
        quality.remove(best);
        let n = ring.len();
        for i in [(best + n - 1) % n, best % n] {
            quality[i] = ear_at(p, &ring, i, &normal);
        }
    }
    triangles.push([ring[0], ring[1], ring[2]]);
    triangles
}

/// Returns the quality of the ear at place `i` of the ring; negative if it is none.
fn ear_at(p: &[Point3<f64>], ring: &[usize], i: usize, normal: &Vector3<f64>) -> f64 {
    let n = ring.len();
    let ear = [ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]];
    let triangle = ear.map(|v| p[v]);
    let quality = ear_quality(triangle, normal);
    let blocked = ring
        .iter()
        .any(|v| !ear.contains(v) && contains(&triangle, &p[*v], normal));
    if blocked { -1.0 } else { quality }
}

fn contains(triangle: &[Point3<f64>; 3], point: &Point3<f64>, normal: &Vector3<f64>) -> bool {
    (0..3).all(|i| {
        let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
        (b - a).cross(&(point - a)).dot(normal) >= 0.0
    })
}

/// Returns the area along the normal over the sum of squared sides, which falls with the smallest
/// angle.
fn ear_quality([a, b, c]: [Point3<f64>; 3], normal: &Vector3<f64>) -> f64 {
    let area = (b - a).cross(&(c - a)).dot(normal);
    let sides = (b - a).norm_squared() + (c - b).norm_squared() + (a - c).norm_squared();
    if sides > 0.0 { area / sides } else { 0.0 }
}

fn newell_normal(p: &[Point3<f64>]) -> Vector3<f64> {
    let sum: Vector3<f64> = (1..p.len() - 1)
        .map(|i| (p[i] - p[0]).cross(&(p[i + 1] - p[0])))
        .sum();
    sum.try_normalize(0.0).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(points: &[[f64; 2]]) -> Vec<Point3<f64>> {
        points
            .iter()
            .map(|p| Point3::new(p[0], p[1], 0.0))
            .collect()
    }

    fn areas(p: &[Point3<f64>]) -> Vec<f64> {
        triangulate(p)
            .iter()
            .map(|t| 0.5 * (p[t[1]] - p[t[0]]).cross(&(p[t[2]] - p[t[0]])).z)
            .collect()
    }

    #[test]
    fn a_flat_quad_is_cut_along_its_short_diagonal() {
        let rhomb = flat(&[[-3.0, 0.0], [0.0, -1.0], [3.0, 0.0], [0.0, 1.0]]);
        assert_eq!(triangulate(&rhomb), vec![[1, 2, 3], [1, 3, 0]]);
    }

    #[test]
    fn triangles_of_a_hollow_polygon_are_positive_and_cover_it() {
        let dart = flat(&[[0.0, 0.0], [4.0, -2.0], [1.0, 0.0], [4.0, 2.0]]);
        let comb = flat(&[
            [0.0, 0.0],
            [6.0, 0.0],
            [6.0, 4.0],
            [5.0, 1.0],
            [3.5, 4.0],
            [3.0, 1.0],
            [2.0, 4.0],
            [1.0, 1.0],
            [0.0, 4.0],
        ]);
        for polygon in [dart, comb] {
            let twice: f64 = (0..polygon.len())
                .map(|i| {
                    let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
                    a.x * b.y - a.y * b.x
                })
                .sum();
            let areas = areas(&polygon);
            assert!(areas.iter().all(|&a| a > 0.0), "{areas:?}");
            assert!((areas.iter().sum::<f64>() - 0.5 * twice).abs() < 1e-12);
        }
    }
}
