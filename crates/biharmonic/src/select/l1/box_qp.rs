//! A box-constrained least-squares problem, by a primal-dual interior-point method.
//!
//! The penalised problem of one component of the data `s`,
//!
//! ```text
//! min  1/2 |s - f|² + Σ bᵢ |(B f)ᵢ|        bᵢ = ∞ demands (B f)ᵢ = 0,
//! ```
//!
//! has the dual `min 1/2 |s - B u|²` with `|uᵢ| ≤ bᵢ`, and `f = s - B u`. The dual is solved: its
//! Newton steps factor `B² + D` with a diagonal `D`, always of one pattern, so that one elimination
//! order and one analysis serve all steps of all problems on a mesh. Rows of `B` may be scaled in any
//! way: that scales `bᵢ`, `uᵢ` and `wᵢ`, and changes neither `f` nor any step.
//!
//! # Notation
//! `w = B f` the coefficients; `p, q > 0` the multipliers of `u ≤ b` and `-b ≤ u`, so that `w = p - q`
//! at the solution.
//!
//! # Reference
//! [Mehrotra1992]; [Hou2017] Eq. (9). Deviation: the penalised form, whose factor takes the place of
//! the bound on the weighted norm.

use std::ops::Range;
use std::sync::Arc;

use msplines_common::linalg::{
    Cholesky, FactorError, Mat, Ordering, Symbolic, SymmetricMatrix, column,
};

use crate::{Bilaplacian, FitError, Space};

/// Steps allowed to a solve. Five to fifteen are taken.
const MAX_STEPS: u32 = 60;

/// Share of the way to the boundary that a step may go.
const STEP_SHARE: f64 = 0.995;

/// Shares of the diagonal that may be added to a matrix without a factor: from rounding errors on.
const SHIFTS: Range<f64> = 1e-15..1e-6;

/// Factor from one such share to the next.
const SHIFT_GROWTH: f64 = 30.0;

/// What the interior-point steps on one mesh share.
pub(super) struct BoxQp<'a> {
    bilaplacian: &'a SymmetricMatrix,
    /// `B²`.
    square: SymmetricMatrix,
    /// Diagonal of `B²`.
    diagonal: Vec<f64>,
    symbolic: Arc<Symbolic>,
}

/// A solution of one problem.
pub(super) struct BoxSolution {
    /// The dual solution `u`, strictly within the bounds.
    pub(super) dual: Vec<f64>,
    /// `w = B f`.
    pub(super) coefficients: Vec<f64>,
    /// `|s - f|²`.
    pub(super) squared_distance: f64,
    /// Gap between the primal and the dual objective, relative to the primal one.
    pub(super) gap: f64,
}

impl BoxSolution {
    /// Returns whether a coefficient is not zero at the solution that this one comes close to.
    ///
    /// At the solution either `wᵢ` or the room that `uᵢ` has in its bounds is zero; before it their
    /// product is small, and the larger tells. `unit` is the size of a typical `bᵢ wᵢ`.
    pub(super) fn is_active(&self, row: usize, bound: f64, unit: f64) -> bool {
        bound * self.coefficients[row].abs() / unit > 1.0 - self.dual[row].abs() / bound
    }
}

impl<'a> BoxQp<'a> {
    /// Forms `B²`, orders and analyses it.
    pub(super) fn build(space: &'a Space) -> Result<Self, FitError> {
        let Bilaplacian { matrix, .. } = space.bilaplacian()?;
        let square = matrix.congruence(&vec![1.0; matrix.size()]);
        let ordering = Ordering::nested_dissection(&square)?;
        let symbolic = Arc::new(Symbolic::analyze(&square, &ordering));
        Ok(Self {
            bilaplacian: matrix,
            diagonal: square.diagonal(),
            square,
            symbolic,
        })
    }

    /// Solves the problem with data `s` and positive `bounds`, down to the relative `gap`.
    pub(super) fn solve(
        &self,
        s: &[f64],
        bounds: &[f64],
        gap: f64,
    ) -> Result<BoxSolution, FitError> {
        let mut iterate = Iterate::start(self.bilaplacian, s, bounds);
        let (mut shift, mut steps) = (0.0, 0);
        loop {
            let reached = iterate.gap();
            if reached <= gap || steps == MAX_STEPS {
                return Ok(iterate.into_solution(reached));
            }
            let factor = self.factor(&iterate.curvature(), &mut shift)?;
            iterate.step(&factor);
            iterate.update(self.bilaplacian);
            steps += 1;
        }
    }

    /// Factors `B² + D`, with the share `shift` of the diagonal of `B²` added to it.
    ///
    /// Where hardly any row is bounded, the sum is as singular as `B²`, whose null space are the
    /// constant `u`; these change nothing. The shift is raised until the sum has a factor. It only
    /// shortens steps: the gap, which decides, knows nothing of it.
    fn factor(&self, curvature: &[f64], shift: &mut f64) -> Result<Cholesky, FactorError> {
        loop {
            let diagonal = self.diagonal.iter().zip(curvature);
            let added: Vec<f64> = diagonal
                .map(|(d, curvature)| curvature + *shift * d)
                .collect();
            let matrix = self.square.plus_diagonal(&added);
            match Cholesky::factor(Arc::clone(&self.symbolic), &matrix) {
                Err(FactorError::NotPositiveDefinite { .. }) if *shift < SHIFTS.end => {
                    *shift = (SHIFT_GROWTH * *shift).max(SHIFTS.start);
                }
                result => return result,
            }
        }
    }
}

/// A strictly feasible point.
///
/// Rows without bounds have infinite room and zero multipliers; all formulas hold for them as they
/// stand.
struct Iterate<'b> {
    s: &'b [f64],
    bounds: &'b [f64],
    u: Vec<f64>,
    p: Vec<f64>,
    q: Vec<f64>,
    f: Vec<f64>,
    w: Vec<f64>,
}

/// Room above and below `u`, and its multipliers, in one row.
struct Row {
    above: f64,
    below: f64,
    p: f64,
    q: f64,
}

/// A direction of `u`, `p` and `q`.
struct Direction {
    u: Vec<f64>,
    p: Vec<f64>,
    q: Vec<f64>,
}

impl<'b> Iterate<'b> {
    fn start(bilaplacian: &SymmetricMatrix, s: &'b [f64], bounds: &'b [f64]) -> Self {
        let n = s.len();
        let mut iterate = Self {
            s,
            bounds,
            u: vec![0.0; n],
            p: vec![0.0; n],
            q: vec![0.0; n],
            f: Vec::new(),
            w: Vec::new(),
        };
        iterate.update(bilaplacian);
        let boxed = iterate.boxed().count().max(1) as f64;
        let mean = iterate
            .boxed()
            .map(|i| bounds[i] * iterate.w[i].abs())
            .sum::<f64>()
            / boxed;
        for (i, &bound) in bounds.iter().enumerate().filter(|(_, b)| b.is_finite()) {
            iterate.p[i] = iterate.w[i].max(0.0) + mean / bound;
            iterate.q[i] = (-iterate.w[i]).max(0.0) + mean / bound;
        }
        iterate
    }

    /// Rows with bounds.
    fn boxed(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.bounds.len()).filter(|&i| self.bounds[i].is_finite())
    }

    /// Computes `f` and `w` of the present `u`.
    fn update(&mut self, bilaplacian: &SymmetricMatrix) {
        let image = bilaplacian.multiply(as_column(&self.u).as_ref());
        self.f = self
            .s
            .iter()
            .zip(column(image.as_ref(), 0))
            .map(|(s, image)| s - image)
            .collect();
        let w = bilaplacian.multiply(as_column(&self.f).as_ref());
        self.w = column(w.as_ref(), 0).to_vec();
    }

    /// Returns the gap between the primal and the dual objective, relative to the primal one.
    ///
    /// Each row adds what is not negative at a feasible point, so that a small gap means both.
    fn gap(&self) -> f64 {
        let (mut gap, mut penalty) = (0.0, 0.0);
        for ((&bound, u), w) in self.bounds.iter().zip(&self.u).zip(&self.w) {
            if bound.is_finite() {
                penalty += bound * w.abs();
                gap += bound * w.abs() - u * w;
            } else {
                gap += (u * w).abs();
            }
        }
        let objective = 0.5 * self.squared_distance() + penalty;
        if objective > 0.0 {
            gap / objective
        } else {
            0.0
        }
    }

    /// Returns the diagonal that the barrier adds to `B²`.
    fn curvature(&self) -> Vec<f64> {
        self.rows()
            .map(|row| row.p / row.above + row.q / row.below)
            .collect()
    }

    /// Moves along the predicted and corrected direction.
    fn step(&mut self, factor: &Cholesky) {
        let boxed = self.bounds.iter().filter(|b| b.is_finite()).count().max(1);
        let predicted = self.direction(factor, 0.0, None);
        let reach = self.reach(&predicted).min(1.0);
        let barrier = self.complementarity(&predicted, 0.0) / (2 * boxed) as f64;
        let left = self.complementarity(&predicted, reach) / (2 * boxed) as f64;
        let centring = if barrier > 0.0 {
            (left / barrier).powi(3)
        } else {
            0.0
        };
        let corrected = self.direction(factor, centring * barrier, Some(&predicted));
        let length = (STEP_SHARE * self.reach(&corrected)).min(1.0);
        for i in 0..self.u.len() {
            self.u[i] += length * corrected.u[i];
            self.p[i] += length * corrected.p[i];
            self.q[i] += length * corrected.q[i];
        }
    }

    /// Returns the Newton direction towards complementary products of `target`.
    fn direction(
        &self,
        factor: &Cholesky,
        target: f64,
        predicted: Option<&Direction>,
    ) -> Direction {
        let second_order =
            |i: usize| predicted.map_or((0.0, 0.0), |d| (d.u[i] * d.p[i], -d.u[i] * d.q[i]));
        let targets: Vec<(f64, f64)> = self
            .rows()
            .enumerate()
            .map(|(i, row)| {
                let (p, q) = second_order(i);
                ((target + p) / row.above, (target + q) / row.below)
            })
            .collect();
        let mut rhs = Mat::from_fn(self.u.len(), 1, |i, _| {
            self.w[i] - targets[i].0 + targets[i].1
        });
        factor.solve_in_place(rhs.as_mut());
        let u = column(rhs.as_ref(), 0).to_vec();
        let along = |i: usize, row: &Row| {
            (
                targets[i].0 - row.p + row.p / row.above * u[i],
                targets[i].1 - row.q - row.q / row.below * u[i],
            )
        };
        let (p, q) = self
            .rows()
            .enumerate()
            .map(|(i, row)| along(i, &row))
            .unzip();
        Direction { u, p, q }
    }

    /// Returns how much of a direction leads to the boundary.
    fn reach(&self, direction: &Direction) -> f64 {
        let mut reach = f64::INFINITY;
        for (i, row) in self.rows().enumerate() {
            let (u, p, q) = (direction.u[i], direction.p[i], direction.q[i]);
            let limits = [(row.above, -u), (row.below, u), (row.p, p), (row.q, q)];
            for (room, change) in limits {
                if change < 0.0 {
                    reach = reach.min(room / -change);
                }
            }
        }
        reach
    }

    /// Returns the sum of all complementary products after a share of a direction.
    fn complementarity(&self, direction: &Direction, share: f64) -> f64 {
        let products = self
            .rows()
            .enumerate()
            .filter(|(_, row)| row.above.is_finite());
        products
            .map(|(i, row)| {
                let u = share * direction.u[i];
                (row.above - u) * (row.p + share * direction.p[i])
                    + (row.below + u) * (row.q + share * direction.q[i])
            })
            .sum()
    }

    fn rows(&self) -> impl Iterator<Item = Row> + '_ {
        (0..self.u.len()).map(|i| Row {
            above: self.bounds[i] - self.u[i],
            below: self.bounds[i] + self.u[i],
            p: self.p[i],
            q: self.q[i],
        })
    }

    fn squared_distance(&self) -> f64 {
        let differences = self.s.iter().zip(&self.f).map(|(s, f)| s - f);
        differences.map(|difference| difference * difference).sum()
    }

    fn into_solution(self, gap: f64) -> BoxSolution {
        BoxSolution {
            squared_distance: self.squared_distance(),
            dual: self.u,
            coefficients: self.w,
            gap,
        }
    }
}

fn as_column(values: &[f64]) -> Mat<f64> {
    Mat::from_fn(values.len(), 1, |row, _| values[row])
}
