//! Factors and solutions of the bi-Laplacian of a mesh without the rows of its knots.

use msplines_common::linalg::{Cholesky, Mat, Ordering, Symbolic, SymmetricMatrix};
use msplines_common::operators::mesh_operators;
use msplines_compare::peers::PeerRow;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::contest::{Rival, Timed, version_of};
use super::{Contest, Failure, Model, Settings, Stand};
use crate::cholmod::{Cholmod, EliminationOrder, Ldlt, Lower, blas};
use crate::{Library, cpu_seconds};

/// Right-hand sides of a solution.
const SIDES: usize = 3;
/// One vertex in so many is a knot.
const KNOT_STEP: usize = 100;

pub(super) fn run(settings: &Settings, model: Model) -> Result<Vec<PeerRow>, Failure> {
    compare(settings, &settings.stand(model)?)
}

/// Returns which vertices are knots: 1 % of them, at random.
pub(super) fn knots(vertices: usize) -> Vec<bool> {
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let mut is_knot = vec![false; vertices];
    let mut left = vertices / KNOT_STEP;
    while left > 0 {
        let knot = &mut is_knot[random.random_range(0..vertices)];
        left -= usize::from(!*knot);
        *knot = true;
    }
    is_knot
}

fn compare(settings: &Settings, stand: &Stand) -> Result<Vec<PeerRow>, Failure> {
    let matrix = mesh_operators(&stand.mesh).bilaplacian();
    let is_knot = knots(matrix.size());
    let free: Vec<usize> = (0..matrix.size()).filter(|&row| !is_knot[row]).collect();
    let mut random = Pcg64Mcg::seed_from_u64(2);
    let b: Vec<f64> = (0..SIDES * free.len())
        .map(|_| random.random_range(-1.0..1.0))
        .collect();
    let contest = Contest {
        task: "Bi-Laplacian without the rows of 1 % of the vertices",
        input: &stand.name,
        steps: &["order, analyse and factor", "factor again", "solve 3 sides"],
        measure: "largest residual against the largest right-hand side; difference against the \
                  largest value",
        quality: &|x| Some(residual(&matrix, &free, x, &b)),
        difference: &|x, y| Some(largest_difference(x, y) / largest(x)),
    };
    let lower = Lower::of(&matrix, |row| !is_knot[row]);
    let mut rows = Vec::new();
    for (name, order) in [
        ("CHOLMOD, METIS", EliminationOrder::Metis),
        ("CHOLMOD, AMD", EliminationOrder::Amd),
    ] {
        let rival = Rival {
            name,
            version: version_of(Library::Cholmod).map(|number| format!("{number}, {}", blas())),
            remark: "supernodal; as fast as the BLAS that is named; both sides order in the same way",
        };
        rows.extend(contest.run(
            settings,
            &rival,
            &mut || ours(&matrix, order, &is_knot, &free, &b),
            &mut || Ok(cholmod(&lower, order, &b)),
        )?);
    }
    let rival = Rival {
        name: "Eigen SimplicialLDLT, AMD",
        version: version_of(Library::Eigen),
        remark: "compiled with -O3 for any x86-64, as the rest of this package; both sides order by minimum degree",
    };
    rows.extend(contest.run(
        settings,
        &rival,
        &mut || ours(&matrix, EliminationOrder::Amd, &is_knot, &free, &b),
        &mut || Ok(eigen(&lower, &b)),
    )?);
    Ok(rows)
}

/// Solves with the kind of order that the peer takes.
fn ours(
    matrix: &SymmetricMatrix,
    order: EliminationOrder,
    is_knot: &[bool],
    free: &[usize],
    b: &[f64],
) -> Result<Timed, Failure> {
    let mut lap = Lap::start();
    let ordering = match order {
        EliminationOrder::Metis => Ordering::nested_dissection(matrix)?,
        EliminationOrder::Amd => Ordering::minimum_degree(matrix, |row| !is_knot[row])?,
    };
    let symbolic = Symbolic::analyze_kept(matrix, &ordering, |row| !is_knot[row]);
    let mut factor = Cholesky::factor(symbolic, matrix)?;
    lap.end();
    factor.refactor(matrix)?;
    lap.end();
    let mut x = Mat::zeros(matrix.size(), SIDES);
    for (side, values) in b.chunks_exact(free.len()).enumerate() {
        for (&row, &value) in free.iter().zip(values) {
            x[(row, side)] = value;
        }
    }
    lap.skip();
    factor.solve_in_place(x.as_mut());
    lap.end();
    let result = (0..SIDES).flat_map(|side| free.iter().map(move |&row| (row, side)));
    Ok(lap.with(result.map(|at| x[at]).collect()))
}

fn cholmod(lower: &Lower, order: EliminationOrder, b: &[f64]) -> Timed {
    let mut solver = Cholmod::new(lower, order);
    let mut lap = Lap::start();
    solver.analyze();
    solver.factor();
    lap.end();
    solver.factor();
    lap.end();
    let mut x = vec![0.0; b.len()];
    lap.skip();
    solver.solve(b, &mut x);
    lap.end();
    lap.with(x)
}

fn eigen(lower: &Lower, b: &[f64]) -> Timed {
    let mut solver = Ldlt::new(lower);
    let mut lap = Lap::start();
    solver.analyze();
    solver.factor();
    lap.end();
    solver.factor();
    lap.end();
    let mut x = vec![0.0; b.len()];
    lap.skip();
    solver.solve(b, &mut x);
    lap.end();
    lap.with(x)
}

/// Processor time of this process, step by step.
pub(super) struct Lap {
    since: f64,
    seconds: Vec<f64>,
}

impl Lap {
    pub(super) fn start() -> Self {
        Self {
            since: cpu_seconds(),
            seconds: Vec::new(),
        }
    }

    /// Ends a step.
    pub(super) fn end(&mut self) {
        let now = cpu_seconds();
        self.seconds.push(now - self.since);
        self.since = now;
    }

    /// Leaves out what has been done since the last step.
    pub(super) fn skip(&mut self) {
        self.since = cpu_seconds();
    }

    pub(super) fn with(self, result: Vec<f64>) -> Timed {
        Timed {
            seconds: self.seconds,
            result,
        }
    }
}

/// Returns the largest residual of solutions of the rows that are free, against the largest value of `b`.
fn residual(matrix: &SymmetricMatrix, free: &[usize], x: &[f64], b: &[f64]) -> f64 {
    let mut worst = 0.0_f64;
    for (x, b) in x.chunks_exact(free.len()).zip(b.chunks_exact(free.len())) {
        let mut whole = Mat::zeros(matrix.size(), 1);
        free.iter()
            .zip(x)
            .for_each(|(&row, &value)| whole[(row, 0)] = value);
        let product = matrix.multiply(whole.as_ref());
        let residuals = free.iter().zip(b).map(|(&row, b)| product[(row, 0)] - b);
        worst = residuals.fold(worst, |worst, r| worst.max(r.abs()));
    }
    worst / largest(b)
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |largest, x| x.abs().max(largest))
}

pub(super) fn largest_difference(x: &[f64], y: &[f64]) -> f64 {
    if x.len() != y.len() {
        return f64::INFINITY;
    }
    let differences = x.iter().zip(y).map(|(x, y)| (x - y).abs());
    differences.fold(0.0, |largest, d| {
        if d > largest || d.is_nan() {
            d
        } else {
            largest
        }
    })
}
