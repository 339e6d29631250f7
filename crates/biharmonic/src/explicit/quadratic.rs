//! A quadratic programme of many small blocks whose rows sum to one.
//!
//! # Notation
//! Block `j` has unknowns `x_j` in the rows `S_j`, a positive semidefinite Hessian `Q_j` and bounds
//! `l_j < x_j < u_j`. Minimised is `½ Σ x_jᵀ Q_j x_j` where in every row the unknowns of all blocks
//! sum to one, `Σ E_j x_j = 1`. `z`, `v` are the multipliers of the lower and upper bounds.
//!
//! The Newton systems are reduced to the rows: the Schur complement `Σ E_j (Q_j + D_j)⁻¹ E_jᵀ` is
//! sparse, and its pattern is analysed once. Starting strictly inside the bounds, every iterate is
//! feasible, so that stopping early costs optimality and nothing else.
//!
//! # Reference
//! [Mehrotra1992].

use msplines_common::linalg::{Cholesky, Mat, Ordering, Symbolic, SymmetricMatrix};
use rayon::prelude::*;

use super::small::invert;
use crate::FitError;

/// Most iterations; 10 to 20 are usual.
const MAX_ITERATIONS: u32 = 60;

/// Duality gap against the objective at which an iterate is optimal.
const GAP: f64 = 1e-8;

/// Share of the way to the nearest bound that a step goes.
const STEP: f64 = 0.995;

/// One block of a programme.
pub(super) struct Block {
    /// Rows of the unknowns, ascending.
    pub(super) rows: Vec<u32>,
    /// The Hessian, m × m, both triangles.
    pub(super) hessian: Vec<f64>,
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
    /// Where to start, strictly between the bounds.
    pub(super) start: Vec<f64>,
}

/// The unknowns of all blocks, and how they were found.
pub(super) struct Minimum {
    pub(super) unknowns: Vec<Vec<f64>>,
    #[cfg_attr(not(test), expect(dead_code, reason = "tests bound it"))]
    pub(super) iterations: u32,
    /// Whether the gap was closed.
    pub(super) converged: bool,
    /// Multipliers of the rows and, block by block, of the lower and the upper bounds.
    #[cfg_attr(
        not(test),
        expect(dead_code, reason = "the optimality test reads them")
    )]
    pub(super) multipliers: (Vec<f64>, Vec<[Vec<f64>; 2]>),
}

/// A block and where its unknowns and multipliers are.
struct State<'a> {
    block: &'a Block,
    x: Vec<f64>,
    z: Vec<f64>,
    v: Vec<f64>,
    /// `Q x - Eᵀ y - z + v`.
    stationarity: Vec<f64>,
    /// `(Q + D)⁻¹`.
    inverse: Vec<f64>,
}

/// A step of one block.
#[derive(Default)]
struct Step {
    x: Vec<f64>,
    z: Vec<f64>,
    v: Vec<f64>,
}

/// Minimises a programme of `rows` rows, whose start fulfils all constraints.
pub(super) fn minimise(rows: usize, blocks: &[Block]) -> Result<Minimum, FitError> {
    let unknowns: usize = blocks.iter().map(|block| block.rows.len()).sum();
    let mut states: Vec<State<'_>> = blocks.iter().map(State::start).collect();
    let objective: f64 = states.iter().map(State::energy).sum();
    let barrier = objective / unknowns as f64;
    states.iter_mut().for_each(|state| state.centre(barrier));
    let mut y = vec![0.0; rows];
    let mut schur: Option<Cholesky> = None;
    let (mut iterations, mut converged) = (0, objective == 0.0);
    while !converged && iterations < MAX_ITERATIONS {
        states.par_iter_mut().for_each(|state| state.prepare(&y));
        let matrix = schur_complement(rows, &states);
        let factor = match &mut schur {
            Some(factor) => {
                factor.refactor(&matrix)?;
                &*factor
            }
            none => {
                let ordering = Ordering::nested_dissection(&matrix)?;
                let symbolic = Symbolic::analyze(&matrix, &ordering);
                none.insert(Cholesky::factor(symbolic, &matrix)?)
            }
        };
        let gap: f64 = states.iter().map(State::gap).sum();
        let (_, predicted) = direction(&states, factor, 0.0, None);
        let reached = longest(&states, &predicted);
        let after: f64 = zip(&states, &predicted)
            .map(|(state, step)| state.gap_after(step, reached))
            .sum();
        let centring = gap / (2 * unknowns) as f64 * (after / gap).powi(3);
        let (multipliers, steps) = direction(&states, factor, centring, Some(&predicted));
        let length = (STEP * longest(&states, &steps)).min(1.0);
        let pairs = states.par_iter_mut().zip(&steps);
        pairs.for_each(|(state, step)| state.advance(step, length));
        y.iter_mut()
            .zip(&multipliers)
            .for_each(|(y, step)| *y += length * step);
        iterations += 1;
        states.par_iter_mut().for_each(|state| state.residual(&y));
        converged = optimal(&states);
    }
    Ok(Minimum {
        iterations,
        converged,
        multipliers: (
            y,
            states.iter().map(|s| [s.z.clone(), s.v.clone()]).collect(),
        ),
        unknowns: states.into_iter().map(|state| state.x).collect(),
    })
}

fn zip<'a, 'b>(
    states: &'a [State<'b>],
    steps: &'a [Step],
) -> impl Iterator<Item = (&'a State<'b>, &'a Step)> {
    states.iter().zip(steps)
}

fn optimal(states: &[State<'_>]) -> bool {
    let objective: f64 = states.iter().map(State::energy).sum();
    let gap: f64 = states.iter().map(State::gap).sum();
    let scale = states.iter().map(|s| largest(&s.z).max(largest(&s.v)));
    let scale = scale.fold(0.0, f64::max);
    let residual = states.iter().map(|s| largest(&s.stationarity));
    gap <= GAP * objective && residual.fold(0.0, f64::max) <= GAP * scale
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// Returns `Σ E_j (Q_j + D_j)⁻¹ E_jᵀ`.
fn schur_complement(rows: usize, states: &[State<'_>]) -> SymmetricMatrix {
    let mut entries = Vec::new();
    for state in states {
        let size = state.x.len();
        for (a, &row) in state.block.rows.iter().enumerate() {
            for (b, &column) in state.block.rows[..=a].iter().enumerate() {
                entries.push((row, column, state.inverse[a * size + b]));
            }
        }
    }
    SymmetricMatrix::from_lower_triplets(rows, &entries)
}

/// Returns the Newton step of the rows' multipliers and of the blocks.
///
/// Its goal are products of slacks and multipliers of `centring` less the products of the
/// `predicted` step, which a linear step neglects.
fn direction(
    states: &[State<'_>],
    factor: &Cholesky,
    centring: f64,
    predicted: Option<&[Step]>,
) -> (Vec<f64>, Vec<Step>) {
    let rows = factor.symbolic().size();
    let aims: Vec<Aim> = (0..states.len())
        .into_par_iter()
        .map(|j| states[j].aim(centring, predicted.map(|steps| &steps[j])))
        .collect();
    // The rows still to be filled are zero up to rounding, which this corrects.
    let mut b = Mat::from_fn(rows, 1, |_, _| 1.0);
    for (state, aim) in states.iter().zip(&aims) {
        for (a, &row) in state.block.rows.iter().enumerate() {
            b[(row as usize, 0)] -= state.x[a] + aim.unconstrained[a];
        }
    }
    factor.solve_in_place(b.as_mut());
    let y: Vec<f64> = (0..rows).map(|row| b[(row, 0)]).collect();
    let steps = states
        .par_iter()
        .zip(&aims)
        .map(|(state, aim)| state.step(aim, &y));
    let steps = steps.collect();
    (y, steps)
}

/// Returns the longest step, up to 1, that leaves all slacks and multipliers positive.
fn longest(states: &[State<'_>], steps: &[Step]) -> f64 {
    let lengths = zip(states, steps).map(|(state, step)| state.longest(step));
    lengths.fold(1.0, f64::min)
}

/// The right-hand side of a Newton step.
struct Aim {
    /// What `s z` and `t v` have to change by, with the slacks `s = x - l`, `t = u - x`.
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// The right-hand side `g` of the unknowns, and `(Q + D)⁻¹ g`.
    force: Vec<f64>,
    unconstrained: Vec<f64>,
}

impl<'a> State<'a> {
    fn start(block: &'a Block) -> Self {
        let size = block.rows.len();
        Self {
            block,
            x: block.start.clone(),
            z: vec![0.0; size],
            v: vec![0.0; size],
            stationarity: vec![0.0; size],
            inverse: vec![0.0; size * size],
        }
    }

    fn slacks(&self, a: usize) -> (f64, f64) {
        (
            self.x[a] - self.block.lower[a],
            self.block.upper[a] - self.x[a],
        )
    }

    /// Sets the multipliers so that their products with the slacks are all alike.
    fn centre(&mut self, barrier: f64) {
        for a in 0..self.x.len() {
            let (below, above) = self.slacks(a);
            (self.z[a], self.v[a]) = (barrier / below, barrier / above);
        }
    }

    fn energy(&self) -> f64 {
        dot(&self.x, &times(&self.block.hessian, &self.x))
    }

    fn gap(&self) -> f64 {
        let products = |a: usize| {
            let (below, above) = self.slacks(a);
            below * self.z[a] + above * self.v[a]
        };
        (0..self.x.len()).map(products).sum()
    }

    fn gap_after(&self, step: &Step, length: f64) -> f64 {
        let products = |a: usize| {
            let (below, above) = self.slacks(a);
            (below + length * step.x[a]) * (self.z[a] + length * step.z[a])
                + (above - length * step.x[a]) * (self.v[a] + length * step.v[a])
        };
        (0..self.x.len()).map(products).sum()
    }

    fn residual(&mut self, y: &[f64]) {
        self.stationarity = times(&self.block.hessian, &self.x);
        for (a, &row) in self.block.rows.iter().enumerate() {
            self.stationarity[a] += self.v[a] - self.z[a] - y[row as usize];
        }
    }

    fn prepare(&mut self, y: &[f64]) {
        self.residual(y);
        self.inverse.copy_from_slice(&self.block.hessian);
        let size = self.x.len();
        for a in 0..size {
            let (below, above) = self.slacks(a);
            self.inverse[a * size + a] += self.z[a] / below + self.v[a] / above;
        }
        invert(&mut self.inverse, size);
    }

    fn aim(&self, centring: f64, predicted: Option<&Step>) -> Aim {
        let size = self.x.len();
        let (mut lower, mut upper) = (vec![0.0; size], vec![0.0; size]);
        let mut force = vec![0.0; size];
        for a in 0..size {
            let (below, above) = self.slacks(a);
            let (second, third) = predicted.map_or((0.0, 0.0), |step| {
                (step.x[a] * step.z[a], -step.x[a] * step.v[a])
            });
            lower[a] = centring - below * self.z[a] - second;
            upper[a] = centring - above * self.v[a] - third;
            force[a] = lower[a] / below - upper[a] / above - self.stationarity[a];
        }
        Aim {
            unconstrained: times(&self.inverse, &force),
            lower,
            upper,
            force,
        }
    }

    fn step(&self, aim: &Aim, y: &[f64]) -> Step {
        let rows = self.block.rows.iter();
        let force: Vec<f64> = rows
            .zip(&aim.force)
            .map(|(&row, g)| g + y[row as usize])
            .collect();
        let x = times(&self.inverse, &force);
        let (mut z, mut v) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        for a in 0..x.len() {
            let (below, above) = self.slacks(a);
            z[a] = (aim.lower[a] - self.z[a] * x[a]) / below;
            v[a] = (aim.upper[a] + self.v[a] * x[a]) / above;
        }
        Step { x, z, v }
    }

    fn longest(&self, step: &Step) -> f64 {
        let mut length: f64 = 1.0;
        for a in 0..self.x.len() {
            let (below, above) = self.slacks(a);
            let pairs = [
                (below, step.x[a]),
                (above, -step.x[a]),
                (self.z[a], step.z[a]),
                (self.v[a], step.v[a]),
            ];
            for (value, change) in pairs {
                if change < 0.0 {
                    length = length.min(-value / change);
                }
            }
        }
        length
    }

    fn advance(&mut self, step: &Step, length: f64) {
        for a in 0..self.x.len() {
            self.x[a] += length * step.x[a];
            self.z[a] += length * step.z[a];
            self.v[a] += length * step.v[a];
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Returns a square matrix, row after row, times a vector.
fn times(matrix: &[f64], x: &[f64]) -> Vec<f64> {
    matrix
        .chunks_exact(x.len())
        .map(|row| dot(row, x))
        .collect()
}
