//! Squeezed cells of a map without folds, given room vertex by vertex.
//!
//! Where a determinant is nearly zero, descents in all unknowns together move by tiny steps. One
//! vertex at a time, with all others fixed, the energy is convex, and Newton's method is at home.
//!
//! # Notation
//! Moving corner k by `δ` changes `J` by `δ gᵀ` and `D = det J` by `δ . c`, where `g` is the gradient
//! of the corner's barycentric coordinate at rest and `c = cof(J) g`; `q` is `|J|²`. The energy of a
//! cell is `q D^(-2/3) + D + 1/D` times its volume.

use msplines_common::mesh::tet::TetMesh;
use nalgebra::{Matrix3, Vector3};

use super::measure::{determinants, image};
use crate::domain::cube::free_axes;

/// Cells whose determinant is below this, the mean being 1, are given room.
const SQUEEZED: f64 = 0.02;

/// Most sweeps over all of their vertices.
const SWEEPS: usize = 30;

/// Most halvings of a step.
const HALVINGS: usize = 20;

/// Gives squeezed cells room; no cell folds. Returns the sweeps.
pub(super) fn lift(mesh: &TetMesh, masks: &[u8], parameters: &mut [[f64; 3]]) -> u32 {
    let volume: f64 = (0..mesh.cell_count() as u32)
        .map(|cell| mesh.signed_volume(cell))
        .sum();
    let scale = volume.cbrt().recip();
    for sweep in 0..SWEEPS {
        let squeezed = determinants(mesh, &image(mesh, parameters));
        let cells = mesh
            .cells()
            .iter()
            .zip(squeezed)
            .filter(|cell| cell.1 < SQUEEZED);
        let mut vertices: Vec<u32> = cells.flat_map(|cell| *cell.0).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let mut moved = false;
        for vertex in vertices {
            let star = Star::new(mesh, vertex, scale);
            moved |= star.improve(free_axes(masks[vertex as usize]), parameters);
        }
        if !moved {
            return sweep as u32;
        }
    }
    SWEEPS as u32
}

/// The cells around a vertex, which is the first corner of each.
struct Star {
    vertex: u32,
    cells: Vec<([u32; 3], Matrix3<f64>, f64)>,
}

impl Star {
    fn new(mesh: &TetMesh, vertex: u32, scale: f64) -> Self {
        let around = mesh.topology().vertex_cells(vertex).iter();
        let cells = around.filter_map(|&cell| {
            let [a, b, c, d] = mesh.cells()[cell as usize];
            // The vertex first, by a rotation of three corners, which keeps the orientation.
            let others = match vertex {
                v if v == a => [b, c, d],
                v if v == b => [a, d, c],
                v if v == c => [d, a, b],
                _ => [c, b, a],
            };
            let at = |v: u32| mesh.positions()[v as usize] * scale;
            let edges = Matrix3::from_columns(&others.map(|v| at(v) - at(vertex)));
            edges
                .try_inverse()
                .map(|inverse| (others, inverse, edges.determinant()))
        });
        Self {
            vertex,
            cells: cells.collect(),
        }
    }

    /// Returns `J` of a cell with the vertex at `at`.
    fn jacobian(&self, cell: usize, at: &Vector3<f64>, parameters: &[[f64; 3]]) -> Matrix3<f64> {
        let (others, inverse, _) = &self.cells[cell];
        let edge = |v: u32| Vector3::from(parameters[v as usize]) - at;
        Matrix3::from_columns(&others.map(edge)) * inverse
    }

    /// Returns the energy with the vertex at `at`, infinite if a cell is not positive.
    fn energy(&self, at: &Vector3<f64>, parameters: &[[f64; 3]]) -> f64 {
        let mut sum = 0.0;
        for (cell, &(_, _, weight)) in self.cells.iter().enumerate() {
            let jacobian = self.jacobian(cell, at, parameters);
            let det = jacobian.determinant();
            if det <= 0.0 {
                return f64::INFINITY;
            }
            sum += weight * (jacobian.norm_squared() / (det * det).cbrt() + det + 1.0 / det);
        }
        sum
    }

    /// Returns Newton's step of the coordinates that are free.
    fn step(&self, free: [bool; 3], at: &Vector3<f64>, parameters: &[[f64; 3]]) -> Vector3<f64> {
        let (mut gradient, mut hessian) = (Vector3::zeros(), Matrix3::zeros());
        for (cell, &(_, inverse, weight)) in self.cells.iter().enumerate() {
            let j = self.jacobian(cell, at, parameters);
            let columns = [0, 1, 2].map(|k| j.column(k).into_owned());
            let [x, y, z] = &columns;
            let g = -inverse.row_sum().transpose();
            let c = Matrix3::from_columns(&[y.cross(z), z.cross(x), x.cross(y)]) * g;
            let (det, square) = (j.determinant(), j.norm_squared());
            let root = (det * det).cbrt().recip();
            let by_det = -2.0 / 3.0 * square * root / det + 1.0 - 1.0 / (det * det);
            let twice = 10.0 / 9.0 * square * root / (det * det) + 2.0 / det.powi(3);
            let by_square = 2.0 * (j * g);
            let mixed = by_square * c.transpose() * (-2.0 / 3.0 * root / det);
            gradient += weight * (root * by_square + by_det * c);
            hessian += weight
                * (Matrix3::identity() * (2.0 * g.norm_squared() * root)
                    + twice * c * c.transpose()
                    + mixed
                    + mixed.transpose());
        }
        for axis in (0..3).filter(|&axis| !free[axis]) {
            gradient[axis] = 0.0;
            hessian.fill_row(axis, 0.0);
            hessian.fill_column(axis, 0.0);
            hessian[(axis, axis)] = 1.0;
        }
        hessian
            .cholesky()
            .map_or_else(Vector3::zeros, |factor| -factor.solve(&gradient))
    }

    /// Moves the vertex to where the energy is less. Returns whether that made a difference.
    fn improve(&self, free: [bool; 3], parameters: &mut [[f64; 3]]) -> bool {
        let at = Vector3::from(parameters[self.vertex as usize]);
        let mut step = self.step(free, &at, parameters);
        let before = self.energy(&at, parameters);
        for _ in 0..HALVINGS {
            let there = at + step;
            let energy = self.energy(&there, parameters);
            if energy < before {
                parameters[self.vertex as usize] = there.into();
                return energy < (1.0 - 1e-3) * before;
            }
            step *= 0.5;
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use msplines_common::mesh::shapes::box_solid;

    use super::*;

    #[test]
    fn newton_steps_are_those_of_differences() {
        let mesh = box_solid([2, 2, 2]);
        let mut parameters: Vec<[f64; 3]> =
            mesh.positions().iter().map(|p| (p / 2.0).into()).collect();
        parameters[13] = [0.6, 0.35, 0.55];
        let star = Star::new(&mesh, 13, 0.5);
        let at = Vector3::from(parameters[13]);
        const H: f64 = 1e-4;
        let shifted = |axes: &[(usize, f64)]| {
            let mut there = at;
            axes.iter().for_each(|&(axis, h)| there[axis] += h);
            star.energy(&there, &parameters)
        };
        let gradient =
            Vector3::from_fn(|i, _| (shifted(&[(i, H)]) - shifted(&[(i, -H)])) / (2.0 * H));
        let hessian = Matrix3::from_fn(|i, j| {
            let [pp, pm, mp, mm] =
                [(H, H), (H, -H), (-H, H), (-H, -H)].map(|(a, b)| shifted(&[(i, a), (j, b)]));
            (pp - pm - mp + mm) / (4.0 * H * H)
        });
        let expected = -hessian.try_inverse().unwrap() * gradient;
        let step = star.step([true; 3], &at, &parameters);
        assert!(
            (step - expected).norm() < 1e-4 * expected.norm(),
            "{step} {expected}"
        );
        let step = star.step([true, false, true], &at, &parameters);
        assert_eq!(step.y, 0.0);
    }

    #[test]
    fn a_squeezed_vertex_is_lifted() {
        let mesh = box_solid([2, 2, 2]);
        let mut parameters: Vec<[f64; 3]> =
            mesh.positions().iter().map(|p| (p / 2.0).into()).collect();
        parameters[13] = [0.5, 0.5, 1e-7];
        let masks: Vec<u8> = (0..27)
            .map(|v| if v == 13 { 0 } else { 0b11_1111 })
            .collect();
        assert!(lift(&mesh, &masks, &mut parameters) > 0);
        assert!(
            determinants(&mesh, &image(&mesh, &parameters))
                .iter()
                .all(|&det| det > SQUEEZED)
        );
    }
}
