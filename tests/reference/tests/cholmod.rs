//! Solutions of the sparse factorisation against CHOLMOD.

use msplines_common::linalg::{Cholesky, Mat, Ordering, Symbolic, SymmetricMatrix};
use msplines_common::operators::mesh_operators;
use msplines_reference::cholmod::Cholmod;
use msplines_reference::record::Comparison;
use msplines_reference::{Library, meshes};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Condition number of a grounded Laplacian of some thousand vertices (1e4 to 1e5) times precision.
const LAPLACIAN: f64 = 1e-11;
/// The bi-Laplacian squares the condition number.
const BILAPLACIAN: f64 = 1e-6;
/// The residual of a backward stable solve, relative to the sizes of its terms.
const RESIDUAL: f64 = 1e-13;

type Failure = Box<dyn std::error::Error>;

/// Returns the deviation of the solutions with vertex 0 grounded, and our largest residual.
fn deviations(matrix: &SymmetricMatrix, seed: u64) -> Result<(Vec<f64>, f64), Failure> {
    const SIDES: usize = 3;
    let size = matrix.size();
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let b = Mat::from_fn(size, SIDES, |_, _| random.random_range(-1.0..1.0));

    let ordering = Ordering::nested_dissection(matrix)?;
    let symbolic = Symbolic::analyze_kept(matrix, &ordering, |row| row != 0);
    let mut x = b.clone();
    Cholesky::factor(symbolic, matrix)?.solve_in_place(x.as_mut());

    let mut solver = Cholmod::of(matrix, |row| row != 0);
    solver.factor();
    let kept: Vec<f64> = (0..SIDES)
        .flat_map(|side| (1..size).map(move |row| (row, side)))
        .map(|(row, side)| b[(row, side)])
        .collect();
    let mut theirs = vec![0.0; kept.len()];
    solver.solve(&kept, &mut theirs);

    let mut found = Vec::new();
    let mut residual: f64 = 0.0;
    for side in 0..SIDES {
        let theirs = &theirs[side * (size - 1)..(side + 1) * (size - 1)];
        let scale = theirs
            .iter()
            .fold(0.0_f64, |largest, value| largest.max(value.abs()));
        found.extend((1..size).map(|row| (x[(row, side)] - theirs[row - 1]).abs() / scale));
        for row in 1..size {
            let (mut sum, mut terms) = (-b[(row, side)], b[(row, side)].abs());
            for (other, entry) in matrix.column(row).filter(|e| e.0 != 0) {
                sum += entry * x[(other, side)];
                terms += (entry * x[(other, side)]).abs();
            }
            residual = residual.max(sum.abs() / terms);
        }
    }
    Ok((found, residual))
}

#[test]
fn solutions_agree() -> Result<(), Failure> {
    let why = "relative to the largest entry: condition number times precision";
    let library = Library::Cholmod;
    let mut laplacian = Comparison::new("solution with L", library, LAPLACIAN, why);
    let mut bilaplacian = Comparison::new("solution with B", library, BILAPLACIAN, why);
    for (seed, (name, mesh)) in meshes::all().into_iter().enumerate() {
        let operators = mesh_operators(&mesh);
        let (found, residual) = deviations(&operators.laplacian, seed as u64)?;
        laplacian.add(&name, found);
        assert!(residual < RESIDUAL, "{name}: {residual:e}");
        let (found, residual) = deviations(&operators.bilaplacian(), seed as u64)?;
        bilaplacian.add(&name, found);
        assert!(residual < RESIDUAL, "{name}: {residual:e}");
    }
    laplacian.finish();
    bilaplacian.finish();
    Ok(())
}
