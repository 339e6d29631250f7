//! Laws of least-squares meshes; here is what the tests share.

mod contract;
mod equations;
mod selection;

use msplines_common::evaluate::VertexData;
use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::unobserved;
use nalgebra::{DMatrix, Point3};

use crate::{Constraints, ControlChoice, LsMesh, Options, Selection, fit};

/// Two backward-stable solutions of systems of condition below 1e5.
const SOLVE_TOLERANCE: f64 = 1e-10;

const SOFT: Constraints = Constraints::Soft { weight: 1.0 };

fn grid_faces(m: u32, n: u32, closed: bool) -> Vec<[u32; 3]> {
    let (rows, columns) = if closed { (m, n) } else { (m - 1, n - 1) };
    let at = |i: u32, j: u32| (i % m) * n + j % n;
    let cells = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
    cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

fn torus(m: u32, n: u32) -> TriangleMesh {
    let position = |v: u32| {
        let turn = std::f64::consts::TAU;
        let (u, w) = (
            f64::from(v / n) / f64::from(m) * turn,
            f64::from(v % n) / f64::from(n) * turn,
        );
        let bump = 1.0 + 0.3 * (3.0 * u + 0.4).sin() * (2.0 * w + 0.7).cos();
        let radius = 3.0 + bump * w.cos();
        Point3::new(radius * u.cos(), radius * u.sin(), bump * w.sin())
    };
    TriangleMesh::build((0..m * n).map(position).collect(), grid_faces(m, n, true)).unwrap()
}

fn square(m: u32, n: u32) -> TriangleMesh {
    let position = |v: u32| {
        // Curved in both directions, so that no two errors are equal.
        let (x, y) = (
            f64::from(v / n),
            1.02_f64.powi((v % n) as i32) * f64::from(v % n),
        );
        Point3::new(x, y, (0.7 * x).sin() * (0.45 * y + 0.3).cos())
    };
    TriangleMesh::build((0..m * n).map(position).collect(), grid_faces(m, n, false)).unwrap()
}

fn coordinates(mesh: &TriangleMesh) -> Vec<f64> {
    mesh.positions()
        .iter()
        .flat_map(|p| [p.x, p.y, p.z])
        .collect()
}

fn positions(values: &[f64]) -> VertexData<'_> {
    VertexData {
        dimension: 3,
        values,
    }
}

fn given(controls: &[u32], constraints: Constraints) -> Options {
    Options {
        controls: ControlChoice::Given(controls.to_vec()),
        constraints,
        ..Options::default()
    }
}

fn selected(count: usize, selection: Selection, constraints: Constraints) -> Options {
    Options {
        controls: ControlChoice::Selected { count },
        selection,
        constraints,
    }
}

fn fitted(mesh: &TriangleMesh, options: &Options) -> LsMesh {
    fit(
        mesh,
        positions(&coordinates(mesh)),
        options,
        &mut unobserved(),
    )
    .unwrap()
    .spline
}

fn mean_error(spline: &LsMesh, values: &[f64]) -> f64 {
    let rows = spline
        .vertex_values()
        .chunks_exact(3)
        .zip(values.chunks_exact(3));
    let total: f64 = rows
        .map(|(a, b)| {
            a.iter()
                .zip(b)
                .map(|(a, b)| (a - b).powi(2))
                .sum::<f64>()
                .sqrt()
        })
        .sum();
    total / (values.len() / 3) as f64
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

/// `I - D⁻¹ W`, from the faces alone.
fn dense_laplacian(mesh: &TriangleMesh) -> DMatrix<f64> {
    let n = mesh.vertex_count();
    let mut adjacency = DMatrix::zeros(n, n);
    for corners in mesh.faces() {
        for i in 0..3 {
            let (a, b) = (corners[i] as usize, corners[(i + 1) % 3] as usize);
            adjacency[(a, b)] = 1.0;
            adjacency[(b, a)] = 1.0;
        }
    }
    DMatrix::from_fn(n, n, |i, j| {
        f64::from(i == j) - adjacency[(i, j)] / adjacency.row(i).sum()
    })
}
