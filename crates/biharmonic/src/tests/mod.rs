//! Laws and independent routes to the same numbers.

mod creases;
mod decomposition;
mod denoising;
mod evaluation;
mod fitting;
mod points;
mod selection;
mod weights;

use std::sync::Arc;

use msplines_common::evaluate::VertexData;
use msplines_common::linalg::Mat;
use msplines_common::mesh::TriangleMesh;

use crate::target::Centred;
use crate::{Laplacian, Space};

/// Returns the positions of a mesh, vertex after vertex.
fn positions(mesh: &TriangleMesh) -> Vec<f64> {
    mesh.positions()
        .iter()
        .flat_map(|p| [p.x, p.y, p.z])
        .collect()
}

/// Returns the positions less their mean, as a matrix.
fn centred(mesh: &TriangleMesh) -> Mat<f64> {
    target(mesh).data
}

/// Returns the positions as the target of a fit.
fn target(mesh: &TriangleMesh) -> Centred {
    let data = VertexData {
        dimension: 3,
        values: &positions(mesh),
    };
    Centred::check(mesh.vertex_count(), &data.into()).unwrap()
}

fn space(mesh: &TriangleMesh) -> Space {
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
