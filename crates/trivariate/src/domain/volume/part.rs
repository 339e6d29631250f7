//! Some cells of a solid whose inner vertices may move.

use msplines_common::mesh::NONE;
use msplines_common::mesh::tet::TetMesh;
use nalgebra::{Matrix3, Vector3};

use super::foldover::{Foldover, Folds, Shape};
use crate::domain::cube::free_axes;
use crate::domain::descent::{Limits, minimise};

/// Evaluations before `ε` is chosen anew.
const EVALUATIONS_PER_EPSILON: usize = 40;

/// `ε²` where nothing is inverted, and its growth with the square of the worst determinant.
const EPSILON_FLOOR: f64 = 1e-8;
const EPSILON_GROWTH: f64 = 0.04;

/// Cells are given this much more than the least room, which makes what follows easier.
const EASE: f64 = 1e4;

/// A step that lowers the energy by less ends a descent.
const PROGRESS: f64 = 1e-10;

/// Returns the corners of some cells by numbers of their own, the vertex of each number, and in how
/// many of the cells it is.
fn number(mesh: &TetMesh, cells: &[u32]) -> (Vec<[u32; 4]>, Vec<u32>, Vec<usize>) {
    let mut numbers = vec![NONE; mesh.vertex_count()];
    let (mut vertices, mut uses) = (Vec::new(), Vec::new());
    let mut number = |vertex: u32| {
        let number = &mut numbers[vertex as usize];
        if *number == NONE {
            *number = vertices.len() as u32;
            vertices.push(vertex);
            uses.push(0);
        }
        uses[*number as usize] += 1;
        *number
    };
    let corners = cells
        .iter()
        .map(|&cell| mesh.cells()[cell as usize].map(&mut number))
        .collect();
    (corners, vertices, uses)
}

/// Some cells of a solid whose inner vertices may move.
pub(super) struct Part {
    energy: Foldover,
    pub(super) vertices: Vec<u32>,
    pub(super) free: Vec<[bool; 3]>,
    x: Vec<f64>,
    diagonal: Vec<f64>,
    /// A determinant in this part against one relative to the whole solid.
    pub(super) scale: f64,
}

impl Part {
    /// Returns the part, unless nothing can move or the cube has no room for it.
    pub(super) fn new(
        mesh: &TetMesh,
        masks: &[u8],
        parameters: &[[f64; 3]],
        cells: &[u32],
    ) -> Option<Self> {
        let (corners, vertices, inside) = number(mesh, cells);
        let free: Vec<[bool; 3]> = vertices
            .iter()
            .zip(&inside)
            .map(|(&vertex, &count)| {
                let all = mesh.topology().vertex_cells(vertex).len() == count;
                if all {
                    free_axes(masks[vertex as usize])
                } else {
                    [false; 3]
                }
            })
            .collect();
        let x: Vec<f64> = vertices
            .iter()
            .flat_map(|&v| parameters[v as usize])
            .collect();
        let edges = |corner: &dyn Fn(usize) -> Vector3<f64>| {
            let origin = corner(0);
            Matrix3::from_columns(&[corner(1) - origin, corner(2) - origin, corner(3) - origin])
        };
        let rest: Vec<Matrix3<f64>> = cells
            .iter()
            .map(|&cell| {
                let tetrahedron = mesh.tetrahedron(cell);
                edges(&|k| tetrahedron[k].coords)
            })
            .collect();
        let room: f64 = corners
            .iter()
            .map(|cell| {
                let at = |k: usize| 3 * cell[k] as usize;
                edges(&|k| Vector3::from_column_slice(&x[at(k)..at(k) + 3])).determinant()
            })
            .sum();
        let volume: f64 = rest.iter().map(Matrix3::determinant).sum();
        if room.is_nan() || room <= 0.0 || !free.iter().flatten().any(|&free| free) {
            return None;
        }
        let factor = (room / volume).cbrt();
        let rest: Vec<Matrix3<f64>> = rest.iter().map(|edges| edges * factor).collect();
        let total: f64 = (0..mesh.cell_count() as u32)
            .map(|c| mesh.signed_volume(c))
            .sum();
        let energy = Foldover::new(&corners, &rest, free.clone());
        let diagonal = energy.diagonal();
        let scale = volume / room / total;
        Some(Self {
            energy,
            vertices,
            free,
            x,
            diagonal,
            scale,
        })
    }

    pub(super) fn unfold(&mut self, shape: Shape, least: f64, evaluations: usize) -> usize {
        let mut used = 0;
        let mut before = f64::NEG_INFINITY;
        while used < evaluations {
            let worst = self.energy.smallest_determinant(&self.x);
            // What a descent has not mended, without folds not much, the same will not mend.
            let stalled = worst == before || before > 0.0 && worst < 2.0 * before;
            if worst > EASE * least || stalled {
                break;
            }
            before = worst;
            let folds = if worst > 0.0 {
                Folds::Refused
            } else {
                Folds::Allowed(EPSILON_FLOOR + EPSILON_GROWTH * worst * worst)
            };
            let limits = Limits {
                evaluations: EVALUATIONS_PER_EPSILON.min(evaluations - used),
                progress: PROGRESS,
            };
            used += self.descend(shape, folds, limits).max(1);
        }
        used
    }

    /// Lowers the energy with the diagonal of the Laplacian as preconditioner.
    pub(super) fn descend(&mut self, shape: Shape, folds: Folds, limits: Limits) -> usize {
        let diagonal = self.diagonal.clone();
        let divide = |g: &mut [f64]| {
            g.iter_mut().zip(&diagonal).for_each(|(g, d)| *g /= d);
        };
        self.descend_with(shape, folds, limits, &divide)
    }

    /// Lowers the energy.
    pub(super) fn descend_with(
        &mut self,
        shape: Shape,
        folds: Folds,
        limits: Limits,
        precondition: &dyn Fn(&mut [f64]),
    ) -> usize {
        let Self { energy, x, .. } = self;
        let objective = |x: &[f64], g: &mut [f64]| energy.evaluate(shape, folds, x, g);
        minimise(x, limits, precondition, objective).evaluations
    }

    pub(super) fn write_back(&self, parameters: &mut [[f64; 3]]) {
        for (&vertex, x) in self.vertices.iter().zip(self.x.chunks_exact(3)) {
            parameters[vertex as usize].copy_from_slice(x);
        }
    }
}
