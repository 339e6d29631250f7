//! Laws of the factorisation, on grids large enough to have a top, subtrees and merged supernodes.

use proptest::prelude::*;

use super::*;

/// Rounding of a backward-stable solve on matrices of condition below 1e5.
const SOLVE_TOLERANCE: f64 = 1e-10;

fn grid_laplacian(width: u32, height: u32, shift: f64) -> SymmetricMatrix {
    let mut entries = Vec::new();
    let id = |i: u32, j: u32| j * width + i;
    let mut edge = |a: u32, b: u32| {
        let weight = 1.0 + f64::from((a * 7 + b * 3) % 5);
        entries.extend([(a, a, weight), (b, b, weight), (b, a, -weight)]);
    };
    for j in 0..height {
        for i in 0..width {
            if i + 1 < width {
                edge(id(i, j), id(i + 1, j));
            }
            if j + 1 < height {
                edge(id(i, j), id(i, j + 1));
            }
        }
    }
    entries.extend((0..width * height).map(|v| (v, v, shift)));
    SymmetricMatrix::from_lower_triplets((width * height) as usize, &entries)
}

fn sides(rows: usize, columns: usize) -> Mat<f64> {
    Mat::from_fn(rows, columns, |i, j| ((i * 31 + j * 17) % 23) as f64 - 11.0)
}

fn largest(matrix: &Mat<f64>) -> f64 {
    matrix
        .col_iter()
        .flat_map(|c| c.iter().map(|v| v.abs()).collect::<Vec<_>>())
        .fold(0.0, f64::max)
}

#[test]
fn solution_satisfies_the_system_for_any_number_of_sides() {
    let laplacian = grid_laplacian(61, 47, 0.01);
    let matrix = laplacian.congruence(&vec![1.0; laplacian.size()]);
    let ordering = Ordering::nested_dissection(&matrix).unwrap();
    let factor = Cholesky::factor(Symbolic::analyze(&matrix, &ordering), &matrix).unwrap();
    for count in [1, 3, 5, 6, 16, 19, 40] {
        let b = sides(matrix.size(), count);
        let mut x = b.clone();
        factor.solve_in_place(x.as_mut());
        let residual = matrix.multiply(x.as_ref()) - &b;
        assert!(
            largest(&residual) <= 1e-6 * largest(&b),
            "{count} sides: {}",
            largest(&residual)
        );
    }
}

#[test]
fn rows_left_out_are_untouched_and_the_rest_solves_the_submatrix() {
    let matrix = grid_laplacian(40, 30, 0.0);
    let keep = |row: usize| !row.is_multiple_of(7);
    let ordering = Ordering::nested_dissection(&matrix).unwrap();
    let symbolic = Symbolic::analyze_kept(&matrix, &ordering, keep);
    let factor = Cholesky::factor(symbolic, &matrix).unwrap();
    let b = sides(matrix.size(), 3);
    let mut x = b.clone();
    factor.solve_in_place(x.as_mut());
    let whole = Symbolic::analyze(&matrix, &ordering);
    let decoupled = Cholesky::factor_kept(whole, &matrix, keep).unwrap();
    let mut y = b.clone();
    decoupled.solve_in_place(y.as_mut());
    assert!(largest(&(&x - &y)) < SOLVE_TOLERANCE);
    for row in (0..matrix.size()).filter(|&row| !keep(row)) {
        assert_eq!(x[(row, 1)], b[(row, 1)]);
        x.row_mut(row).fill(0.0);
    }
    let image = matrix.multiply(x.as_ref());
    for row in (0..matrix.size()).filter(|&row| keep(row)) {
        assert!((image[(row, 2)] - b[(row, 2)]).abs() < SOLVE_TOLERANCE);
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let matrix = grid_laplacian(83, 59, 0.3);
    let ordering = Ordering::nested_dissection(&matrix).unwrap();
    let run = || {
        let factor = Cholesky::factor(Symbolic::analyze(&matrix, &ordering), &matrix).unwrap();
        let mut x = sides(matrix.size(), 9);
        factor.solve_in_place(x.as_mut());
        x
    };
    let pool = |threads| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap()
    };
    let one = pool(1).install(run);
    assert_eq!(one, pool(2).install(run));
    assert_eq!(one, pool(5).install(run));
}

#[test]
fn a_singular_matrix_names_a_row() {
    let matrix = grid_laplacian(9, 8, 0.0);
    let negative = matrix.plus_diagonal(&vec![-0.5; 72]);
    let ordering = Ordering::natural(72);
    let error = Cholesky::factor(Symbolic::analyze(&negative, &ordering), &negative).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("the matrix is not positive definite at row ")
    );
}

#[test]
fn disconnected_and_diagonal_matrices_factor() {
    let matrix = SymmetricMatrix::from_lower_triplets(
        5,
        &[
            (0, 0, 4.0),
            (1, 1, 9.0),
            (2, 2, 2.0),
            (3, 3, 2.0),
            (3, 2, 1.0),
            (4, 4, 1.0),
        ],
    );
    let ordering = Ordering::nested_dissection(&matrix).unwrap();
    let factor = Cholesky::factor(Symbolic::analyze(&matrix, &ordering), &matrix).unwrap();
    let mut x = Mat::from_fn(5, 1, |_, _| 1.0);
    factor.solve_in_place(x.as_mut());
    let expected = [0.25, 1.0 / 9.0, 1.0 / 3.0, 1.0 / 3.0, 1.0];
    for (row, value) in expected.into_iter().enumerate() {
        assert!((x[(row, 0)] - value).abs() < 1e-15);
    }
}

#[test]
fn minimum_degree_orders_the_kept_rows_with_little_fill_and_the_others_last() {
    let matrix = grid_laplacian(60, 50, 0.1);
    let keep = |row: usize| !row.is_multiple_of(11);
    let ordering = Ordering::minimum_degree(&matrix, keep).unwrap();
    let order = ordering.as_slice();
    let kept = (0..matrix.size()).filter(|&row| keep(row)).count();
    assert!(order[..kept].iter().all(|&row| keep(row as usize)));
    let mut sorted = order.to_vec();
    sorted.sort_unstable();
    assert_eq!(sorted, Ordering::natural(matrix.size()).as_slice());
    let flops = |ordering: &Ordering| Symbolic::analyze_kept(&matrix, ordering, keep).flops();
    let dissection = Ordering::nested_dissection(&matrix).unwrap();
    assert!(flops(&ordering) < 2.0 * flops(&dissection));
    assert!(flops(&ordering) < 0.1 * flops(&Ordering::natural(matrix.size())));
    let none = Ordering::minimum_degree(&matrix, |_| false).unwrap();
    assert_eq!(none, Ordering::natural(matrix.size()));
}

#[test]
fn conjugate_gradients_agree_with_the_factor() {
    let matrix = grid_laplacian(20, 20, 0.1);
    let ordering = Ordering::nested_dissection(&matrix).unwrap();
    let factor = Cholesky::factor(Symbolic::analyze(&matrix, &ordering), &matrix).unwrap();
    let b = sides(400, 2);
    let mut direct = b.clone();
    factor.solve_in_place(direct.as_mut());
    let diagonal = matrix.diagonal();
    let mut x = Mat::zeros(400, 2);
    let report = conjugate_gradient(
        |v| matrix.multiply(v),
        |v| Mat::from_fn(400, 2, |i, j| v[(i, j)] / diagonal[i]),
        |_| (),
        b.as_ref(),
        &mut x,
        CgTolerance::Relative(1e-12),
        500,
    );
    assert!(report.converged && report.iterations > 3);
    assert!(largest(&(x - direct)) < 1e-9);
}

proptest! {
    #[test]
    fn random_patterns_solve(edges in prop::collection::vec((0u32..60, 0u32..60), 0..200)) {
        let mut entries: Vec<(u32, u32, f64)> = (0..60).map(|v| (v, v, 1.0)).collect();
        for (a, b) in edges.into_iter().filter(|(a, b)| a != b) {
            entries.extend([(a, a, 1.0), (b, b, 1.0), (a.max(b), a.min(b), -1.0)]);
        }
        let matrix = SymmetricMatrix::from_lower_triplets(60, &entries);
        let ordering = Ordering::nested_dissection(&matrix).unwrap();
        let factor = Cholesky::factor(Symbolic::analyze(&matrix, &ordering), &matrix).unwrap();
        let b = sides(60, 7);
        let mut x = b.clone();
        factor.solve_in_place(x.as_mut());
        prop_assert!(largest(&(matrix.multiply(x.as_ref()) - b)) < SOLVE_TOLERANCE);
        let kept = |row: usize| row % 3 != 1;
        let ordering = Ordering::minimum_degree(&matrix, kept).unwrap();
        let symbolic = Symbolic::analyze_kept(&matrix, &ordering, kept);
        let factor = Cholesky::factor(symbolic, &matrix).unwrap();
        let mut x = Mat::from_fn(60, 1, |row, _| if kept(row) { 1.0 } else { 0.0 });
        factor.solve_in_place(x.as_mut());
        let image = matrix.multiply(x.as_ref());
        for row in (0..60).filter(|&row| kept(row)) {
            prop_assert!((image[(row, 0)] - 1.0).abs() < SOLVE_TOLERANCE);
        }
    }
}
