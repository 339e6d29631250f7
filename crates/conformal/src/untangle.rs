//! Turning back single triangles: a vertex moves into the kernel of the polygon around it.
//!
//! Rounding turns over slivers of almost no area, and non-convex boundaries a few triangles next to
//! them. The polygon around such a vertex is nearly always star-shaped.

use msplines_common::mesh::{NONE, Topology};
use msplines_common::operators::intrinsic::IntrinsicTriangulation;
use nalgebra::Vector3;

use crate::measure::{planar_flips, spherical_flips};

/// Rounds over the vertices of all turned triangles. What twenty do not turn stays.
const ROUNDS: usize = 20;

/// Moves inner vertices until no triangle on the unit sphere is turned over, and returns how many
/// were moved; stops where a round turns none back.
pub(crate) fn untangle_sphere(
    triangulation: &IntrinsicTriangulation,
    points: &mut [Vector3<f64>],
) -> usize {
    untangle(triangulation, points, spherical_flips, |ring| {
        let normal = ring.iter().sum::<Vector3<f64>>().normalize();
        // Straight lines of the gnomonic plane are great circles.
        let [first, second] = tangent_frame(normal);
        if ring.iter().any(|p| p.dot(&normal) <= 0.0) {
            return None;
        }
        let project =
            |p: &Vector3<f64>| [p.dot(&first), p.dot(&second)].map(|x| x / p.dot(&normal));
        let flat: Vec<[f64; 2]> = ring.iter().map(project).collect();
        let [x, y] = kernel_centre(&flat)?;
        Some((normal + first * x + second * y).normalize())
    })
}

/// Moves inner vertices until no triangle in the plane is turned over, and returns how many were
/// moved.
pub(crate) fn untangle_plane(
    triangulation: &IntrinsicTriangulation,
    points: &mut [[f64; 2]],
) -> usize {
    untangle(triangulation, points, planar_flips, kernel_centre)
}

/// Moves the corners of turned triangles to the centres of the polygons around them, where these have
/// one, and returns how many vertices were moved.
fn untangle<P: Copy>(
    triangulation: &IntrinsicTriangulation,
    points: &mut [P],
    turned: impl Fn(&[[u32; 3]], &[P]) -> Vec<u32>,
    centre: impl Fn(&[P]) -> Option<P>,
) -> usize {
    let star = Stars::of(triangulation, points.len());
    let mut moved = vec![false; points.len()];
    let mut flips = turned(&triangulation.faces, points);
    for _ in 0..ROUNDS {
        if flips.is_empty() {
            break;
        }
        for vertex in corners(triangulation, &flips) {
            let Some(link) = star.link(vertex) else {
                continue;
            };
            let ring: Vec<P> = link.iter().map(|&v| points[v as usize]).collect();
            if let Some(centre) = centre(&ring) {
                points[vertex as usize] = centre;
                moved[vertex as usize] = true;
            }
        }
        flips = turned(&triangulation.faces, points);
    }
    moved.iter().filter(|&&m| m).count()
}

/// Returns two axes that with a unit vector, seen from outside, make a right-handed frame.
pub(crate) fn tangent_frame(normal: Vector3<f64>) -> [Vector3<f64>; 2] {
    let first = normal.cross(&Vector3::ith(normal.iamin(), 1.0)).normalize();
    [first, normal.cross(&first)]
}

/// Returns the corners of some faces, each once, ascending.
fn corners(triangulation: &IntrinsicTriangulation, faces: &[u32]) -> Vec<u32> {
    let corners = faces.iter().flat_map(|&f| triangulation.faces[f as usize]);
    let mut vertices: Vec<u32> = corners.collect();
    vertices.sort_unstable();
    vertices.dedup();
    vertices
}

/// The polygons around the vertices of a triangulation.
pub(crate) struct Stars<'a> {
    triangulation: &'a IntrinsicTriangulation,
    outgoing: Vec<u32>,
}

impl<'a> Stars<'a> {
    pub(crate) fn of(triangulation: &'a IntrinsicTriangulation, vertex_count: usize) -> Self {
        let mut outgoing = vec![NONE; vertex_count];
        let origins = triangulation.faces.iter().flatten();
        for (half_edge, &origin) in (0u32..).zip(origins) {
            outgoing[origin as usize] = half_edge;
        }
        Self {
            triangulation,
            outgoing,
        }
    }

    /// Returns the outgoing half-edges of an inner vertex counter-clockwise, or nothing on the
    /// boundary.
    pub(crate) fn fan(&self, vertex: u32) -> Option<Vec<u32>> {
        let start = self.outgoing[vertex as usize];
        let mut fan = Vec::new();
        let mut half_edge = start;
        while half_edge != NONE {
            fan.push(half_edge);
            half_edge = self.triangulation.twins[Topology::previous(half_edge) as usize];
            if half_edge == start {
                return Some(fan);
            }
        }
        None
    }

    /// Returns the neighbours of an inner vertex counter-clockwise, or nothing on the boundary.
    fn link(&self, vertex: u32) -> Option<Vec<u32>> {
        let target = |&h: &u32| {
            let next = Topology::next(h);
            self.triangulation.faces[(next / 3) as usize][(next % 3) as usize]
        };
        Some(self.fan(vertex)?.iter().map(target).collect())
    }
}

/// Returns the centroid of the points that see the whole of a polygon from its left side, if there
/// are any.
fn kernel_centre(ring: &[[f64; 2]]) -> Option<[f64; 2]> {
    // Relative to a corner, so that small polygons keep their digits.
    let origin = ring[0];
    let ring: Vec<[f64; 2]> = ring
        .iter()
        .map(|p| [p[0] - origin[0], p[1] - origin[1]])
        .collect();
    let radius = ring.iter().flatten().fold(0.0_f64, |r, x| r.max(x.abs()));
    let far = 2.0 * radius;
    let mut kernel = vec![[-far, -far], [far, -far], [far, far], [-far, far]];
    for (i, &a) in ring.iter().enumerate() {
        let b = ring[(i + 1) % ring.len()];
        kernel = clip(&kernel, a, [b[0] - a[0], b[1] - a[1]]);
    }
    let (mut twice, mut sum) = (0.0, [0.0; 2]);
    for i in 2..kernel.len() {
        let [a, b, c] = [kernel[0], kernel[i - 1], kernel[i]];
        let part = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        twice += part;
        (0..2).for_each(|x| sum[x] += part * (a[x] + b[x] + c[x]));
    }
    (twice > 0.0).then(|| [0, 1].map(|x| origin[x] + sum[x] / (3.0 * twice)))
}

/// Returns the part of a convex polygon to the left of a line.
fn clip(polygon: &[[f64; 2]], point: [f64; 2], along: [f64; 2]) -> Vec<[f64; 2]> {
    let height = |p: [f64; 2]| along[0] * (p[1] - point[1]) - along[1] * (p[0] - point[0]);
    let mut part = Vec::with_capacity(polygon.len() + 1);
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (at_p, at_q) = (height(p), height(q));
        if at_p >= 0.0 {
            part.push(p);
        }
        if (at_p < 0.0) != (at_q < 0.0) {
            let t = at_p / (at_p - at_q);
            part.push([0, 1].map(|x| p[x] + t * (q[x] - p[x])));
        }
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kernel_of_a_star_is_found() {
        let square = [[1.0, 1.0], [3.0, 1.0], [3.0, 3.0], [1.0, 3.0]];
        assert_eq!(kernel_centre(&square), Some([2.0, 2.0]));
        // A dart: the kernel lies between the lines through its notch.
        let dart = [[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [0.0, 4.0]];
        let [x, y] = kernel_centre(&dart).expect("a kernel");
        assert!(x > 0.0 && y > 0.0 && x + 3.0 * y < 4.0 && 3.0 * x + y < 4.0);
        let turned: Vec<[f64; 2]> = square.into_iter().rev().collect();
        assert_eq!(kernel_centre(&turned), None);
    }
}
