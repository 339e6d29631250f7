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

/// How solutions of a system with vertex 0 grounded compare.
struct Solved {
    /// Deviations of the solutions, relative to the largest entry.
    deviations: Vec<f64>,
    /// Largest residuals relative to the sizes of their terms, here and there.
    residuals: [f64; 2],
}

/// Returns the solutions of a system of random right-hand sides, with vertex 0 grounded.
fn solved(matrix: &SymmetricMatrix, seed: u64) -> Result<Solved, Failure> {
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

    let mut deviations = Vec::new();
    let mut residuals = [0.0; 2];
    for side in 0..SIDES {
        let theirs = &theirs[side * (size - 1)..(side + 1) * (size - 1)];
        let scale = theirs
            .iter()
            .fold(0.0_f64, |largest, value| largest.max(value.abs()));
        deviations.extend((1..size).map(|row| (x[(row, side)] - theirs[row - 1]).abs() / scale));
        let right = |row: usize| b[(row, side)];
        residuals[0] = residual(matrix, right, |row| x[(row, side)]).max(residuals[0]);
        residuals[1] = residual(matrix, right, |row| theirs[row - 1]).max(residuals[1]);
    }
    Ok(Solved {
        deviations,
        residuals,
    })
}

/// Returns the largest residual of the rows but the first, relative to the sizes of its terms.
fn residual(
    matrix: &SymmetricMatrix,
    right: impl Fn(usize) -> f64,
    solution: impl Fn(usize) -> f64,
) -> f64 {
    let of_row = |row: usize| {
        let (mut sum, mut terms) = (-right(row), right(row).abs());
        for (other, entry) in matrix.column(row).filter(|e| e.0 != 0) {
            sum += entry * solution(other);
            terms += (entry * solution(other)).abs();
        }
        sum.abs() / terms
    };
    (1..matrix.size()).map(of_row).fold(0.0, f64::max)
}

/// Random positive definite matrices with their names: Laplacians of random graphs, plus a diagonal.
fn random_matrices() -> Vec<(String, SymmetricMatrix)> {
    let matrix = |(seed, size): (u64, u32)| {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut entries = Vec::new();
        for row in 0..size {
            entries.push((row, row, random.random_range(1e-3..1.0)));
            for _ in 0..4 {
                let other = random.random_range(0..size);
                let weight = random.random_range(0.1..10.0);
                if other != row {
                    let ends = (row.max(other), row.min(other), -weight);
                    entries.extend([ends, (row, row, weight), (other, other, weight)]);
                }
            }
        }
        let matrix = SymmetricMatrix::from_lower_triplets(size as usize, &entries);
        (format!("random graph of {size} vertices"), matrix)
    };
    let sizes = [20, 100, 300, 700, 1_500, 3_000];
    (0..).zip(sizes).map(matrix).collect()
}

#[test]
fn solutions_with_random_matrices_agree() -> Result<(), Failure> {
    let why = "relative to the largest entry: condition number times precision";
    let library = Library::Cholmod;
    let quantity = "solution with random matrices";
    let mut comparison = Comparison::new(quantity, library, LAPLACIAN, why);
    for (seed, (name, matrix)) in random_matrices().into_iter().enumerate() {
        let found = solved(&matrix, seed as u64)?;
        comparison.add(&name, found.deviations);
        assert!(
            found.residuals[0] < RESIDUAL,
            "{name}: {:?}",
            found.residuals
        );
    }
    comparison.finish();
    Ok(())
}

#[test]
fn solutions_agree() -> Result<(), Failure> {
    let why = "relative to the largest entry: condition number times precision";
    let library = Library::Cholmod;
    let mut laplacian = Comparison::new("solution with L", library, LAPLACIAN, why);
    let mut bilaplacian = Comparison::new("solution with B", library, BILAPLACIAN, why);
    let why = "relative to the sizes of its terms, above CHOLMOD's";
    let mut residuals = Comparison::new("residual of a solution", library, RESIDUAL, why);
    for (seed, (name, mesh)) in meshes::all().into_iter().enumerate() {
        let operators = mesh_operators(&mesh);
        let cases = [
            (&mut laplacian, operators.laplacian.clone()),
            (&mut bilaplacian, operators.bilaplacian()),
        ];
        for (comparison, matrix) in cases {
            let found = solved(&matrix, seed as u64)?;
            comparison.add(&name, found.deviations);
            let [ours, theirs] = found.residuals;
            assert!(ours < RESIDUAL, "{name}: {ours:e}");
            residuals.add(&name, [(ours - theirs).max(0.0)]);
        }
    }
    laplacian.finish();
    bilaplacian.finish();
    residuals.finish();
    Ok(())
}
