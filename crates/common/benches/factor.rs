//! Sparse factorisations and solves on a generated surface of 100,000 vertices.

use std::sync::{Arc, LazyLock};

use divan::Bencher;
use msplines_common::linalg::{Cholesky, Mat, Ordering, Symbolic, SymmetricMatrix};
use msplines_common::mesh::shapes;
use msplines_common::operators::mesh_operators;

/// A matrix, its order and its analysis; the row eliminated last is left out.
struct System {
    matrix: SymmetricMatrix,
    ordering: Ordering,
    symbolic: Arc<Symbolic>,
    factor: Cholesky,
}

impl System {
    fn build(matrix: SymmetricMatrix) -> Self {
        let ordering = Ordering::nested_dissection(&matrix).expect("an order");
        let symbolic = Arc::new(analyze(&matrix, &ordering));
        let factor = Cholesky::factor(Arc::clone(&symbolic), &matrix).expect("positive definite");
        Self {
            matrix,
            ordering,
            symbolic,
            factor,
        }
    }
}

fn analyze(matrix: &SymmetricMatrix, ordering: &Ordering) -> Symbolic {
    let grounded = *ordering.as_slice().last().expect("rows") as usize;
    Symbolic::analyze_kept(matrix, ordering, |row| row != grounded)
}

static SYSTEMS: LazyLock<[System; 2]> = LazyLock::new(|| {
    let operators = mesh_operators(&shapes::bumpy_sphere(100_000));
    let bilaplacian = operators.bilaplacian();
    [
        System::build(operators.laplacian),
        System::build(bilaplacian),
    ]
});

const NAMES: [&str; 2] = ["laplacian", "bilaplacian"];

fn system(name: &str) -> &'static System {
    &SYSTEMS[NAMES
        .iter()
        .position(|n| *n == name)
        .expect("a known system")]
}

#[divan::bench(args = NAMES, sample_count = 5, sample_size = 1)]
fn order(bencher: Bencher<'_, '_>, name: &str) {
    let system = system(name);
    bencher.bench(|| Ordering::nested_dissection(&system.matrix));
}

#[divan::bench(args = NAMES, sample_count = 5, sample_size = 1)]
fn symbolic(bencher: Bencher<'_, '_>, name: &str) {
    let system = system(name);
    bencher.bench(|| analyze(&system.matrix, &system.ordering));
}

#[divan::bench(args = NAMES, sample_count = 5, sample_size = 1)]
fn numeric(bencher: Bencher<'_, '_>, name: &str) {
    let system = system(name);
    bencher.bench(|| Cholesky::factor(Arc::clone(&system.symbolic), &system.matrix));
}

#[divan::bench(args = [1, 3, 12, 64], sample_count = 9, sample_size = 1)]
fn solve_bilaplacian(bencher: Bencher<'_, '_>, sides: usize) {
    let system = system("bilaplacian");
    let b = Mat::from_fn(system.matrix.size(), sides, |i, j| {
        ((7 * i + 3 * j) % 11) as f64
    });
    bencher
        .with_inputs(|| b.clone())
        .bench_refs(|x| system.factor.solve_in_place(x.as_mut()));
}

fn main() {
    divan::main();
}
