//! How much patches are distorted, and less of it.
//!
//! # Notation
//! `J` the Jacobian of the map from a triangle of the surface to the square, the surface scaled to
//! the area 6 of the cube. The energy is the mean of `|J|² + |J⁻¹|²`: 4 where `J` is a rotation.

use msplines_common::mesh::TriangleMesh;
use rayon::prelude::*;

use crate::domain::cube::{face_axes, free_axes};
use crate::domain::descent::{Limits, minimise};

/// Triangles of one task.
const CHUNK: usize = 1024;

/// A step that lowers the energy by less ends the descent.
const PROGRESS: f64 = 1e-6;

/// The triangles of a surface at rest.
pub(super) struct Distortion<'a> {
    surface: &'a TriangleMesh,
    labels: &'a [u8],
    /// Inverse of the edge matrix, upper triangular, and the share of the area.
    rest: Vec<[f64; 4]>,
}

impl<'a> Distortion<'a> {
    pub(super) fn new(surface: &'a TriangleMesh, labels: &'a [u8]) -> Self {
        let faces = 0..surface.face_count() as u32;
        let area: f64 = faces
            .clone()
            .map(|f| 0.5 * surface.face_normal(f).norm())
            .sum();
        let scale = (6.0 / area).sqrt();
        let rest = faces
            .map(|face| {
                let [a, b, c] = surface.triangle(face);
                let (u, v) = ((b - a) * scale, (c - a) * scale);
                let length = u.norm();
                let (x, y) = (v.dot(&u) / length, u.cross(&v).norm() / length);
                [
                    1.0 / length,
                    -x / (length * y),
                    1.0 / y,
                    0.5 * length * y / 6.0,
                ]
            })
            .collect();
        Self {
            surface,
            labels,
            rest,
        }
    }

    /// Returns the energy, infinite if a triangle is not positive.
    pub(super) fn energy(&self, parameters: &[[f64; 3]]) -> f64 {
        let flat = parameters.as_flattened();
        let parts: Vec<f64> = (0..self.rest.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|face| self.triangle(face, flat).0)
            .collect();
        parts.iter().sum()
    }

    /// Returns the energy of a triangle and its gradient by the second and third corner.
    fn triangle(&self, face: usize, x: &[f64]) -> (f64, [[f64; 2]; 2]) {
        let [u, v] = face_axes(self.labels[face].into());
        let corners = self.surface.faces()[face].map(|vertex| {
            let at = 3 * vertex as usize;
            [x[at + u], x[at + v]]
        });
        let [p, q, weight_y, share] = self.rest[face];
        let side = |k: usize, d: usize| corners[k][d] - corners[0][d];
        // J = [b - a, c - a] R with R upper triangular.
        let j = [0, 1].map(|d| [side(1, d) * p, side(1, d) * q + side(2, d) * weight_y]);
        let det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
        if det <= 0.0 {
            return (f64::INFINITY, [[0.0; 2]; 2]);
        }
        let square = j.as_flattened().iter().map(|a| a * a).sum::<f64>();
        let inverse = 1.0 / (det * det);
        let (by_square, by_det) = (
            2.0 * share * (1.0 + inverse),
            -2.0 * share * square * inverse / det,
        );
        let cofactor = [[j[1][1], -j[1][0]], [-j[0][1], j[0][0]]];
        let by_j = |d: usize, k: usize| by_square * j[d][k] + by_det * cofactor[d][k];
        let gradient = [
            [0, 1].map(|d| by_j(d, 0) * p + by_j(d, 1) * q),
            [0, 1].map(|d| by_j(d, 1) * weight_y),
        ];
        (share * square * (1.0 + inverse), gradient)
    }

    /// Lowers the energy while vertices slide in the faces and along the edges of the cube.
    pub(super) fn relax(&self, masks: &[u8], parameters: &mut [[f64; 3]], evaluations: u32) -> u32 {
        let free: Vec<bool> = masks.iter().flat_map(|&mask| free_axes(mask)).collect();
        let diagonal = self.diagonal(masks.len());
        let precondition = |g: &mut [f64]| {
            g.iter_mut().zip(&diagonal).for_each(|(g, d)| *g /= d);
        };
        let limits = Limits {
            evaluations: evaluations as usize,
            progress: PROGRESS,
        };
        let objective = |x: &[f64], g: &mut [f64]| self.objective(&free, x, g);
        minimise(
            parameters.as_flattened_mut(),
            limits,
            &precondition,
            objective,
        )
        .evaluations as u32
    }

    fn objective(&self, free: &[bool], x: &[f64], gradient: &mut [f64]) -> f64 {
        let parts: Vec<(f64, [[f64; 2]; 2])> = (0..self.rest.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(|face| self.triangle(face, x))
            .collect();
        gradient.fill(0.0);
        let mut energy = 0.0;
        for (face, (part, by_corner)) in parts.iter().enumerate() {
            energy += part;
            let axes = face_axes(self.labels[face].into());
            let corners = self.surface.faces()[face].map(|vertex| 3 * vertex as usize);
            for (d, axis) in axes.into_iter().enumerate() {
                gradient[corners[0] + axis] -= by_corner[0][d] + by_corner[1][d];
                gradient[corners[1] + axis] += by_corner[0][d];
                gradient[corners[2] + axis] += by_corner[1][d];
            }
        }
        for (g, _) in gradient.iter_mut().zip(free).filter(|(_, free)| !**free) {
            *g = 0.0;
        }
        energy
    }

    /// Returns the diagonal of the Laplacian, for every coordinate.
    fn diagonal(&self, vertices: usize) -> Vec<f64> {
        let mut diagonal = vec![0.0; 3 * vertices];
        for (face, [p, q, r, share]) in self.rest.iter().enumerate() {
            let squares = [p * p + (q + r) * (q + r), p * p + q * q, r * r];
            for (&vertex, square) in self.surface.faces()[face].iter().zip(squares) {
                (0..3).for_each(|d| diagonal[3 * vertex as usize + d] += share * square);
            }
        }
        diagonal
    }
}

#[cfg(test)]
mod tests {
    use msplines_common::mesh::shapes::box_solid;

    use super::*;

    #[test]
    fn gradients_are_those_of_differences() {
        let surface = box_solid([1, 1, 1]).boundary();
        let labels = vec![1u8; surface.face_count()];
        let distortion = Distortion::new(&surface, &labels);
        let mut x: Vec<f64> = (0..24).map(|i| f64::from(i * i % 7) / 7.0).collect();
        let corners = surface.faces()[3];
        for (vertex, [u, v]) in corners.iter().zip([[0.1, 0.2], [0.9, 0.1], [0.3, 0.8]]) {
            (x[3 * *vertex as usize + 1], x[3 * *vertex as usize + 2]) = (u, v);
        }
        let (value, gradient) = distortion.triangle(3, &x);
        assert!(value > 4.0 * distortion.rest[3][3]);
        for corner in 1..3 {
            for (d, slope) in gradient[corner - 1].iter().enumerate() {
                let at = 3 * corners[corner] as usize + 1 + d;
                let mut moved = x.clone();
                moved[at] += 1e-6;
                let up = distortion.triangle(3, &moved).0;
                moved[at] -= 2e-6;
                let down = distortion.triangle(3, &moved).0;
                let difference = (up - down) / 2e-6;
                assert!((difference - slope).abs() < 1e-7 * value.max(1.0));
            }
        }
    }
}
