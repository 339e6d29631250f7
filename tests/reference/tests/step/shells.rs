//! Shells of patches: the patches, and how they are sewn.

use std::f64::consts::{FRAC_PI_2, TAU};

use msplines_common::bspline::{
    BezierCurve, BezierEdge, BezierFace, BezierShell, EdgeUse, ShellError,
};
use nalgebra::{Matrix3, Point3, Vector3};

/// A patch whose boundary is not known yet.
pub(crate) type Patch = BezierFace;

/// Rounding of points of size 1 by a few steps of de Casteljau's algorithm.
const ROUNDING: f64 = 1e-13;
/// Parameters of a side at which another patch may end.
const PARTS: usize = 12;

fn patch(degree: [usize; 2], points: Vec<Point3<f64>>, weights: Option<Vec<f64>>) -> Patch {
    BezierFace {
        degree,
        points,
        weights,
        boundary: Vec::new(),
    }
}

/// Patches around a torus, and around its tube.
const AROUND: [usize; 2] = [4, 3];

/// Returns the bicubic patches that have a torus's points and derivatives at their corners.
pub(crate) fn torus() -> Vec<Patch> {
    let step = AROUND.map(|n| TAU / n as f64);
    // The point, or its derivatives by an angle, each times the angle of a patch over three.
    let point = |at: [f64; 2], order: [usize; 2]| {
        let [angle, tube] = [0, 1].map(|d| {
            let scale = (step[d] / 3.0).powi(order[d] as i32);
            let turned = at[d] + FRAC_PI_2 * order[d] as f64;
            [turned.cos() * scale, turned.sin() * scale]
        });
        let radius = 0.4 * tube[0] + if order[1] == 0 { 1.0 } else { 0.0 };
        let height = if order[0] == 0 { 0.4 * tube[1] } else { 0.0 };
        Vector3::new(radius * angle[0], radius * angle[1], height)
    };
    let corners = (0..AROUND[1]).flat_map(|j| (0..AROUND[0]).map(move |i| [i, j]));
    let patches = corners.map(|corner| {
        let places = (0..4).flat_map(|j| (0..4).map(move |i| [i, j]));
        let points = places.map(|place: [usize; 2]| {
            // The corner of the patch that is near, and the way from it to the control point.
            let near = place.map(|x| x / 2);
            let way = place.map(|x| [0.0, 1.0, -1.0, 0.0][x]);
            // Angles that are a whole turn apart are one.
            let at = [0, 1].map(|d| step[d] * ((corner[d] + near[d]) % AROUND[d]) as f64);
            let sum = point(at, [0, 0])
                + point(at, [1, 0]) * way[0]
                + point(at, [0, 1]) * way[1]
                + point(at, [1, 1]) * (way[0] * way[1]);
            Point3::from(sum)
        });
        patch([3, 3], points.collect(), None)
    });
    patches.collect()
}

/// Returns the same torus with one patch cut across at half and its neighbour at a quarter: of the three
/// edges between them one is but a piece of the sides of both.
pub(crate) fn split_torus() -> Vec<Patch> {
    let mut patches = torus();
    let [first, second] = [patches.remove(0), patches.remove(0)];
    for (whole, at) in [(first, 0.5), (second, 0.25)] {
        patches.extend([[0.0, at], [at, 1.0]].map(|range| part(&whole, 1, range)));
    }
    // And one into four.
    let whole = patches.remove(3);
    for range in [[0.0, 0.5], [0.5, 1.0]] {
        let half = part(&whole, 0, range);
        patches.extend([[0.0, 0.5], [0.5, 1.0]].map(|range| part(&half, 1, range)));
    }
    patches
}

/// Returns the eight rational octants of the sphere, biquadratic patches with one side at a pole.
pub(crate) fn octants() -> Vec<Patch> {
    let middle = 0.5_f64.sqrt();
    let arc = [([1.0, 0.0], 1.0), ([1.0, 1.0], middle), ([0.0, 1.0], 1.0)];
    let mut patches = Vec::new();
    for lower in [false, true] {
        for quarter in 0..4 {
            let (mut points, mut weights) = (Vec::new(), Vec::new());
            for j in 0..3 {
                // From the equator up, or from the lower pole to it.
                let ([radius, height], outer) = arc[if lower { 2 - j } else { j }];
                for ([x, y], inner) in arc {
                    let (x, y) = [(x, y), (-y, x), (-x, -y), (y, -x)][quarter];
                    let z = if lower { -height } else { height };
                    // No point has a zero with a sign of its own.
                    let place = [radius * x, radius * y, z].map(|c| c + 0.0);
                    points.push(Point3::from(place));
                    weights.push(inner * outer);
                }
            }
            patches.push(patch([2, 2], points, Some(weights)));
        }
    }
    patches
}

/// Returns patches turned, sheared and stretched by one matrix.
pub(crate) fn leaning(mut patches: Vec<Patch>) -> Vec<Patch> {
    let matrix = Matrix3::new(1.1, 0.4, -0.3, -0.2, 0.7, 0.5, 0.3, 0.1, 1.6);
    for point in patches.iter_mut().flat_map(|patch| &mut patch.points) {
        *point = matrix * *point;
    }
    patches
}

/// Returns a rational bicubic patch, one part of which lies beside two.
pub(crate) fn one_beside_two() -> Vec<Patch> {
    let places = (0..4).flat_map(|j| (0..4).map(move |i| [i, j].map(f64::from)));
    let points: Vec<_> = places
        .map(|[i, j]| Point3::new(i, j + 0.1 * (i * j).cos(), (i - 0.5 * j).sin()))
        .collect();
    let weights = (0..16).map(|at| 1.0 + 0.3 * f64::from(at * at).sin());
    let whole = patch([3, 3], points, Some(weights.collect()));
    let [left, right] = [[0.0, 0.4], [0.4, 1.0]].map(|range| part(&whole, 0, range));
    let halves = [[0.0, 0.5], [0.5, 1.0]].map(|range| part(&right, 1, range));
    [left].into_iter().chain(halves).collect()
}

/// Returns the part of a patch over a range of its first or second parameter.
fn part(whole: &Patch, direction: usize, range: [f64; 2]) -> Patch {
    let [a, b] = whole.degree.map(|degree| degree + 1);
    let (lines, along, across) = if direction == 0 { (b, 1, a) } else { (a, a, 1) };
    let mut found = whole.clone();
    for line in 0..lines {
        let count = whole.degree[direction] + 1;
        let places: Vec<usize> = (0..count).map(|k| line * across + k * along).collect();
        let weights = whole.weights.as_ref();
        let curve = BezierCurve {
            points: places.iter().map(|&at| whole.points[at]).collect(),
            weights: weights.map(|w| places.iter().map(|&at| w[at]).collect()),
        };
        let piece = curve.piece(range);
        for (k, &at) in places.iter().enumerate() {
            found.points[at] = piece.points[k];
            if let (Some(into), Some(from)) = (&mut found.weights, &piece.weights) {
                into[at] = from[k];
            }
        }
    }
    found
}

/// Returns patches sewn where they meet: a side ends wherever another patch has a corner on it.
pub(crate) fn sew(patches: &[Patch]) -> Result<BezierShell, ShellError> {
    let is_near = |p: &Point3<f64>, q: &Point3<f64>| (p - q).norm() <= ROUNDING * 10.0;
    let mut vertices: Vec<Point3<f64>> = Vec::new();
    for patch in patches {
        for corner in (0..4).map(|side| patch.side(side).points[0]) {
            if !vertices.iter().any(|vertex| is_near(vertex, &corner)) {
                vertices.push(corner);
            }
        }
    }
    let mut edges: Vec<BezierEdge> = Vec::new();
    let mut faces = patches.to_vec();
    for face in &mut faces {
        let sides = [0, 1, 2, 3].map(|side| face.side(side));
        for side in sides {
            if side
                .points
                .iter()
                .all(|point| is_near(point, &side.points[0]))
            {
                continue;
            }
            let stops = (0..=PARTS).filter_map(|k| {
                let at = k as f64 / PARTS as f64;
                let place = side.position(at);
                let vertex = vertices.iter().position(|v| is_near(v, &place))?;
                Some((at, vertex as u32))
            });
            let stops: Vec<_> = stops.collect();
            for pair in stops.windows(2) {
                let [(from, start), (to, end)] = [pair[0], pair[1]];
                let known = edges.iter().position(|edge| edge.ends == [end, start]);
                face.boundary.push(EdgeUse {
                    edge: known.unwrap_or(edges.len()) as u32,
                    reversed: known.is_some(),
                });
                if known.is_none() {
                    edges.push(BezierEdge {
                        ends: [start, end],
                        curve: side.piece([from, to]),
                    });
                }
            }
        }
    }
    BezierShell::build(vertices, edges, faces, ROUNDING * 10.0)
}
