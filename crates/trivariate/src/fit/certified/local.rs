//! The energy as a function of the control points around what is still wrong, all others at rest.

use rayon::prelude::*;

use super::descent::Descent;
use super::energy::Energy;
use super::hinges::{Hinges, Parts};
use crate::fit::least_squares::System;

/// Share of the control points up to which they are moved alone, in the first round and later: that
/// costs more the more they are, but goes on longer.
const MOST: [f64; 2] = [0.3, 0.6];

/// Rows that one task multiplies.
const BATCH: usize = 256;

/// The energy less that of the start, over some control points.
pub(super) struct Local<'a> {
    system: &'a System,
    scale: f64,
    pub(super) hinges: &'a mut Hinges,
    /// All control points at the start.
    start: Vec<f64>,
    /// Blocks of the approximate inverse that are free.
    blocks: Vec<u32>,
    /// Their control points, block after block.
    free: Vec<u32>,
    /// Gradient of half the squares at the start.
    slope: Vec<f64>,
    /// Rows of the matrix within the free control points.
    rows: Vec<Vec<(u32, f64)>>,
}

impl<'a> Local<'a> {
    /// The energy around some parts, or the start if they are too many. The surroundings are `wider` by
    /// that many times what a span or cell depends on.
    pub(super) fn around(
        parts: &Parts,
        (round, wider): (u32, u32),
        energy: &'a mut Energy<'_>,
        start: Vec<f64>,
    ) -> Result<Self, Vec<f64>> {
        let system = energy.system;
        let mut marked = energy.hinges.marked(parts);
        for _ in 0..wider {
            marked = energy.hinges.marked(&energy.hinges.touching(&marked));
        }
        let blocks = system.inverse.touching(&marked);
        let free: Vec<u32> = system.inverse.places(&blocks).collect();
        if free.len() as f64 > MOST[usize::from(round > 1)] * marked.len() as f64 {
            return Err(start);
        }
        let equations = &system.equations;
        let rows = equations.matrix.within(&free);
        let product = equations.matrix.apply(&start);
        let lattice = marked.len();
        let slope = (0..3).flat_map(|d| free.iter().map(move |&at| d * lattice + at as usize));
        let slope = slope.map(|at| product[at] - equations.right[at]).collect();
        Ok(Self {
            system,
            scale: energy.scale,
            hinges: &mut energy.hinges,
            start,
            blocks,
            free,
            slope,
            rows,
        })
    }

    /// The spans and cells that depend on a free control point.
    pub(super) fn parts(&self) -> Parts {
        let mut free = vec![false; self.start.len() / 3];
        for &at in &self.free {
            free[at as usize] = true;
        }
        self.hinges.touching(&free)
    }

    /// The free control points at the start: one list for each coordinate.
    pub(super) fn values(&self) -> Vec<f64> {
        self.indices().map(|at| self.start[at]).collect()
    }

    /// All control points, from the free ones.
    pub(super) fn whole(&self, values: &[f64]) -> Vec<f64> {
        let mut x = self.start.clone();
        for (at, &value) in self.indices().zip(values) {
            x[at] = value;
        }
        x
    }

    fn indices(&self) -> impl Iterator<Item = usize> {
        let lattice = self.start.len() / 3;
        (0..3).flat_map(move |d| self.free.iter().map(move |&at| d * lattice + at as usize))
    }
}

impl Descent for Local<'_> {
    fn evaluate(&self, values: &[f64]) -> (f64, Vec<f64>) {
        let x = self.whole(values);
        let moved: Vec<f64> = self.indices().map(|at| x[at] - self.start[at]).collect();
        let mut whole = vec![0.0; x.len()];
        let mut value = self.hinges.add(&x, &mut whole);
        let mut gradient: Vec<f64> = self.indices().map(|at| whole[at]).collect();
        let count = self.free.len();
        let product = |at: usize| {
            let moved = &moved[at / count * count..];
            let row = self.rows[at % count].iter();
            row.map(|&(at, entry)| entry * moved[at as usize]).sum()
        };
        let all = (0..moved.len()).into_par_iter().with_min_len(BATCH);
        let products: Vec<f64> = all.map(product).collect();
        for (at, product) in products.into_iter().enumerate() {
            let slope = self.slope[at];
            value += moved[at] * (product + 2.0 * slope) / self.scale;
            gradient[at] += 2.0 * (product + slope) / self.scale;
        }
        (value, gradient)
    }

    fn precondition(&self, gradient: &[f64]) -> Vec<f64> {
        let mut step = self.system.inverse.apply_within(&self.blocks, gradient);
        step.iter_mut().for_each(|s| *s *= 0.5 * self.scale);
        step
    }
}
