//! Sweeps that keep the atoms of every chart: conjugate gradients over all charts at once.
//!
//! With the atoms kept, the error is a square of all coefficients together. Conjugate gradients on
//! its normal equations, preconditioned by the block of every chart, lower it faster than charts that
//! take turns do, and every step lowers it.
//!
//! # Notation
//! `A = [A_1 A_2 ..]` are the weighted atoms of all charts, `c` their coefficients; `g = Aᵀ r`,
//! `z = B⁻¹ g` with `B` the diagonal blocks of `Aᵀ A`, `p` the direction, `q = A p`.
//!
//! # Reference
//! [Wang2016] Eq. (5); [Hestenes1952].

use std::sync::Arc;

use rayon::prelude::*;

use super::charts::{COMPONENTS, Chart, Function};
use super::state::{Rooms, State, gather};

/// Factors of the blocks of some charts, and where the search stands.
#[derive(Clone, Debug)]
pub(crate) struct Frozen {
    /// The charts that change.
    charts: Vec<u32>,
    factors: Vec<[Arc<Factor>; COMPONENTS]>,
    /// `p`, chart after chart.
    directions: Vec<Vec<f64>>,
    /// `gᵀ z` for every coordinate; zero before the first step.
    products: [f64; COMPONENTS],
    /// Observations that the charts see.
    touched: Vec<u32>,
    /// `q` at every observation; zero at those that are not touched.
    image: Vec<[f64; COMPONENTS]>,
}

/// A lower triangle `L` with `L Lᵀ = G`, over some of the atoms of a chart.
#[derive(Debug, Default)]
struct Factor {
    /// Places in the support of the chart.
    places: Vec<u16>,
    lower: Vec<f64>,
}

impl Frozen {
    /// Factors the blocks of these charts, which alone will change.
    pub(crate) fn factor(state: &State, charts: Vec<u32>) -> Self {
        let chart = |&c: &u32| &state.charts[c as usize];
        let seen = charts.iter().flat_map(|c| &chart(c).observations);
        let mut touched: Vec<u32> = seen.copied().collect();
        touched.sort_unstable();
        touched.dedup();
        Self {
            factors: charts.par_iter().map(|c| factors(chart(c))).collect(),
            directions: charts
                .iter()
                .map(|c| vec![0.0; chart(c).function.coefficients.len()])
                .collect(),
            products: [0.0; COMPONENTS],
            touched,
            image: vec![[0.0; COMPONENTS]; state.residual.len()],
            charts,
        }
    }

    /// Takes a step.
    pub(crate) fn sweep(&mut self, state: &mut State) {
        let steps = self.preconditioned(state);
        let mut products = [0.0; COMPONENTS];
        for (_, product) in &steps {
            (0..COMPONENTS).for_each(|i| products[i] += product[i]);
        }
        let ratio = [0, 1, 2].map(|i| match self.products[i] {
            before if before > 0.0 => products[i] / before,
            _ => 0.0,
        });
        self.products = products;
        for (direction, (step, _)) in self.directions.iter_mut().zip(&steps) {
            for (i, (p, z)) in direction.iter_mut().zip(step).enumerate() {
                *p = z + ratio[i % COMPONENTS] * *p;
            }
        }
        self.renew_image(state);
        let mut squares = [0.0; COMPONENTS];
        for &o in &self.touched {
            let q = self.image[o as usize];
            (0..COMPONENTS).for_each(|i| squares[i] += q[i] * q[i]);
        }
        let lengths = [0, 1, 2].map(|i| match squares[i] {
            square if square > 0.0 => products[i] / square,
            _ => 0.0,
        });
        for &o in &self.touched {
            let q = self.image[o as usize];
            (0..COMPONENTS).for_each(|i| state.residual[o as usize][i] -= lengths[i] * q[i]);
        }
        for (&chart, direction) in self.charts.iter().zip(&self.directions) {
            let coefficients = &mut state.charts[chart as usize].function.coefficients;
            for (i, (c, p)) in coefficients.iter_mut().zip(direction).enumerate() {
                *c += lengths[i % COMPONENTS] * p;
            }
        }
    }

    /// Returns `z` and `gᵀ z` of every chart.
    fn preconditioned(&self, state: &State) -> Vec<(Vec<f64>, [f64; COMPONENTS])> {
        let of_chart =
            |rooms: &mut Rooms, (&chart, factors): (&u32, &[Arc<Factor>; COMPONENTS])| {
                let gradient = gradient(state, &state.charts[chart as usize], rooms);
                let mut step = gradient.clone();
                for (component, factor) in factors.iter().enumerate() {
                    factor.solve(component, &mut step);
                }
                let mut product = [0.0; COMPONENTS];
                for (i, (g, z)) in gradient.iter().zip(&step).enumerate() {
                    product[i % COMPONENTS] += g * z;
                }
                (step, product)
            };
        let charts = self.charts.par_iter().zip(&self.factors);
        charts
            .with_min_len(CHARTS_TOGETHER)
            .map_init(Rooms::default, of_chart)
            .collect()
    }

    fn renew_image(&mut self, state: &State) {
        let parts: Vec<Vec<f64>> = self
            .charts
            .par_iter()
            .zip(&self.directions)
            .with_min_len(CHARTS_TOGETHER)
            .map(|(&chart, direction)| {
                let chart = &state.charts[chart as usize];
                let mut part = vec![0.0; COMPONENTS * chart.observations.len()];
                let support = &chart.function.support;
                chart.design.accumulate(support, direction, &mut part);
                part
            })
            .collect();
        for &o in &self.touched {
            self.image[o as usize] = [0.0; COMPONENTS];
        }
        for (&chart, part) in self.charts.iter().zip(parts) {
            state.charts[chart as usize].scatter(&part, 1.0, &mut self.image);
        }
    }
}

/// Charts that one task takes: fewer cost more to hand out than to do.
const CHARTS_TOGETHER: usize = 6;

/// Returns `A_jᵀ r`, `[atom][coordinate]`.
fn gradient(state: &State, chart: &Chart, rooms: &mut Rooms) -> Vec<f64> {
    let (design, support) = (&chart.design, &chart.function.support);
    gather(
        &chart.observations,
        |o| state.residual[o as usize],
        &mut rooms.data,
    );
    design.gradient(support, &rooms.data)
}

/// Returns the factors of the coordinates of a chart, of those atoms that each has.
fn factors(chart: &Chart) -> [Arc<Factor>; COMPONENTS] {
    let Function {
        support,
        coefficients,
    } = &chart.function;
    let places = |component: usize| -> Vec<u16> {
        let used = |i: &u16| coefficients[COMPONENTS * usize::from(*i) + component] != 0.0;
        (0..support.len() as u16).filter(used).collect()
    };
    let first = Arc::new(Factor::of(chart, places(0)));
    // Coordinates that share their atoms share their factor.
    [0, 1, 2].map(|component| match places(component) {
        same if same == first.places => Arc::clone(&first),
        places => Arc::new(Factor::of(chart, places)),
    })
}

impl Factor {
    fn of(chart: &Chart, places: Vec<u16>) -> Self {
        let design = &chart.design;
        let atom = |place: u16| usize::from(chart.function.support[usize::from(place)]);
        let n = places.len();
        let mut lower = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..=i {
                let mut sum = design.gram[atom(places[i]) * design.atoms + atom(places[j])];
                for k in 0..j {
                    sum -= lower[i * n + k] * lower[j * n + k];
                }
                if i == j {
                    let whole = design.gram[atom(places[i]) * (design.atoms + 1)];
                    lower[i * n + i] = sum.max(crate::pursuit::DEPENDENT * whole).sqrt();
                } else {
                    lower[i * n + j] = sum / lower[j * n + j];
                }
            }
        }
        Self { places, lower }
    }

    /// Replaces a coordinate of a right-hand side by the solution; zero for atoms it does not have.
    fn solve(&self, component: usize, step: &mut [f64]) {
        let n = self.places.len();
        let slot = |place: u16| COMPONENTS * usize::from(place) + component;
        let mut x: Vec<f64> = self.places.iter().map(|&p| step[slot(p)]).collect();
        for i in 0..n {
            let sum: f64 = (0..i).map(|j| self.lower[i * n + j] * x[j]).sum();
            x[i] = (x[i] - sum) / self.lower[i * n + i];
        }
        for i in (0..n).rev() {
            let sum: f64 = (i + 1..n).map(|j| self.lower[j * n + i] * x[j]).sum();
            x[i] = (x[i] - sum) / self.lower[i * n + i];
        }
        step.iter_mut()
            .skip(component)
            .step_by(COMPONENTS)
            .for_each(|s| *s = 0.0);
        for (&place, x) in self.places.iter().zip(x) {
            step[slot(place)] = x;
        }
    }
}
