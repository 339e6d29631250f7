//! The problems of one round against another solver and their optimality conditions; the whole
//! selection against samples.

use clarabel::algebra::CscMatrix;
use clarabel::solver::SupportedConeT::{NonnegativeConeT, ZeroConeT};
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus};
use msplines_common::linalg::{Mat, SymmetricMatrix, column};
use msplines_common::mesh::{TriangleMesh, shapes, zoo};
use msplines_common::progress::unobserved;

use super::box_qp::{BoxQp, BoxSolution};
use super::{L1Knots, Problem, reweighted_l1};
use crate::Space;
use crate::knot_values::KnotValues;
use crate::select::Run;
use crate::select::sample::{Density, exact_sample};
use crate::target::Centred;
use crate::tests::{centred, gram, space, target};

/// Gap of the solutions that are compared.
const GAP: f64 = 1e-9;

/// Returns the bounds of a first round in which knots of this squared error go.
fn first_bounds(space: &Space, data: &Mat<f64>, share: f64) -> Vec<f64> {
    let problem = Problem::build(space, data).unwrap();
    let (support, penalty) = problem.start(1);
    problem.bounds(&support, share * penalty)
}

fn product(matrix: &SymmetricMatrix, x: &[f64]) -> Vec<f64> {
    let x = Mat::from_fn(x.len(), 1, |row, _| x[row]);
    column(matrix.multiply(x.as_ref()).as_ref(), 0).to_vec()
}

fn primal(matrix: &SymmetricMatrix, s: &[f64], dual: &[f64]) -> Vec<f64> {
    let image = product(matrix, dual);
    s.iter().zip(image).map(|(s, image)| s - image).collect()
}

/// Returns `1/2 |s - f|² + Σ bᵢ |wᵢ|` over the bounded rows.
fn objective(s: &[f64], f: &[f64], w: &[f64], bounds: &[f64]) -> f64 {
    let distance: f64 = s.iter().zip(f).map(|(s, f)| (s - f).powi(2)).sum();
    let penalties = bounds.iter().zip(w).filter(|(bound, _)| bound.is_finite());
    0.5 * distance + penalties.map(|(bound, w)| bound * w.abs()).sum::<f64>()
}

/// Solves the primal problem in `f` and `t ≥ |B f|`, rows of `B` scaled to norm 1, by Clarabel.
fn by_clarabel(matrix: &SymmetricMatrix, s: &[f64], bounds: &[f64]) -> Vec<f64> {
    let n = s.len();
    let norm = |row: usize| matrix.column(row).map(|e| e.1 * e.1).sum::<f64>().sqrt();
    let (fixed, boxed): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| bounds[i].is_infinite());
    let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
    let mut put = |row: usize, column: usize, value: f64| {
        rows.push(row);
        columns.push(column);
        values.push(value);
    };
    for (k, &i) in fixed.iter().enumerate() {
        matrix
            .column(i)
            .for_each(|(j, value)| put(k, j, value / norm(i)));
    }
    for (k, &i) in boxed.iter().enumerate() {
        for (half, sign) in [1.0, -1.0].into_iter().enumerate() {
            let row = fixed.len() + half * boxed.len() + k;
            matrix
                .column(i)
                .for_each(|(j, value)| put(row, j, sign * value / norm(i)));
            put(row, n + k, -1.0);
        }
    }
    let constraints = fixed.len() + 2 * boxed.len();
    let a = CscMatrix::new_from_triplets(constraints, n + boxed.len(), rows, columns, values);
    let diagonal: Vec<usize> = (0..n).collect();
    let size = n + boxed.len();
    let p = CscMatrix::new_from_triplets(size, size, diagonal.clone(), diagonal, vec![1.0; n]);
    let mut q: Vec<f64> = s.iter().map(|s| -s).collect();
    q.extend(boxed.iter().map(|&i| bounds[i] * norm(i)));
    let cones = [ZeroConeT(fixed.len()), NonnegativeConeT(2 * boxed.len())];
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .tol_gap_rel(1e-10)
        .tol_gap_abs(1e-14)
        .tol_feas(1e-10)
        .build()
        .unwrap();
    let mut solver =
        DefaultSolver::new(&p, &q, &a, &vec![0.0; constraints], &cones, settings).unwrap();
    solver.solve();
    assert_eq!(solver.solution.status, SolverStatus::Solved);
    solver.solution.x[..n].to_vec()
}

fn solved(space: &Space, s: &[f64], bounds: &[f64]) -> BoxSolution {
    let solution = BoxQp::build(space).unwrap().solve(s, bounds, GAP).unwrap();
    assert!(solution.gap <= GAP, "{}", solution.gap);
    solution
}

#[test]
fn l1_problem_has_the_solution_of_another_solver() {
    const OBJECTIVE_TOLERANCE: f64 = 1e-6;
    const SOLUTION_TOLERANCE: f64 = 1e-5;
    for mesh in [zoo::closed(), zoo::with_boundary()] {
        let (space, data) = (space(&mesh), centred(&mesh));
        let matrix = &space.bilaplacian().unwrap().matrix;
        let s = column(data.as_ref(), 0);
        for share in [1.0, 1000.0] {
            let bounds = first_bounds(&space, &data, share);
            let ours = solved(&space, s, &bounds);
            let theirs = by_clarabel(matrix, s, &bounds);
            let f = primal(matrix, s, &ours.dual);
            let expected = objective(s, &theirs, &product(matrix, &theirs), &bounds);
            let found = objective(s, &f, &ours.coefficients, &bounds);
            assert!(
                (found - expected).abs() < OBJECTIVE_TOLERANCE * expected,
                "{found} {expected}"
            );
            let largest = s.iter().fold(0.0, |m: f64, s| m.max(s.abs()));
            let apart = f.iter().zip(&theirs).map(|(a, b)| (a - b).abs());
            assert!(apart.fold(0.0, f64::max) < SOLUTION_TOLERANCE * largest);
        }
    }
}

#[test]
fn l1_solution_meets_the_optimality_conditions() {
    const TOLERANCE: f64 = 1e-3; // complementary factors are the roots of the gap
    let mesh = zoo::knotted();
    let (space, data) = (space(&mesh), centred(&mesh));
    let matrix = &space.bilaplacian().unwrap().matrix;
    let bounds = first_bounds(&space, &data, 100.0);
    for c in 0..3 {
        let s = column(data.as_ref(), c);
        let solution = solved(&space, s, &bounds);
        let w = product(matrix, &primal(matrix, s, &solution.dual));
        let typical = bounds
            .iter()
            .zip(&w)
            .filter(|(bound, _)| bound.is_finite())
            .map(|(bound, w)| bound * w.abs())
            .fold(0.0, f64::max);
        let largest = w.iter().fold(0.0, |m: f64, w| m.max(w.abs()));
        for (i, &bound) in bounds.iter().enumerate() {
            if bound.is_infinite() {
                assert!(w[i].abs() < TOLERANCE * largest, "row {i} is no knot");
                continue;
            }
            let place = solution.dual[i] / bound;
            assert!(place.abs() <= 1.0, "{place}");
            let weight = bound * w[i] / typical;
            assert!(
                weight.abs() < TOLERANCE || weight * place > 0.0 && 1.0 - place.abs() < TOLERANCE,
                "row {i}: {weight} at {place}"
            );
        }
    }
}

/// The spline is constant exactly if `s - B u` is, within the bounds, for some `u`.
#[test]
fn l1_penalty_ranges_from_interpolation_to_a_constant() {
    let mesh = zoo::closed();
    let (space, data) = (space(&mesh), centred(&mesh));
    let matrix = &space.bilaplacian().unwrap().matrix;
    let s = column(data.as_ref(), 1);
    let w = product(matrix, s);
    let row_sum = |row| matrix.column(row).map(|e| e.1.abs()).sum::<f64>();
    let bound = 1e-9 / (0..s.len()).map(row_sum).fold(0.0, f64::max);
    // At both ends the objective has few digits left for its gap.
    let qp = BoxQp::build(&space).unwrap();
    let solved = |bounds: &[f64]| {
        let solution = qp.solve(s, bounds, 1e-6).unwrap();
        assert!(solution.gap <= 1e-6, "{}", solution.gap);
        solution
    };
    let free = solved(&vec![bound; s.len()]);
    let largest = w.iter().fold(0.0, |m: f64, w| m.max(w.abs()));
    for (w, found) in w.iter().zip(&free.coefficients) {
        assert!((w - found).abs() < 1e-6 * largest, "{w} {found}");
    }

    let whole = space.poisson().unwrap().solve_biharmonic(data.clone());
    let whole = column(whole.as_ref(), 1);
    let [least, largest] = [f64::min, f64::max].map(|f| whole.iter().copied().reduce(f).unwrap());
    let enough = 0.5 * (largest - least);
    for (share, constant) in [(1.01, true), (0.99, false)] {
        let bounds = vec![share * enough; s.len()];
        let flat = primal(matrix, s, &solved(&bounds).dual);
        let size = flat.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
        assert_eq!(size < 1e-4, constant, "{share} {size}");
    }
}

fn selected<'a>(space: &'a Space, target: &'a Centred, count: usize) -> L1Knots<'a> {
    let mut observer = unobserved();
    let mut run = Run {
        observer: &mut observer,
        stopped: false,
    };
    reweighted_l1(space, target, count, 3, &mut run).unwrap()
}

/// Returns the root of the squared error of the best spline with these knots.
fn error(space: &Space, target: &Centred, knots: Vec<u32>) -> f64 {
    let system = KnotValues::factor(space, knots).unwrap();
    let gram = gram(space, &system, target);
    let (f, _) = system.least_squares(target, &target.data, &gram, 1e-8, 400);
    (&target.data - f).norm_l2()
}

#[test]
fn l1_selection_beats_samples() {
    let mesh = shapes::bumpy_sphere(1500);
    let (space, target) = (space(&mesh), target(&mesh));
    let count = 100;
    let of = |density| {
        error(
            &space,
            &target,
            exact_sample(&space, &target, count, density, 3),
        )
    };
    let found = selected(&space, &target, count);
    assert_eq!(found.state.knots().len(), count);
    assert!(found.gap <= super::GAP && found.rounds > 5);
    let (even, curvature) = (of(Density::Even), of(Density::Curvature));
    let l1 = error(&space, &target, found.state.knots().to_vec());
    assert!((&target.data - found.state.into_parts().2).norm_l2() < 1.01 * l1);
    assert!(l1 < 0.7 * even, "{l1} {even} {curvature}");
    assert!(l1 < 0.8 * curvature, "{l1} {curvature}");
}

#[test]
fn l1_selection_meets_any_count() {
    let mesh = zoo::with_two_boundaries();
    let (space, target) = (space(&mesh), target(&mesh));
    let n = mesh.vertex_count();
    for count in [1, 2, 10, n / 2, n - 1] {
        let knots = selected(&space, &target, count).state.knots().to_vec();
        assert_eq!(knots.len(), count);
        assert!(knots.windows(2).all(|pair| pair[0] < pair[1]));
    }
}

#[test]
fn l1_selection_of_constant_data_meets_the_count() {
    let mesh = zoo::with_boundary();
    let target = Centred {
        data: Mat::zeros(mesh.vertex_count(), 2),
        ..target(&mesh)
    };
    let space = space(&mesh);
    assert_eq!(selected(&space, &target, 20).state.knots().len(), 20);
}

#[test]
fn l1_selection_is_the_same_on_any_number_of_threads() {
    let mesh: TriangleMesh = zoo::closed();
    let (space, target) = (space(&mesh), target(&mesh));
    let [one, three] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| selected(&space, &target, 40).state.knots().to_vec())
    });
    assert_eq!(one, three);
}

#[test]
fn samples_have_exactly_the_size_asked_for() {
    let mesh = zoo::closed();
    let (space, target) = (space(&mesh), target(&mesh));
    let n = mesh.vertex_count();
    for density in [Density::Even, Density::Curvature] {
        for count in [1, 2, 37, n / 2, n - 1, n] {
            let sample = exact_sample(&space, &target, count, density, 5);
            assert_eq!(sample.len(), count);
            assert!(sample.windows(2).all(|pair| pair[0] < pair[1]));
        }
    }
}
