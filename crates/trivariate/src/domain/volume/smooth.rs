//! Less distortion for a map without folds, none of which appear.
//!
//! Steps preconditioned with the Laplacian carry changes through the whole solid at once; the
//! diagonal of it then serves cells that are squeezed.

use std::sync::Arc;

use msplines_common::linalg::{Cholesky, Mat, Ordering, Symbolic};
use msplines_common::mesh::tet::TetMesh;
use rayon::prelude::*;

use super::foldover::{Folds, Shape};
use super::laplacian::solid_laplacian;
use super::options::{Smoothing, VolumeWeights};
use super::part::Part;
use crate::domain::cube::free_axes;
use crate::domain::descent::Limits;
use crate::domain::dirichlet::DirichletError;

/// Lowers the distortion of a map without folds. Returns the evaluations.
///
/// # Reference
/// [Kovalsky2016]. Deviation: limited-memory quasi-Newton steps on top.
pub(super) fn smooth(
    mesh: &TetMesh,
    masks: &[u8],
    parameters: &mut [[f64; 3]],
    options: &Smoothing,
) -> Result<u32, DirichletError> {
    let cells: Vec<u32> = (0..mesh.cell_count() as u32).collect();
    let Some(mut part) = Part::new(mesh, masks, parameters, &cells) else {
        return Ok(0);
    };
    let mut used = 0;
    let limits = |evaluations: u32| Limits {
        evaluations: evaluations as usize,
        progress: options.progress,
    };
    if options.global_evaluations > 0 {
        let laplacian = Laplacian::factor(mesh, masks)?;
        let (vertices, free) = (part.vertices.clone(), part.free.clone());
        let solve = |g: &mut [f64]| laplacian.solve(&vertices, &free, g);
        let limits = limits(options.global_evaluations);
        used += part.descend_with(Shape::Quadratic, Folds::Refused, limits, &solve);
    }
    if options.local_evaluations > 0 {
        used += part.descend(
            Shape::Quadratic,
            Folds::Refused,
            limits(options.local_evaluations),
        );
    }
    part.write_back(parameters);
    Ok(used as u32)
}

/// The Laplacian of the vertices that are free, for each coordinate.
struct Laplacian {
    factors: Vec<Cholesky>,
    size: usize,
}

impl Laplacian {
    fn factor(mesh: &TetMesh, masks: &[u8]) -> Result<Self, DirichletError> {
        let laplacian = solid_laplacian(mesh, VolumeWeights::Linear);
        let ordering = Ordering::nested_dissection(&laplacian)?;
        let symbolic = Arc::new(Symbolic::analyze(&laplacian, &ordering));
        let factors: Result<Vec<Cholesky>, _> = (0..3)
            .into_par_iter()
            .map(|axis| {
                let keep = |row: usize| free_axes(masks[row])[axis];
                Cholesky::factor_kept(Arc::clone(&symbolic), &laplacian, keep)
            })
            .collect();
        Ok(Self {
            factors: factors?,
            size: masks.len(),
        })
    }

    fn solve(&self, vertices: &[u32], free: &[[bool; 3]], g: &mut [f64]) {
        let solved: Vec<Mat<f64>> = self
            .factors
            .par_iter()
            .enumerate()
            .map(|(axis, factor)| {
                let mut x = Mat::zeros(self.size, 1);
                for (k, &vertex) in vertices.iter().enumerate() {
                    x[(vertex as usize, 0)] = g[3 * k + axis];
                }
                factor.solve_in_place(x.as_mut());
                x
            })
            .collect();
        for (k, (&vertex, free)) in vertices.iter().zip(free).enumerate() {
            for axis in 0..3 {
                let value = solved[axis][(vertex as usize, 0)];
                g[3 * k + axis] = if free[axis] { value } else { 0.0 };
            }
        }
    }
}
