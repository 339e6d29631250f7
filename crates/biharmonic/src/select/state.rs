//! The present knots, their spline, and the two moves: remove some, insert some.

use std::collections::BTreeSet;

use msplines_common::linalg::Mat;

use super::scores::{Probes, removal_denominators};
use super::voronoi::{Graph, largest_in_cells};
use crate::knot_values::KnotValues;
use crate::target::Centred;
use crate::{FitError, Space};

/// Share by which the squared error of a fit may exceed its minimum where the fit only serves to
/// choose the next move.
const ROUGH_EXCESS: f64 = 1e-2;

/// The same where two sets of knots are compared.
const FAIR_EXCESS: f64 = 2e-3;

/// Iterations allowed to a fit between rounds.
const ROUND_ITERATIONS: u32 = 30;

pub(super) struct State<'a> {
    space: &'a Space,
    target: &'a Centred,
    graph: Graph,
    seed: u64,
    moves: u64,
    system: KnotValues<'a>,
    probes: Probes,
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
        let system = KnotValues::factor(space, knots)?;
        let probes = Probes::estimate(&system, target, seed);
        let graph = Graph::build(space.mesh());
        let mut state = Self {
            space,
            target,
            graph,
            seed,
            moves: 0,
            system,
            probes,
            fitted: target.data.clone(),
            error: 0.0,
        };
        state.fit(ROUGH_EXCESS);
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

    pub(super) fn into_parts(self) -> (Vec<u32>, Mat<f64>) {
        (self.system.knots().to_vec(), self.fitted)
    }

    /// Returns the knots that can go: up to `count`, cheapest first, none beside another.
    pub(super) fn cheapest(&self, count: usize) -> Vec<u32> {
        self.cheapest_of(count, |_| true)
    }

    /// The same among the knots whose index `can_go`.
    pub(super) fn cheapest_of(&self, count: usize, can_go: impl Fn(usize) -> bool) -> Vec<u32> {
        let seed = self.seed.wrapping_add(self.moves);
        let denominators = removal_denominators(&self.system, &self.probes.scale, seed);
        let coefficients = self.system.coefficients(&self.fitted);
        let mut costs: Vec<(f64, u32)> = denominators
            .iter()
            .enumerate()
            .map(|(k, &denominator)| {
                let square: f64 = (0..coefficients.ncols())
                    .map(|c| coefficients[(k, c)].powi(2))
                    .sum();
                (
                    if denominator > 0.0 {
                        square / denominator
                    } else {
                        0.0
                    },
                    k as u32,
                )
            })
            .collect();
        costs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let adjacency = self.adjacency(&self.cells());
        let mut blocked = vec![false; self.knots().len()];
        let mut chosen = Vec::with_capacity(count);
        for (_, k) in costs {
            if chosen.len() == count {
                break;
            }
            if !blocked[k as usize] && can_go(k as usize) {
                adjacency[k as usize]
                    .iter()
                    .for_each(|&other| blocked[other as usize] = true);
                chosen.push(self.knots()[k as usize]);
            }
        }
        chosen
    }

    /// Returns the vertices most worth a knot: up to `count`, best first, one in a cell.
    pub(super) fn most_wanted(&self, count: usize) -> Vec<u32> {
        let mut best = largest_in_cells(&self.cells(), &self.gains(), self.knots().len());
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
        let gains = squares.into_iter().zip(&self.probes.insertion);
        gains
            .map(|(square, &denominator)| {
                if denominator > 0.0 {
                    square / denominator
                } else {
                    0.0
                }
            })
            .collect()
    }

    /// Returns the distance of the spline to the data at each vertex, times its weight.
    pub(super) fn distances(&self) -> Vec<f64> {
        let mut residual = &self.target.data - &self.fitted;
        self.target.weigh(&mut residual);
        let squares = row_squares(&residual);
        squares.into_iter().map(f64::sqrt).collect()
    }

    /// Returns the nearest knot (as its index) of every vertex.
    pub(super) fn cells(&self) -> Vec<u32> {
        self.graph.cells(self.knots())
    }

    /// Returns, for each knot, the knots whose cells touch its own.
    pub(super) fn adjacency(&self, cells: &[u32]) -> Vec<BTreeSet<u32>> {
        self.graph.adjacency(cells, self.knots().len())
    }

    /// Returns the state without some knots and with others, fitted again.
    pub(super) fn moved(&self, removed: &[u32], inserted: &[u32]) -> Result<Self, FitError> {
        let mut knots: BTreeSet<u32> = self.knots().iter().copied().collect();
        removed.iter().for_each(|knot| {
            knots.remove(knot);
        });
        knots.extend(inserted);
        let system = KnotValues::factor(self.space, knots.into_iter().collect())?;
        // Only what lost knots is compared with another set; what gained some is about to lose them.
        let compared = !removed.is_empty();
        let moves = self.moves + 1;
        let probes = Probes::estimate(&system, self.target, self.seed.wrapping_add(moves));
        let mut state = Self {
            space: self.space,
            target: self.target,
            graph: self.graph.clone(),
            seed: self.seed,
            moves,
            system,
            probes,
            fitted: self.fitted.clone(),
            error: 0.0,
        };
        state.fit(if compared { FAIR_EXCESS } else { ROUGH_EXCESS });
        Ok(state)
    }

    /// Fits the knots, from the present spline on.
    pub(super) fn fit(&mut self, excess: f64) {
        let (fitted, _) = self.system.least_squares(
            self.target,
            &self.fitted,
            &self.probes.scale,
            excess,
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
