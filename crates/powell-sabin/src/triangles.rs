//! Powell-Sabin triangles: for every vertex a small triangle around its Bézier points.
//!
//! Values and gradients at a vertex are the plane through three control points that stand over the
//! corners of such a triangle. As it holds all Bézier points near the vertex, the basis functions of
//! these control points are non-negative, and they sum to one.
//!
//! # Reference
//! [Dierckx1997]; [He2005] §3.1.

use msplines_common::mesh::{NONE, Topology};
use rayon::prelude::*;

use crate::domain::FlatDomain;
use crate::vector::{add, cross, dot, norm, scale, sub};

/// Points nearer to a line than this, relative to the farthest point, are on it: the two incentres
/// and the point of the split between them are on a line by construction.
const COLLINEAR: f64 = 1e-10;

/// Lines that meet at a smaller angle give no corner.
const PARALLEL: f64 = 1e-6;

/// Sides of a hull that are tried, evenly spaced if there are more: any three that close a triangle hold
/// the hull, and the smallest one is worth no cubic time at a vertex of a hundred edges.
const SIDES: usize = 24;

/// How far triangles are grown about their centroid, so that points on a side are inside to the last
/// bit.
const GROWTH: f64 = 1e-8;

/// A triangle around a vertex of the domain, in flat coordinates relative to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowellSabinTriangle {
    corners: [[f64; 2]; 3],
}

impl PowellSabinTriangle {
    /// Returns the corners, counter-clockwise, relative to the vertex.
    #[must_use]
    pub fn corners(&self) -> [[f64; 2]; 3] {
        self.corners
    }

    /// Returns the flat area.
    #[must_use]
    pub fn area(&self) -> f64 {
        let [a, b, c] = self.corners;
        0.5 * cross(sub(b, a), sub(c, a))
    }

    /// Returns the barycentric coordinates of a point relative to the vertex.
    #[must_use]
    pub fn barycentric(&self, point: [f64; 2]) -> [f64; 3] {
        let [a, b, c] = self.corners.map(|corner| sub(corner, point));
        let areas = [cross(b, c), cross(c, a), cross(a, b)];
        let double = 2.0 * self.area();
        areas.map(|area| area / double)
    }

    /// Returns `[alpha, beta, gamma]` of the three basis functions: value and derivatives by `u` and
    /// `v` at the vertex.
    ///
    /// # Reference
    /// [Dierckx1997]; [He2005] §3.1.
    #[must_use]
    pub fn triplets(&self) -> [[f64; 3]; 3] {
        let double = 2.0 * self.area();
        let alpha = self.barycentric([0.0, 0.0]);
        [0, 1, 2].map(|j| {
            let side = sub(self.corners[(j + 2) % 3], self.corners[(j + 1) % 3]);
            [alpha[j], -side[1] / double, side[0] / double]
        })
    }
}

/// Returns the Powell-Sabin triangle of every vertex: of the triangles around its Bézier points with
/// two sides along their hull, the smallest; at vertices of more than about 12 edges a small one.
///
/// # Reference
/// [Dierckx1997]; [He2005] §3.1. Deviation: the smallest triangle comes from the sides of the hull,
/// as in [ORourke1986], instead of a quadratic program.
#[must_use]
pub fn powell_sabin_triangles(domain: &FlatDomain) -> Vec<PowellSabinTriangle> {
    (0..domain.mesh().vertex_count() as u32)
        .into_par_iter()
        .map(|vertex| smallest_triangle(&bezier_points(domain, vertex)))
        .collect()
}

/// Returns the vertex and the Bézier points next to it, relative to it.
///
/// Both sides of every edge count, also where the other face is missing.
pub(crate) fn bezier_points(domain: &FlatDomain, vertex: u32) -> Vec<[f64; 2]> {
    let mut points = vec![[0.0; 2]];
    let (vectors, splits) = (domain.edge_vectors(), domain.edge_splits());
    for h in domain.topology().outgoing(vertex) {
        let previous = Topology::previous(h);
        let triangle = domain.macro_triangle(h / 3);
        points.push(scale(0.5 * splits[h as usize], vectors[h as usize]));
        points.push(scale(0.5, triangle.centre_from((h % 3) as usize)));
        if domain.topology().twin(previous) == NONE {
            let at = previous as usize;
            points.push(scale(-0.5 * (1.0 - splits[at]), vectors[at]));
        }
    }
    points
}

fn smallest_triangle(points: &[[f64; 2]]) -> PowellSabinTriangle {
    let radius = points.iter().fold(0.0_f64, |max, &p| max.max(norm(p)));
    let unit: Vec<[f64; 2]> = points.iter().map(|&p| scale(1.0 / radius, p)).collect();
    let hull = convex_hull(&unit);
    let doubled: f64 = (0..hull.len())
        .map(|i| cross(hull[i], hull[(i + 1) % hull.len()]))
        .sum();
    let mut best: Option<(f64, [[f64; 2]; 3])> = None;
    for corners in candidates(&hull) {
        let area = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]));
        // Less than the hull cannot hold the hull: a candidate of rounding.
        let possible = area >= doubled * (1.0 - 1e-9) && holds(corners, &hull);
        if possible && best.is_none_or(|(smallest, _)| area < smallest) {
            best = Some((area, corners));
        }
    }
    let corners = best.map_or_else(around_circle, |(_, corners)| corners);
    grown(corners.map(|corner| scale(radius, corner)), points)
}

/// Returns an equilateral triangle around the unit circle.
fn around_circle() -> [[f64; 2]; 3] {
    let half = 3.0_f64.sqrt();
    [[2.0, 0.0], [-1.0, half], [-1.0, -half]]
}

/// Grows a triangle about its centroid until no point has a negative coordinate.
fn grown(corners: [[f64; 2]; 3], points: &[[f64; 2]]) -> PowellSabinTriangle {
    let [a, b, c] = corners;
    let centroid = scale(1.0 / 3.0, add(a, add(b, c)));
    let mut growth = GROWTH;
    loop {
        let triangle = PowellSabinTriangle {
            corners: corners.map(|p| add(centroid, scale(1.0 + growth, sub(p, centroid)))),
        };
        let inside = |&p: &[f64; 2]| triangle.barycentric(p).iter().all(|&b| b >= 0.0);
        if growth > 1.0 || points.iter().all(inside) {
            return triangle;
        }
        growth *= 4.0;
    }
}

/// Returns the corners of the convex hull, counter-clockwise, without those in the middle of a side.
fn convex_hull(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut sorted = points.to_vec();
    sorted.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut hull: Vec<[f64; 2]> = Vec::new();
    for pass in 0..2 {
        let start = hull.len();
        for &point in &sorted {
            while hull.len() >= start + 2 {
                let (last, before) = (hull[hull.len() - 1], hull[hull.len() - 2]);
                let chord = sub(point, before);
                // The distance of the last corner from the chord, not its area.
                if cross(sub(last, before), chord) > COLLINEAR * norm(chord) {
                    break;
                }
                hull.pop();
            }
            hull.push(point);
        }
        hull.pop();
        if pass == 0 {
            sorted.reverse();
        }
    }
    hull
}

/// Returns where the lines through two sides meet.
fn meet(hull: &[[f64; 2]], i: usize, j: usize) -> Option<[f64; 2]> {
    let count = hull.len();
    let (a, b) = (hull[i], hull[j]);
    let (along, other) = (sub(hull[(i + 1) % count], a), sub(hull[(j + 1) % count], b));
    let sine = cross(along, other);
    (sine.abs() > PARALLEL * norm(along) * norm(other))
        .then(|| add(a, scale(cross(sub(b, a), other) / sine, along)))
}

/// Returns triangles of three sides along the hull, and of two with a corner of the hull in the middle
/// of the third.
fn candidates(hull: &[[f64; 2]]) -> Vec<[[f64; 2]; 3]> {
    let count = hull.len();
    let tried = count.min(SIDES);
    let sides: Vec<usize> = (0..tried).map(|k| k * count / tried).collect();
    let mut found = Vec::new();
    for (first, &i) in sides.iter().enumerate() {
        for (second, &j) in sides.iter().enumerate().skip(first + 1) {
            let Some(apex) = meet(hull, i, j) else {
                continue;
            };
            for &k in &sides[second + 1..] {
                if let (Some(next), Some(last)) = (meet(hull, j, k), meet(hull, k, i)) {
                    found.push([apex, next, last]);
                }
            }
            let [along, other] = [i, j].map(|s| sub(hull[(s + 1) % count], hull[s]));
            let sine = cross(along, other);
            for &middle in hull {
                // Twice the way to the middle, in the two directions from the apex.
                let way = scale(2.0, sub(middle, apex));
                let one = add(apex, scale(cross(way, other) / sine, along));
                let two = add(apex, scale(cross(along, way) / sine, other));
                let left = cross(sub(one, apex), sub(two, apex)) > 0.0;
                let corners = if left {
                    [apex, one, two]
                } else {
                    [apex, two, one]
                };
                found.push(corners);
            }
        }
    }
    found
}

/// Whether a triangle holds all points, up to the tolerance of the hull.
fn holds([a, b, c]: [[f64; 2]; 3], hull: &[[f64; 2]]) -> bool {
    let sides = [(a, b), (b, c), (c, a)];
    sides.iter().all(|&(from, to)| {
        let side = sub(to, from);
        let length = norm(side);
        dot(side, side) > 0.0
            && hull
                .iter()
                .all(|&p| cross(side, sub(p, from)) >= -10.0 * COLLINEAR * length)
    })
}
