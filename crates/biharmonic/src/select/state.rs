//! The present knots, their spline, and the two moves: remove some, insert some.

use std::collections::BTreeSet;

use msplines_common::linalg::Mat;

use super::scores::insertion_denominators;
use super::voronoi::{Graph, largest_in_cells};
use crate::gram::{Gram, Sight};
use crate::knot_values::KnotValues;
use crate::rings::Rings;
use crate::target::Centred;
use crate::{FitError, Space};

/// How good a fit is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Precision {
    /// Good enough to choose the next move.
    Rough,
    /// Good enough to compare two sets of knots.
    Fair,
    /// Good enough to compare their largest errors.
    Fine,
}

impl Precision {
    /// Returns the share by which the squared error may exceed its minimum.
    fn excess(self) -> f64 {
        match self {
            Self::Rough => 1e-2,
            Self::Fair => 2e-3,
            Self::Fine => 1e-5,
        }
    }
}

/// Iterations allowed to a fit between rounds.
const ROUND_ITERATIONS: u32 = 30;

/// Knots and their spline, without their factor.
pub(super) struct Saved {
    knots: Vec<u32>,
    fitted: Mat<f64>,
    error: f64,
}

impl Saved {
    pub(super) fn error(&self) -> f64 {
        self.error
    }
}

/// A set of knots, its factors, and the spline that is nearest to the data.
pub(super) struct State<'a> {
    target: &'a Centred,
    graph: Graph,
    seed: u64,
    moves: u64,
    system: KnotValues<'a>,
    rings: Rings,
    gram: Gram,
    /// The spline at all vertices.
    fitted: Mat<f64>,
    /// Weighted sum of squared errors.
    error: f64,
}

impl<'a> State<'a> {
    pub(super) fn start(
        space: &'a Space,
        target: &'a Centred,
        knots: Vec<u32>,
        seed: u64,
    ) -> Result<Self, FitError> {
        let graph = Graph::build(space.mesh());
        let system = KnotValues::factor(space, knots)?;
        let rings = Rings::along(&graph, system.knots());
        let gram = Gram::estimate(&system, target, &rings, Sight::Ring)?;
        let mut state = Self {
            target,
            graph,
            seed,
            moves: 0,
            system,
            rings,
            gram,
            fitted: target.data.clone(),
            error: 0.0,
        };
        state.fit(Precision::Rough);
        Ok(state)
    }

    pub(super) fn knots(&self) -> &[u32] {
        self.system.knots()
    }

    pub(super) fn error(&self) -> f64 {
        self.error
    }

    /// Returns the root mean square of the error at the vertices, in the units of the data.
    pub(super) fn root_mean_square(&self) -> f64 {
        (self.error / self.target.total_weight()).sqrt()
    }

    /// Returns the system of the knots, what preconditions it, and the spline.
    pub(super) fn into_parts(self) -> (KnotValues<'a>, Gram, Mat<f64>) {
        (self.system, self.gram, self.fitted)
    }

    /// Returns the knots that can go: up to `count`, cheapest first, none beside another.
    pub(super) fn cheapest(&self, count: usize) -> Vec<u32> {
        self.cheapest_of(count, |_| true)
    }

    /// The same among the knots whose index `can_go`.
    pub(super) fn cheapest_of(&self, count: usize, can_go: impl Fn(usize) -> bool) -> Vec<u32> {
        let squares = row_squares(&self.system.coefficients(&self.fitted));
        let costs = ratios(squares, &self.gram.removal);
        let mut costs: Vec<(f64, u32)> = costs.into_iter().zip(0..).collect();
        costs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut blocked = vec![false; self.knots().len()];
        let mut chosen = Vec::with_capacity(count);
        for (_, k) in costs {
            if chosen.len() == count {
                break;
            }
            if !blocked[k as usize] && can_go(k as usize) {
                let around = self.rings.neighbours(k as usize).iter();
                around.for_each(|&other| blocked[other as usize] = true);
                chosen.push(self.knots()[k as usize]);
            }
        }
        chosen
    }

    /// Returns the vertices most worth a knot: up to `count`, best first, one in a cell.
    pub(super) fn most_wanted(&self, count: usize) -> Vec<u32> {
        let cells = self.rings.cells();
        let mut best = largest_in_cells(cells, &self.gains(), self.knots().len());
        best.retain(|candidate| candidate.0 > 0.0);
        best.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        best.into_iter()
            .take(count)
            .map(|(_, vertex)| vertex)
            .collect()
    }

    /// Returns what a knot would gain at each vertex, zero at knots.
    pub(super) fn gains(&self) -> Vec<f64> {
        let mut residual = &self.target.data - &self.fitted;
        self.target.weigh_twice(&mut residual);
        let squares = row_squares(&self.system.solve_free(residual));
        let seed = self.seed.wrapping_add(self.moves);
        let denominators = insertion_denominators(&self.system, self.target, seed);
        ratios(squares, &denominators)
    }

    /// Returns the distance of the spline to the data at each vertex, times its weight.
    pub(super) fn distances(&self) -> Vec<f64> {
        let mut residual = &self.target.data - &self.fitted;
        self.target.weigh(&mut residual);
        let squares = row_squares(&residual);
        squares.into_iter().map(f64::sqrt).collect()
    }

    /// Returns the cells of the knots.
    pub(super) fn rings(&self) -> &Rings {
        &self.rings
    }

    /// Adds knots and fits again.
    pub(super) fn insert(
        &mut self,
        inserted: &[u32],
        precision: Precision,
    ) -> Result<(), FitError> {
        let mut knots = [self.knots(), inserted].concat();
        knots.sort_unstable();
        knots.dedup();
        self.change(&knots)?;
        self.fit(precision);
        Ok(())
    }

    /// Removes knots and fits again.
    pub(super) fn remove(&mut self, removed: &[u32], precision: Precision) -> Result<(), FitError> {
        let gone: BTreeSet<u32> = removed.iter().copied().collect();
        let mut knots = self.knots().to_vec();
        knots.retain(|knot| !gone.contains(knot));
        self.change(&knots)?;
        self.fit(precision);
        Ok(())
    }

    /// Returns what it takes to come back to the present knots. Their factor, which is most of a
    /// state, is not part of it: going back is rarer than going on.
    pub(super) fn save(&self) -> Saved {
        Saved {
            knots: self.knots().to_vec(),
            fitted: self.fitted.clone(),
            error: self.error,
        }
    }

    /// Comes back to knots that were saved.
    pub(super) fn restore(&mut self, saved: Saved) -> Result<(), FitError> {
        self.change(&saved.knots)?;
        self.fitted = saved.fitted;
        self.error = saved.error;
        Ok(())
    }

    fn change(&mut self, knots: &[u32]) -> Result<(), FitError> {
        let (rings, factored) = rayon::join(
            || Rings::along(&self.graph, knots),
            || self.system.change(knots.to_vec()),
        );
        factored?;
        self.rings = rings;
        self.gram = Gram::estimate(&self.system, self.target, &self.rings, Sight::Ring)?;
        self.moves += 1;
        Ok(())
    }

    /// Fits the knots, from the present spline on.
    pub(super) fn fit(&mut self, precision: Precision) {
        let (fitted, _) = self.system.least_squares(
            self.target,
            &self.fitted,
            &self.gram,
            precision.excess(),
            ROUND_ITERATIONS,
        );
        self.fitted = fitted;
        let mut residual = &self.target.data - &self.fitted;
        self.target.weigh(&mut residual);
        self.error = residual.squared_norm_l2();
    }
}

fn row_squares(rows: &Mat<f64>) -> Vec<f64> {
    let square = |row| (0..rows.ncols()).map(|c| rows[(row, c)].powi(2)).sum();
    (0..rows.nrows()).map(square).collect()
}

/// Returns the squares over the denominators, zero where these are.
fn ratios(squares: Vec<f64>, denominators: &[f64]) -> Vec<f64> {
    let pairs = squares.into_iter().zip(denominators);
    let ratio = |(square, &denominator)| match denominator > 0.0 {
        true => square / denominator,
        false => 0.0,
    };
    pairs.map(ratio).collect()
}
