//! Pursuits against exhaustive search, plain algebra, and problems with a known answer.

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::pursuit::{Found, Problem, Selection, Workspace, pursue, refit};

struct Case {
    matrix: DMatrix<f64>,
    gram: Vec<f64>,
}

impl Case {
    fn random(rows: usize, columns: usize, seed: u64) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        Self::of(DMatrix::from_fn(rows, columns, |_, j| {
            (1.0 + j as f64) * (2.0 * random.random::<f64>() - 1.0)
        }))
    }

    fn of(matrix: DMatrix<f64>) -> Self {
        let gram = (matrix.transpose() * &matrix).as_slice().to_vec();
        Self { matrix, gram }
    }

    fn pursue(&self, data: &[DVector<f64>], selection: Selection, sparsity: usize) -> Found {
        let alpha = self.correlations(data);
        let allowed = vec![true; self.matrix.ncols()];
        pursue(
            self.problem(data, &alpha, &allowed),
            selection,
            sparsity,
            &mut Workspace::default(),
        )
    }

    fn correlations(&self, data: &[DVector<f64>]) -> Vec<f64> {
        data.iter()
            .flat_map(|t| (self.matrix.transpose() * t).as_slice().to_vec())
            .collect()
    }

    fn problem<'a>(
        &'a self,
        data: &[DVector<f64>],
        alpha: &'a [f64],
        allowed: &'a [bool],
    ) -> Problem<'a> {
        Problem {
            gram: &self.gram,
            components: data.len(),
            alpha,
            allowed,
        }
    }

    /// Returns what least squares on some columns leaves, summed over components.
    fn rest(&self, data: &[DVector<f64>], support: &[u16]) -> f64 {
        let columns: Vec<usize> = support.iter().map(|&i| usize::from(i)).collect();
        let part = self.matrix.select_columns(&columns);
        let solver = part.clone().svd(true, true);
        let left = |t: &DVector<f64>| {
            let c = solver.solve(t, 1e-12).expect("a least-squares solution");
            (t - &part * c).norm_squared()
        };
        data.iter().map(left).sum()
    }
}

fn signals(rows: usize, count: usize, seed: u64) -> Vec<DVector<f64>> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    (0..count)
        .map(|_| DVector::from_fn(rows, |_, _| random.random::<f64>() - 0.4))
        .collect()
}

/// Every choice is the one that its definition asks for, computed without Gram matrices.
#[test]
fn choices_are_those_of_their_definitions() {
    for components in [1, 3] {
        let case = Case::random(30, 12, 4);
        let data = signals(30, components, 5);
        for selection in [Selection::Omp, Selection::Ormp, Selection::Plain] {
            let found = case.pursue(&data, selection, 6);
            assert_eq!(found.support.len(), 6);
            for step in 0..6 {
                let before = &found.support[..step];
                let score = |atom: u16| {
                    let column = case.matrix.column(usize::from(atom));
                    let residuals = data.iter().map(|t| residual(&case.matrix, before, t));
                    let correlation: f64 = residuals.map(|r| column.dot(&r).powi(2)).sum();
                    match selection {
                        Selection::Plain => correlation,
                        Selection::Omp => correlation / column.norm_squared(),
                        Selection::Ormp => {
                            let mut longer = before.to_vec();
                            longer.push(atom);
                            -case.rest(&data, &longer)
                        }
                    }
                };
                let rest = (0..12u16).filter(|atom| !before.contains(atom));
                let best = rest.max_by(|&a, &b| score(a).total_cmp(&score(b)));
                assert_eq!(
                    best,
                    Some(found.support[step]),
                    "{selection:?} at step {step}"
                );
            }
        }
    }
}

fn residual(matrix: &DMatrix<f64>, support: &[u16], t: &DVector<f64>) -> DVector<f64> {
    if support.is_empty() {
        return t.clone();
    }
    let columns: Vec<usize> = support.iter().map(|&i| usize::from(i)).collect();
    let part = matrix.select_columns(&columns);
    let c = part
        .clone()
        .svd(true, true)
        .solve(t, 1e-12)
        .expect("a solution");
    t - part * c
}

#[test]
fn coefficients_are_those_of_least_squares() {
    let case = Case::random(40, 15, 8);
    let data = signals(40, 3, 9);
    let found = case.pursue(&data, Selection::Ormp, 7);
    let whole: f64 = data.iter().map(DVector::norm_squared).sum();
    let rest = case.rest(&data, &found.support);
    assert!((whole - found.explained - rest).abs() < 1e-10 * whole);
    for (component, t) in data.iter().enumerate() {
        let mut left = t.clone();
        for (atom, c) in found.support.iter().zip(found.coefficients.chunks(3)) {
            left -= case.matrix.column(usize::from(*atom)) * c[component];
        }
        for atom in &found.support {
            let column = case.matrix.column(usize::from(*atom));
            assert!(column.dot(&left).abs() < 1e-10 * column.norm() * t.norm());
        }
    }
}

#[test]
fn sparse_signals_over_few_atoms_are_recovered() {
    let case = Case::random(60, 20, 1);
    let truth = [3usize, 11, 17];
    let signal = truth.iter().fold(DVector::zeros(60), |sum, &i| {
        sum + case.matrix.column(i) / (1.0 + i as f64)
    });
    for selection in [Selection::Omp, Selection::Ormp] {
        let found = case.pursue(std::slice::from_ref(&signal), selection, 3);
        let mut support = found.support.clone();
        support.sort_unstable();
        assert_eq!(support, [3, 11, 17]);
        for (atom, c) in found.support.iter().zip(&found.coefficients) {
            assert!((c - 1.0 / (1.0 + f64::from(*atom))).abs() < 1e-12);
        }
    }
}

#[test]
fn dependent_and_forbidden_atoms_are_left_out() {
    let base = Case::random(20, 5, 2).matrix;
    let doubled = DMatrix::from_fn(20, 10, |i, j| base[(i, j % 5)]);
    let case = Case::of(doubled);
    let data = signals(20, 1, 3);
    let found = case.pursue(&data, Selection::Omp, 10);
    assert_eq!(
        found.support.len(),
        5,
        "five of ten columns are independent"
    );
    let alpha = case.correlations(&data);
    let allowed: Vec<bool> = (0..10).map(|i| i % 2 == 0).collect();
    let mut workspace = Workspace::default();
    let problem = case.problem(&data, &alpha, &allowed);
    let found = pursue(problem, Selection::Ormp, 10, &mut workspace);
    assert!(found.support.iter().all(|i| i % 2 == 0));
    let again = refit(problem, &[0, 5, 2], &mut workspace);
    assert_eq!(again.support, [0, 2], "atom 5 is atom 0 again");
}

#[test]
fn nothing_is_found_in_no_signal() {
    let case = Case::random(10, 4, 6);
    let found = case.pursue(&[DVector::zeros(10)], Selection::Omp, 4);
    assert!(found.support.is_empty() && found.explained == 0.0);
}
