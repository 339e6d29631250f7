//! Lowering the distortion of single triangles that the harmonic map leaves far from conformal.
//!
//! Behind a neck of three edges the triangles of a whole limb fit into one, and some of them come
//! out as slivers. Their corners move to where the triangles around them are least stretched; the
//! rest of the map stays harmonic, which is smoother than what is best for every triangle alone.
//!
//! # Notation
//! `E = Σ A (σ₁ / σ₂ + σ₂ / σ₁)` over the triangles around a vertex, with their areas `A` on the
//! surface. It is infinite where a triangle is about to turn over.

use msplines_common::mesh::Topology;
use msplines_common::operators::intrinsic::IntrinsicTriangulation;
use nalgebra::{Matrix2, Vector2, Vector3};

use crate::extension::ends;
use crate::measure::spherical_stretches;
use crate::untangle::{Stars, tangent_frame};

/// Corners of triangles with a larger ratio of singular values are moved.
const STRETCHED: f64 = 2.0;

/// Passes over these corners; most of what can be gained is gained in the first few.
const PASSES: usize = 8;

/// Newton steps of one vertex in one pass. From beside an edge each step goes half as far again.
const STEPS: usize = 12;

/// Halvings of a step that raises the energy.
const HALVINGS: usize = 6;

/// Lowers the angle distortion of a map onto the unit sphere; no triangle is turned over by it.
///
/// # Reference
/// [Hormann2000]. Deviation: triangles are weighted by their areas on the surface, and vertices
/// move only where triangles are stretched.
pub(crate) fn polish_sphere(triangulation: &IntrinsicTriangulation, points: &mut [Vector3<f64>]) {
    let stars = Stars::of(triangulation, points.len());
    for _ in 0..PASSES {
        for vertex in stretched(triangulation, points) {
            let Some(fan) = stars.fan(vertex) else {
                continue;
            };
            for _ in 0..STEPS {
                if !relax(triangulation, &fan, vertex as usize, points) {
                    break;
                }
            }
        }
    }
}

/// Returns the corners of stretched triangles, each once, ascending.
fn stretched(triangulation: &IntrinsicTriangulation, points: &[Vector3<f64>]) -> Vec<u32> {
    let stretches = spherical_stretches(&triangulation.faces, &triangulation.lengths, points);
    let faces = triangulation.faces.iter().zip(&stretches);
    let mut vertices: Vec<u32> = faces
        .filter(|(_, stretch)| stretch.anisotropy > STRETCHED)
        .flat_map(|(corners, _)| *corners)
        .collect();
    vertices.sort_unstable();
    vertices.dedup();
    vertices
}

/// Moves a vertex, given its outgoing half-edges, if that lowers the energy around it; returns
/// whether it did.
fn relax(
    triangulation: &IntrinsicTriangulation,
    fan: &[u32],
    vertex: usize,
    points: &mut [Vector3<f64>],
) -> bool {
    let centre = points[vertex];
    let [first, second] = tangent_frame(centre);
    // Stereographic from the opposite point: angles stay, and the vertex is at zero.
    let project = |v: u32| {
        let offset = points[v as usize] - centre;
        let scale = 1.0 / (1.0 + points[v as usize].dot(&centre));
        Vector2::new(offset.dot(&first), offset.dot(&second)) * scale
    };
    let corner = |&h: &u32| Corner {
        b: project(ends(triangulation, h)[1]),
        c: project(ends(triangulation, Topology::previous(h))[0]),
        shape: shape(triangulation, h),
    };
    let star: Vec<Corner> = fan.iter().map(corner).collect();
    let step = best_step(&star);
    if let Some(step) = step {
        let square = step.norm_squared();
        let flat = first * (2.0 * step.x) + second * (2.0 * step.y);
        points[vertex] = ((centre * (1.0 - square) + flat) / (1.0 + square)).normalize();
    }
    step.is_some()
}

/// A triangle around the vertex at zero, its other corners counter-clockwise.
struct Corner {
    b: Vector2<f64>,
    c: Vector2<f64>,
    /// See [`shape`].
    shape: [f64; 3],
}

impl Corner {
    /// Returns the energy with the vertex at `p`, infinite where the triangle does not turn left.
    fn energy(&self, p: Vector2<f64>) -> f64 {
        let (x, y) = (self.b - p, self.c - p);
        let twice = x.perp(&y);
        if twice > 0.0 {
            self.numerator(x, y) / twice
        } else {
            f64::INFINITY
        }
    }

    fn numerator(&self, x: Vector2<f64>, y: Vector2<f64>) -> f64 {
        let [xx, yy, xy] = self.shape;
        xx * x.norm_squared() + yy * y.norm_squared() + xy * x.dot(&y)
    }

    /// Returns gradient and Hessian of the energy at zero.
    fn derivatives(&self) -> (Vector2<f64>, Matrix2<f64>) {
        let (x, y) = (self.b, self.c);
        let [xx, yy, xy] = self.shape;
        let (n, d) = (self.numerator(x, y), x.perp(&y));
        let dn = -(x * (2.0 * xx + xy) + y * (2.0 * yy + xy));
        let ddn = Matrix2::identity() * (2.0 * (xx + yy + xy));
        // The doubled area is linear in the vertex.
        let side = y - x;
        let dd = Vector2::new(-side.y, side.x);
        let gradient = (dn - dd * (n / d)) / d;
        let hessian = (ddn - (gradient * dd.transpose() + dd * gradient.transpose())) / d;
        (gradient, hessian)
    }
}

/// Returns the coefficients of `|x|²`, `|y|²` and `x · y` in the numerator of the energy, for the
/// images `x` and `y` of a half-edge and of the way from its origin to the third corner.
///
/// With the sides `l` and `k` of the surface, the map has `‖J‖² = (|x|² k² + |y|² l² - 2 (x·y)(l·k)) /
/// (2 A)²` and `det J = x × y / 2 A`, so that `A ‖J‖² / det J` has the denominator `2 x × y`.
fn shape(triangulation: &IntrinsicTriangulation, half_edge: u32) -> [f64; 3] {
    let side = |h: u32| triangulation.lengths[(h / 3) as usize][(h % 3) as usize];
    let [l, opposite, k] = [
        half_edge,
        Topology::next(half_edge),
        Topology::previous(half_edge),
    ]
    .map(side);
    // Of the two sides from the origin, as vectors on the surface.
    let product = 0.5 * (l * l + (k - opposite) * (k + opposite));
    [0.5 * k * k, 0.5 * l * l, -product]
}

/// Returns a step of the vertex from zero that lowers the energy.
fn best_step(star: &[Corner]) -> Option<Vector2<f64>> {
    let energy = |p: Vector2<f64>| star.iter().map(|corner| corner.energy(p)).sum::<f64>();
    let start = energy(Vector2::zeros());
    if !start.is_finite() {
        return None;
    }
    let mut gradient = Vector2::zeros();
    let mut hessian = Matrix2::zeros();
    for corner in star {
        let (own, curvature) = corner.derivatives();
        gradient += own;
        hessian += curvature;
    }
    let (trace, determinant) = (hessian.trace(), hessian.determinant());
    if !(trace > 0.0 && determinant > 0.0) {
        return None;
    }
    let mut step = -hessian.try_inverse()? * gradient;
    for _ in 0..HALVINGS {
        if energy(step) < start {
            return Some(step);
        }
        step *= 0.5;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_energy() {
        let corner = Corner {
            b: Vector2::new(1.0, 0.2),
            c: Vector2::new(-0.1, 0.8),
            shape: [0.7, 0.9, -0.3],
        };
        let (gradient, hessian) = corner.derivatives();
        // Differences of second order: cubic terms of size one leave their square.
        let step = 1e-4;
        for axis in 0..2 {
            let unit = Vector2::ith(axis, step);
            let [ahead, here, behind] = [1.0, 0.0, -1.0].map(|s| corner.energy(unit * s));
            assert!(((ahead - behind) / (2.0 * step) - gradient[axis]).abs() < 1e-6);
            let second = (ahead - 2.0 * here + behind) / (step * step);
            assert!((second - hessian[(axis, axis)]).abs() < 1e-6);
        }
        let mixed = |s: f64, t: f64| corner.energy(Vector2::new(s * step, t * step));
        let cross = mixed(1., 1.) - mixed(1., -1.) - mixed(-1., 1.) + mixed(-1., -1.);
        assert!((cross / (4.0 * step * step) - hessian[(0, 1)]).abs() < 1e-6);
    }

    #[test]
    fn the_energy_is_the_sum_of_both_ratios() {
        // A right triangle with sides 3 and 4 and area 6, stretched by 2 along the second one.
        let mesh = msplines_common::mesh::TriangleMesh::build(
            [[0., 0., 0.], [3., 0., 0.], [0., 4., 0.]]
                .map(nalgebra::Point3::from)
                .to_vec(),
            vec![[0, 1, 2]],
        );
        let triangulation =
            msplines_common::operators::intrinsic::intrinsic_delaunay(&mesh.expect("a triangle"));
        let corner = Corner {
            b: Vector2::new(3.0, 0.0),
            c: Vector2::new(0.0, 8.0),
            shape: shape(&triangulation.expect("a triangulation"), 0),
        };
        assert!((corner.energy(Vector2::zeros()) - 6.0 * 2.5).abs() < 1e-12);
    }
}
