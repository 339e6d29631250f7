//! Laws and independent routes to the same numbers.

mod evaluation;
mod fitting;
mod selection;

use std::sync::Arc;

use msplines_common::linalg::Mat;
use msplines_common::mesh::TriangleMesh;

use crate::{Laplacian, Space};

/// Returns the positions of a mesh, vertex after vertex.
fn positions(mesh: &TriangleMesh) -> Vec<f64> {
    mesh.positions()
        .iter()
        .flat_map(|p| [p.x, p.y, p.z])
        .collect()
}

/// Returns the positions less their mean, as a matrix.
pub(crate) fn centred(mesh: &TriangleMesh) -> Mat<f64> {
    let n = mesh.vertex_count();
    let values = positions(mesh);
    let mean = |c: usize| (0..n).map(|v| values[3 * v + c]).sum::<f64>() / n as f64;
    let means = [mean(0), mean(1), mean(2)];
    Mat::from_fn(n, 3, |v, c| values[3 * v + c] - means[c])
}

pub(crate) fn space(mesh: &TriangleMesh) -> Space {
    Space::build(Arc::new(mesh.clone()), Laplacian::Cotangent).unwrap()
}

/// Returns `count` knots spread over the vertices, ascending.
fn spread_knots(vertices: usize, count: usize) -> Vec<u32> {
    (0..count).map(|k| (k * vertices / count) as u32).collect()
}

/// Returns a sparse matrix as a dense one.
fn dense(matrix: &msplines_common::linalg::SymmetricMatrix) -> Mat<f64> {
    let mut out = Mat::zeros(matrix.size(), matrix.size());
    for column in 0..matrix.size() {
        matrix
            .column(column)
            .for_each(|(row, value)| out[(row, column)] = value);
    }
    out
}

/// Returns the solution of a dense symmetric positive definite system, refined once.
fn dense_solve(matrix: &Mat<f64>, b: &Mat<f64>) -> Mat<f64> {
    use faer::linalg::solvers::Solve;
    let factor = matrix.llt(faer::Side::Lower).unwrap();
    let mut x = factor.solve(b);
    let correction = factor.solve(&(b - matrix * &x));
    x += correction;
    x
}

fn largest(matrix: &Mat<f64>) -> f64 {
    let mut largest: f64 = 0.0;
    for c in 0..matrix.ncols() {
        (0..matrix.nrows()).for_each(|r| largest = largest.max(matrix[(r, c)].abs()));
    }
    largest
}
