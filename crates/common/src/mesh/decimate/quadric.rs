//! Quadric errors: weighted sums of squared distances to planes.

use std::ops::Add;

use nalgebra::{Matrix3, Point3, Vector3};

use crate::mesh::NONE;
use crate::mesh::topology::Topology;
use crate::mesh::triangle::TriangleMesh;

/// Weight of the planes that hold a boundary, against those of faces of the same size.
const BOUNDARY_WEIGHT: f64 = 10.0;

/// A matrix whose determinant is below this fraction of its cubed mean eigenvalue has a direction
/// in which the error hardly grows; the best place along it would be far away.
const SINGULAR: f64 = 1e-4;

/// The function `pᵀ A p + 2 bᵀ p + c`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Quadric {
    a: Matrix3<f64>,
    b: Vector3<f64>,
    c: f64,
}

impl Quadric {
    const ZERO: Self = Self {
        a: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        b: Vector3::new(0.0, 0.0, 0.0),
        c: 0.0,
    };

    /// Returns `weight` times the squared distance to the plane through `point` across the unit
    /// vector `normal`.
    fn plane(point: &Point3<f64>, normal: &Vector3<f64>, weight: f64) -> Self {
        let offset = -normal.dot(&point.coords);
        let scaled = normal * weight;
        Self {
            a: scaled * normal.transpose(),
            b: scaled * offset,
            c: weight * offset * offset,
        }
    }

    fn value(&self, p: &Point3<f64>) -> f64 {
        // Rounding may leave a tiny negative number.
        (p.coords.dot(&(self.a * p.coords + self.b * 2.0)) + self.c).max(0.0)
    }

    /// Returns the least error and where it is taken: at the minimum if that is near the edge from
    /// `from` to `to`, else at the best of its ends and its midpoint.
    pub(super) fn best_position(&self, from: Point3<f64>, to: Point3<f64>) -> (f64, Point3<f64>) {
        let middle = from + (to - from) * 0.5;
        let mean = self.a.trace() / 3.0;
        if self.a.determinant() > SINGULAR * mean * mean * mean
            && let Some(inverse) = self.a.try_inverse()
        {
            let best = Point3::from(-(inverse * self.b));
            if (best - middle).norm_squared() <= (to - from).norm_squared() {
                return (self.value(&best), best);
            }
        }
        let tried = [middle, from, to].map(|p| (self.value(&p), p));
        tried.into_iter().fold(
            tried[0],
            |best, next| if next.0 < best.0 { next } else { best },
        )
    }
}

impl Add for Quadric {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            a: self.a + other.a,
            b: self.b + other.b,
            c: self.c + other.c,
        }
    }
}

/// Returns the quadric of each vertex: the planes of its faces, weighted by area, and planes across
/// the boundary.
pub(super) fn of_vertices(mesh: &TriangleMesh) -> Vec<Quadric> {
    let mut quadrics = vec![Quadric::ZERO; mesh.vertex_count()];
    for (face, corners) in mesh.faces().iter().enumerate() {
        let normal = mesh.face_normal(face as u32);
        let Some(unit) = normal.try_normalize(0.0) else {
            continue;
        };
        let triangle = mesh.triangle(face as u32);
        let plane = Quadric::plane(&triangle[0], &unit, 0.5 * normal.norm());
        for &vertex in corners {
            quadrics[vertex as usize] = quadrics[vertex as usize] + plane;
        }
        for half_edge in 3 * face as u32..3 * face as u32 + 3 {
            if mesh.topology().twin(half_edge) != NONE {
                continue;
            }
            let ends = [half_edge, Topology::next(half_edge)].map(|h| mesh.topology().origin(h));
            let [a, b] = ends.map(|v| mesh.positions()[v as usize]);
            if let Some(across) = (b - a).cross(&unit).try_normalize(0.0) {
                let weight = BOUNDARY_WEIGHT * (b - a).norm_squared();
                let wall = Quadric::plane(&a, &across, weight);
                for vertex in ends {
                    quadrics[vertex as usize] = quadrics[vertex as usize] + wall;
                }
            }
        }
    }
    quadrics
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_planes_meet_in_the_best_position() {
        let corner = Point3::new(0.3, -0.2, 0.5);
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let sum = axes
            .iter()
            .map(|normal| Quadric::plane(&corner, normal, 2.0))
            .fold(Quadric::ZERO, Add::add);
        let away = corner + Vector3::new(0.1, 0.0, 0.2);
        assert!((sum.value(&away) - 2.0 * 0.05).abs() < 1e-15);
        let (error, best) = sum.best_position(away, corner - Vector3::new(0.1, 0.3, 0.0));
        assert!(error < 1e-15 && (best - corner).norm() < 1e-15);
    }
}
