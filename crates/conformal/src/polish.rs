//! Lowering angle distortion: each vertex moves to where the triangles around it are least stretched.
//!
//! The harmonic map weighs triangles by the areas of their images, so that where the conformal
//! factor changes from triangle to triangle the larger ones leave the distortion to the smaller.
//!
//! # Notation
//! `E = Σ A (σ₁ / σ₂ + σ₂ / σ₁)` over the triangles around a vertex, with their areas `A` on the
//! surface. It is infinite where a triangle is about to turn over.

use msplines_common::mesh::Topology;
use msplines_common::operators::intrinsic::IntrinsicTriangulation;
use nalgebra::{Matrix2, Vector2, Vector3};

use crate::extension::ends;
use crate::untangle::Stars;

/// Passes over all vertices; what is wrong from triangle to triangle is gone after a few.
const PASSES: usize = 8;

/// Halvings of a step that raises the energy.
const HALVINGS: usize = 6;

/// Lowers the angle distortion of a map onto the unit sphere; no triangle is turned over by it.
///
/// # Reference
/// [Hormann2000]. Deviation: triangles are weighted by their areas on the surface.
pub(crate) fn polish_sphere(triangulation: &IntrinsicTriangulation, points: &mut [Vector3<f64>]) {
    let stars = Stars::of(triangulation, points.len());
    let quadratics: Vec<[f64; 3]> = (0..triangulation.twins.len() as u32)
        .map(|h| shape(triangulation, h))
        .collect();
    let fans: Vec<Vec<u32>> = (0..points.len() as u32)
        .map(|v| stars.fan(v).unwrap_or_default())
        .collect();
    let mut star = Vec::new();
    for _ in 0..PASSES {
        for (v, fan) in fans.iter().enumerate() {
            let centre = points[v];
            let first = centre.cross(&Vector3::ith(centre.iamin(), 1.0)).normalize();
            let second = centre.cross(&first);
            // Stereographic from the opposite point: angles stay, and the vertex is at zero.
            let project = |p: &Vector3<f64>| {
                let scale = 1.0 / (1.0 + p.dot(&centre));
                let offset = p - centre;
                Vector2::new(offset.dot(&first), offset.dot(&second)) * scale
            };
            star.clear();
            star.extend(fan.iter().map(|&h| {
                let [_, b] = ends(triangulation, h);
                let c = ends(triangulation, Topology::previous(h))[0];
                let [b, c] = [b, c].map(|v| project(&points[v as usize]));
                Corner {
                    b,
                    c,
                    shape: quadratics[h as usize],
                }
            }));
            if let Some(step) = best_step(&star) {
                let square = step.norm_squared();
                let flat = first * (2.0 * step.x) + second * (2.0 * step.y);
                points[v] = ((centre * (1.0 - square) + flat) / (1.0 + square)).normalize();
            }
        }
    }
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
