//! Laws and independent routes to the same numbers.

mod algebra;
mod creases;
mod decomposition;
mod denoising;
mod evaluation;
mod explicit;
mod fitting;
mod gram;
mod points;
mod polish;
mod selection;
mod weights;

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::Arc;

use msplines_common::evaluate::VertexData;
use msplines_common::linalg::Mat;
use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::unobserved;

use crate::gram::{Gram, Sight};
use crate::knot_values::KnotValues;
use crate::select::voronoi::Graph;
use crate::target::Centred;
use crate::{BiharmonicSpline, Fit, KnotChoice, Laplacian, Options, Space, fit, fit_in};

/// Returns the positions of a mesh, vertex after vertex.
fn positions(mesh: &TriangleMesh) -> Vec<f64> {
    mesh.positions()
        .iter()
        .flat_map(|p| [p.x, p.y, p.z])
        .collect()
}

/// Returns the positions less their mean, as a matrix.
pub(crate) fn centred(mesh: &TriangleMesh) -> Mat<f64> {
    target(mesh).data
}

/// Returns the positions as the target of a fit.
pub(crate) fn target(mesh: &TriangleMesh) -> Centred {
    let data = VertexData {
        dimension: 3,
        values: &positions(mesh),
    };
    Centred::check(mesh.vertex_count(), &data.into()).unwrap()
}

pub(crate) fn space(mesh: &TriangleMesh) -> Space {
    Space::build(Arc::new(mesh.clone()), Laplacian::Cotangent).unwrap()
}

/// Returns `count` knots spread over the vertices, ascending.
fn spread_knots(vertices: usize, count: usize) -> Vec<u32> {
    (0..count).map(|k| (k * vertices / count) as u32).collect()
}

/// Returns `count` knots, each as far as can be from those before it, ascending.
fn farthest_knots(mesh: &TriangleMesh, count: usize) -> Vec<u32> {
    let graph = Graph::build(mesh);
    let mut distance = vec![f64::INFINITY; mesh.vertex_count()];
    let mut knots = vec![0u32];
    loop {
        let newest = knots[knots.len() - 1];
        distance[newest as usize] = 0.0;
        // Bits of numbers that are not negative order as the numbers do.
        let mut heap = BinaryHeap::from([Reverse((0u64, newest))]);
        while let Some(Reverse((bits, vertex))) = heap.pop() {
            for &(other, length) in graph.neighbours(vertex) {
                let through = f64::from_bits(bits) + length;
                if through < distance[other as usize] {
                    distance[other as usize] = through;
                    heap.push(Reverse((through.to_bits(), other)));
                }
            }
        }
        if knots.len() == count {
            knots.sort_unstable();
            return knots;
        }
        let by_distance = |a: &usize, b: &usize| distance[*a].total_cmp(&distance[*b]);
        let farthest = (0..distance.len()).max_by(by_distance);
        knots.push(farthest.unwrap() as u32);
    }
}

/// Returns the spline with these knots that is nearest to the positions of the mesh.
fn spline_on(space: &Arc<Space>, knots: Vec<u32>) -> BiharmonicSpline {
    let data = VertexData {
        dimension: 3,
        values: &positions(space.mesh()),
    };
    let options = Options {
        knots: KnotChoice::Given(knots),
        ..Options::default()
    };
    fit_in(space, data, &options, &mut unobserved())
        .unwrap()
        .spline
}

/// Returns what preconditions the fits with the knots of a system.
pub(crate) fn gram(space: &Space, system: &KnotValues<'_>, target: &Centred) -> Gram {
    Gram::on(space, system, target, Sight::Ring).unwrap()
}

/// Returns weights that change from each vertex to the next.
fn weights(mesh: &TriangleMesh) -> Vec<f64> {
    (0..mesh.vertex_count())
        .map(|v| [0.2, 1.0, 3.0][v % 3])
        .collect()
}

/// Returns the positions as the target of a weighted fit.
fn weighted(mesh: &TriangleMesh) -> Centred {
    Centred {
        weights: Some(weights(mesh)),
        ..target(mesh)
    }
}

/// Returns what a fit of the positions of the mesh gives.
fn fit_positions(mesh: &TriangleMesh, options: &Options) -> Fit {
    let data = VertexData {
        dimension: 3,
        values: &positions(mesh),
    };
    fit(mesh, data, options, &mut unobserved()).unwrap()
}

fn largest_difference(one: &[f64], other: &[f64]) -> f64 {
    assert_eq!(one.len(), other.len());
    let differences = one.iter().zip(other).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max)
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
