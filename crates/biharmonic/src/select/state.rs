//! The present knots, their spline, and the two moves: remove some, insert some.

use std::collections::BTreeSet;

use msplines_common::linalg::Mat;

use super::scores::insertion_denominators;
use super::voronoi::Graph;
use crate::gram::Gram;
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
}

impl Precision {
    /// Returns the share by which the squared error may exceed its minimum.
    fn excess(self) -> f64 {
        match self {
            Self::Rough => 1e-2,
            Self::Fair => 2e-3,
        }
    }
}

/// Iterations allowed to a fit between rounds.
const ROUND_ITERATIONS: u32 = 30;

pub(super) struct State<'a> {
    space: &'a Space,
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
        let gram = Gram::estimate(&system, target, &rings)?;
        let mut state = Self {
            space,
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

    pub(super) fn into_parts(self) -> (Vec<u32>, Mat<f64>) {
        (self.system.knots().to_vec(), self.fitted)
    }

    /// Returns the knots that can go: up to `count`, cheapest first, none beside another.
    pub(super) fn cheapest(&self, count: usize) -> Vec<u32> {
        let denominators = &self.gram.removal;
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
        let mut blocked = vec![false; self.knots().len()];
        let mut chosen = Vec::with_capacity(count);
        for (_, k) in costs {
            if chosen.len() == count {
                break;
            }
            if !blocked[k as usize] {
                let around = self.rings.neighbours(k as usize).iter();
                around.for_each(|&other| blocked[other as usize] = true);
                chosen.push(self.knots()[k as usize]);
            }
        }
        chosen
    }

    /// Returns the vertices most worth a knot: up to `count`, best first, one in a cell.
    pub(super) fn most_wanted(&self, count: usize) -> Vec<u32> {
        let mut residual = &self.target.data - &self.fitted;
        self.target.weigh_twice(&mut residual);
        let gradient = self.system.solve_free(residual);
        let seed = self.seed.wrapping_add(self.moves);
        let insertion = insertion_denominators(&self.system, self.target, seed);
        let mut best: Vec<(f64, u32)> = vec![(0.0, 0); self.knots().len()];
        for (vertex, &cell) in self.rings.cells().iter().enumerate() {
            let denominator = insertion[vertex];
            if denominator > 0.0 {
                let square: f64 = (0..gradient.ncols())
                    .map(|c| gradient[(vertex, c)].powi(2))
                    .sum();
                let gain = square / denominator;
                if gain > best[cell as usize].0 {
                    best[cell as usize] = (gain, vertex as u32);
                }
            }
        }
        best.retain(|candidate| candidate.0 > 0.0);
        best.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        best.into_iter()
            .take(count)
            .map(|(_, vertex)| vertex)
            .collect()
    }

    /// Returns the state without some knots and with others, fitted again.
    pub(super) fn moved(
        &self,
        removed: &[u32],
        inserted: &[u32],
        precision: Precision,
    ) -> Result<Self, FitError> {
        let mut knots: BTreeSet<u32> = self.knots().iter().copied().collect();
        removed.iter().for_each(|knot| {
            knots.remove(knot);
        });
        knots.extend(inserted);
        let system = KnotValues::factor(self.space, knots.into_iter().collect())?;
        let moves = self.moves + 1;
        let rings = Rings::along(&self.graph, system.knots());
        let gram = Gram::estimate(&system, self.target, &rings)?;
        let mut state = Self {
            space: self.space,
            target: self.target,
            graph: self.graph.clone(),
            seed: self.seed,
            moves,
            system,
            rings,
            gram,
            fitted: self.fitted.clone(),
            error: 0.0,
        };
        state.fit(precision);
        Ok(state)
    }

    /// Fits the knots, from the present spline on.
    fn fit(&mut self, precision: Precision) {
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
