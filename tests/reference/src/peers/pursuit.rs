//! Sparse approximations: orthogonal and order-recursive pursuits.
//!
//! Half of the dictionaries are those of charts, monomials of degree 14 and the shape functions of all
//! valences at random points of a star; half are random. All columns have unit length. Every side
//! starts from dictionary and signals, so that the products with them count. SPAMS calls its
//! order-recursive pursuit, which takes the atom after which the residual is smallest, `omp`; that of
//! scikit-learn takes the largest correlation. On charts some atoms tie up to rounding, so that not all
//! supports are equal.

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, Mat, MatMut, Par};
use msplines_compare::peers::PeerRow;
use msplines_sparse_manifold::pursuit::{Problem, Selection, Workspace, pursue};
use msplines_sparse_manifold::{Dictionary, DictionaryKind, Star};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde_json::json;

use super::adapter::Inputs;
use super::contest::Timed;
use super::factor::Lap;
use super::surface::{Peer, contest_all};
use super::{Contest, Failure, Settings};

const PROBLEMS: usize = 802;
const ROWS: usize = 300;
const ATOMS: usize = 175;
const SIGNALS: usize = 3;
const SPARSITY: usize = 25;

const ORMP: [Peer; 1] = [("spams-bin", "spams_omp", "SPAMS omp", "")];
const OMP: [Peer; 2] = [
    (
        "scikit-learn",
        "orthogonal_mp",
        "scikit-learn orthogonal_mp",
        "",
    ),
    (
        "scikit-learn",
        "orthogonal_mp_gram",
        "scikit-learn orthogonal_mp_gram",
        "its products count",
    ),
];

pub(super) fn run(settings: &Settings) -> Result<Vec<PeerRow>, Failure> {
    let problems = problems();
    let inputs = Inputs::new()?;
    for (name, width) in [("dictionaries", ATOMS), ("signals", SIGNALS)] {
        let matrices = problems.iter().map(|case| match name {
            "signals" => &case.signals,
            _ => &case.dictionary,
        });
        let entries = matrices.flat_map(|m| (0..ROWS).map(move |row| m.row(row)));
        let values = entries.flat_map(|row| row.iter().copied());
        inputs.put(name, width, values.collect())?;
    }
    let mut rows = Vec::new();
    for (task, selection, peers) in [
        (
            "Order-recursive matching pursuit",
            Selection::Ormp,
            &ORMP[..],
        ),
        ("Orthogonal matching pursuit", Selection::Omp, &OMP),
    ] {
        let contest = Contest {
            task,
            input: "802 problems of 300 x 175, 3 signals each, 25 atoms",
            steps: &["all signals, products included"],
            measure: "root mean square residual against that of the signals; difference: signals \
                      for which both did not take the same atoms",
            quality: &|found| Some(residual(&problems, found)),
            difference: &|a, b| Some(unequal(a, b)),
        };
        let question = |ask: &str| json!({"ask": "pursue", "name": ask, "count": PROBLEMS, "sparsity": SPARSITY});
        let mut ours = || Ok(solve(&problems, selection));
        let found = contest_all(settings, &contest, peers, &inputs, &question, &mut ours)?;
        rows.extend(found);
    }
    Ok(rows)
}

/// One dictionary and its signals.
struct Case {
    /// Unit columns.
    dictionary: Mat<f64>,
    signals: Mat<f64>,
}

fn problems() -> Vec<Case> {
    let mut random = Pcg64Mcg::seed_from_u64(802);
    (0..PROBLEMS)
        .map(|index| {
            let is_chart = index % 2 == 0;
            let mut dictionary = if is_chart {
                chart(3 + (index / 2 % 5) as u32, &mut random)
            } else {
                Mat::from_fn(ROWS, ATOMS, |_, _| random.random_range(-1.0..1.0))
            };
            for atom in 0..ATOMS {
                let column = dictionary.col_mut(atom);
                let length = column.norm_l2();
                column.iter_mut().for_each(|x| *x /= length);
            }
            // A sum of all atoms that no few of them give, and some noise.
            let weights = Mat::from_fn(ATOMS, SIGNALS, |_, _| {
                random.random_range(-1.0_f64..1.0).powi(3)
            });
            let mut signals = &dictionary * &weights;
            for signal in 0..SIGNALS {
                let noise = signals.col_mut(signal);
                noise
                    .iter_mut()
                    .for_each(|x| *x += random.random_range(-0.05..0.05));
            }
            Case {
                dictionary,
                signals,
            }
        })
        .collect()
}

/// Returns the dictionary of a chart at random points.
fn chart(valence: u32, random: &mut Pcg64Mcg) -> Mat<f64> {
    let star = Star {
        sectors: valence,
        valence,
    };
    let dictionary = Dictionary::new(DictionaryKind::AllShapes, 14, star);
    let rows: Vec<Vec<f64>> = (0..ROWS)
        .map(|row| {
            let at = [random.random_range(0.0..1.0), random.random_range(0.0..1.0)];
            dictionary.values(row as u32 % valence, at)
        })
        .collect();
    assert_eq!(rows[0].len(), ATOMS, "monomials and shape functions");
    Mat::from_fn(ROWS, ATOMS, |row, atom| rows[row][atom])
}

/// Returns the coefficients of each signal of each problem.
fn solve(problems: &[Case], selection: Selection) -> Timed {
    let mut lap = Lap::start();
    let mut workspace = Workspace::default();
    let mut gram = vec![0.0; ATOMS * ATOMS];
    let mut alpha = Mat::zeros(ATOMS, SIGNALS);
    let allowed = [true; ATOMS];
    let mut dense = vec![0.0; problems.len() * SIGNALS * ATOMS];
    let mut signals = dense.chunks_exact_mut(ATOMS);
    for case in problems {
        multiply(case, &mut gram, &mut alpha);
        for (alpha, dense) in alpha.col_iter().zip(&mut signals) {
            let alpha: Vec<f64> = alpha.iter().copied().collect();
            let problem = Problem {
                gram: &gram,
                components: 1,
                alpha: &alpha,
                allowed: &allowed,
            };
            let found = pursue(problem, selection, SPARSITY, &mut workspace);
            for (&atom, coefficient) in found.support.iter().zip(found.coefficients) {
                dense[usize::from(atom)] = coefficient;
            }
        }
    }
    lap.end();
    lap.with(dense)
}

/// Writes the products of the atoms with each other and with the signals.
fn multiply(case: &Case, gram: &mut [f64], alpha: &mut Mat<f64>) {
    let (left, right) = (case.dictionary.transpose(), case.dictionary.as_ref());
    triangular::matmul(
        MatMut::from_column_major_slice_mut(gram, ATOMS, ATOMS),
        BlockStructure::TriangularLower,
        Accum::Replace,
        left,
        BlockStructure::Rectangular,
        right,
        BlockStructure::Rectangular,
        1.0,
        Par::Seq,
    );
    for j in 0..ATOMS {
        for i in j + 1..ATOMS {
            gram[i * ATOMS + j] = gram[j * ATOMS + i];
        }
    }
    let signals = case.signals.as_ref();
    matmul(alpha.as_mut(), Accum::Replace, left, signals, 1.0, Par::Seq);
}

/// Returns the root mean square residual of all signals against that of the signals.
fn residual(problems: &[Case], found: &[f64]) -> f64 {
    let (mut left, mut all) = (0.0, 0.0);
    for (case, found) in problems.iter().zip(found.chunks_exact(SIGNALS * ATOMS)) {
        let coefficients = Mat::from_fn(ATOMS, SIGNALS, |i, j| found[j * ATOMS + i]);
        left += (&case.signals - &case.dictionary * &coefficients).squared_norm_l2();
        all += case.signals.squared_norm_l2();
    }
    (left / all).sqrt()
}

/// Returns the share of the signals for which both sides did not take the same atoms.
fn unequal(a: &[f64], b: &[f64]) -> f64 {
    let pairs = a.chunks_exact(ATOMS).zip(b.chunks_exact(ATOMS));
    let is_unequal = |(a, b): &(&[f64], &[f64])| {
        let mut atoms = a.iter().zip(b.iter());
        atoms.any(|(&a, &b)| (a == 0.0) != (b == 0.0))
    };
    pairs.filter(is_unequal).count() as f64 / (PROBLEMS * SIGNALS) as f64
}
