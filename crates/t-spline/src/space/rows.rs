//! Values of all functions at many points.

use msplines_common::evaluate::Order;
use rayon::prelude::*;

use super::TSplineSpace;
use crate::caps::{CapPoint, Jet, monomials};
use crate::complex::{Point, UNITS};

/// Points of one block, the unit of parallel work.
const BLOCK: usize = 512;
/// The least sum of functions by which one divides; its third power is still a number. Functions keep
/// their relative accuracy where they vanish, so that quotients of small ones are as good as of others.
const LEAST_SUM: f64 = 1e-80;

/// The rows of a batch of points: sparse, in blocks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows {
    points: usize,
    blocks: Vec<Block>,
}

#[derive(Clone, Debug, Default, PartialEq)]
struct Block {
    starts: Vec<u32>,
    unknowns: Vec<u32>,
    values: Vec<f64>,
    first: Vec<[f64; 2]>,
    second: Vec<[f64; 3]>,
}

/// One row: what every unknown with influence on a point contributes there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<'a> {
    /// The unknowns, ascending; one may occur several times where its function meets itself, and its
    /// contributions add up.
    pub unknowns: &'a [u32],
    /// Values of their functions.
    pub values: &'a [f64],
    /// Derivatives by `x` and `y`, in units of the form's 1; empty if not asked for.
    pub first: &'a [[f64; 2]],
    /// Derivatives by `xx`, `xy`, `yy`; empty if not asked for.
    pub second: &'a [[f64; 3]],
}

impl Rows {
    /// Returns the number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.points
    }

    /// Returns whether there are no points.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.points == 0
    }

    /// Returns the row of a point.
    ///
    /// # Panics
    /// If there is no such point.
    #[must_use]
    #[inline]
    pub fn row(&self, point: usize) -> Row<'_> {
        let block = &self.blocks[point / BLOCK];
        let place = point % BLOCK;
        let range = block.starts[place] as usize..block.starts[place + 1] as usize;
        Row {
            unknowns: &block.unknowns[range.clone()],
            values: &block.values[range.clone()],
            first: block.first.get(range.clone()).unwrap_or(&[]),
            second: block.second.get(range).unwrap_or(&[]),
        }
    }
}

impl TSplineSpace {
    /// Returns the rows of points.
    ///
    /// Cost: about as many values as there are functions at a point, 18, in parallel over blocks; the
    /// same bits on any number of threads.
    ///
    /// # Panics
    /// If a point names a cylinder that is not there.
    #[must_use]
    pub fn rows(&self, points: &[Point], order: Order) -> Rows {
        let mut rows = Rows::default();
        self.rows_into(points, order, &mut rows);
        rows
    }

    /// As [`TSplineSpace::rows`], in memory that is there already.
    ///
    /// # Panics
    /// If a point names a cylinder that is not there.
    pub fn rows_into(&self, points: &[Point], order: Order, rows: &mut Rows) {
        rows.points = points.len();
        let blocks = points.len().div_ceil(BLOCK);
        rows.blocks.resize_with(blocks, Block::default);
        let work = points.par_chunks(BLOCK).zip(&mut rows.blocks);
        work.for_each(|(points, block)| self.fill(points, order, block));
    }

    /// Returns the second derivatives of the T-spline alone, as if there were no caps.
    pub(crate) fn rows_without_caps(&self, points: &[Point]) -> Rows {
        let blocks = points.par_chunks(BLOCK).map(|points| {
            let mut block = Block::default();
            block.clear();
            for &point in points {
                self.add_quotients::<2>(point, Jet::ONE, &mut block);
                block.starts.push(block.unknowns.len() as u32);
            }
            block
        });
        Rows {
            points: points.len(),
            blocks: blocks.collect(),
        }
    }

    fn fill(&self, points: &[Point], order: Order, block: &mut Block) {
        block.clear();
        for &point in points {
            match order {
                Order::Value => self.add_row::<0>(point, block),
                Order::First => self.add_row::<1>(point, block),
                Order::Second => self.add_row::<2>(point, block),
            }
            block.starts.push(block.unknowns.len() as u32);
        }
    }

    fn add_row<const ORDER: usize>(&self, point: Point, block: &mut Block) {
        let cap = self.caps.at(point);
        let rest = cap.map_or(Jet::ONE, |cap| cap.rest);
        if rest.0[0] > 0.0 {
            self.add_quotients::<ORDER>(point, rest, block);
        }
        if let Some(cap) = cap {
            self.add_cap::<ORDER>(&cap, block);
        }
    }

    /// Adds the blending functions over their sum, times a weight.
    #[inline]
    fn add_quotients<const ORDER: usize>(&self, point: Point, weight: Jet, block: &mut Block) {
        let from = block.unknowns.len();
        let sum = self.add_functions::<ORDER>(point, block);
        block.make_rational::<ORDER>(from, sum, weight);
    }

    /// Adds the blending functions themselves, and returns their sum.
    #[inline]
    fn add_functions<const ORDER: usize>(&self, point: Point, block: &mut Block) -> Jet {
        let mut sum = [0.0; 6];
        let height = self.mesh.complex().cylinders()[point.cylinder as usize].height;
        let y = point.y.clamp(0.0, height as f64);
        let point = Point { y, ..point };
        for entry in self.entries(self.mesh.leaf_of(point)) {
            let inside = entry.x[0] < point.x
                && point.x < entry.x[1]
                && entry.y[0] <= point.y
                && point.y <= entry.y[1];
            if !inside {
                continue;
            }
            let [along_x, along_y] = &self.blends[entry.function as usize];
            let f = along_x.evaluate::<ORDER>((point.x - entry.origin[0]) / UNITS);
            let g = along_y.evaluate::<ORDER>((point.y - entry.origin[1]) / UNITS);
            block.unknowns.push(entry.function);
            block.values.push(f[0] * g[0]);
            sum[0] += f[0] * g[0];
            if ORDER > 0 {
                let first = [f[1] * g[0], f[0] * g[1]];
                block.first.push(first);
                sum[1] += first[0];
                sum[2] += first[1];
            }
            if ORDER > 1 {
                let second = [f[2] * g[0], f[1] * g[1], f[0] * g[2]];
                block.second.push(second);
                for k in 0..3 {
                    sum[3 + k] += second[k];
                }
            }
        }
        Jet(sum)
    }

    fn add_cap<const ORDER: usize>(&self, cap: &CapPoint, block: &mut Block) {
        let own = &self.caps.caps()[cap.cap as usize];
        let offset = self.functions.len() as u32 + own.offset;
        monomials(own.degree, cap.w, cap.dw, |place, monomial| {
            let Jet(v) = cap.phi.times(monomial);
            block.unknowns.push(offset + place as u32);
            block.values.push(v[0]);
            if ORDER > 0 {
                block.first.push([v[1], v[2]]);
            }
            if ORDER > 1 {
                block.second.push([v[3], v[4], v[5]]);
            }
        });
    }

    /// Returns the sums of the blending functions at points, in parallel: outside of the cores of caps
    /// they must be positive, and a spline is the smoother the further they are from zero.
    ///
    /// # Panics
    /// If a point names a cylinder that is not there.
    #[must_use]
    pub fn sums(&self, points: &[Point]) -> Vec<f64> {
        let blocks = points.par_chunks(BLOCK).flat_map_iter(|points| {
            let mut block = Block::default();
            let sums = points.iter().map(move |&point| {
                block.clear();
                self.add_functions::<0>(point, &mut block).0[0]
            });
            sums.collect::<Vec<f64>>()
        });
        blocks.collect()
    }
}

impl Block {
    fn clear(&mut self) {
        self.starts.clear();
        self.starts.push(0);
        self.unknowns.clear();
        self.values.clear();
        self.first.clear();
        self.second.clear();
    }

    /// Divides the functions from a place on by their sum, and gives them what weight the cap leaves.
    #[inline]
    fn make_rational<const ORDER: usize>(&mut self, from: usize, sum: Jet, rest: Jet) {
        // What the cap leaves over S, as one function, by which all are multiplied.
        let s = sum.0[0].max(LEAST_SUM);
        let inverse = 1.0 / s;
        let square = inverse * inverse;
        let factor = sum.through([inverse, -square, 2.0 * square * inverse]);
        let Jet(c) = factor.times(rest);
        for i in from..self.values.len() {
            let v = self.values[i];
            self.values[i] = c[0] * v;
            if ORDER > 0 {
                let [x, y] = self.first[i];
                self.first[i] = [c[0] * x + c[1] * v, c[0] * y + c[2] * v];
                if ORDER > 1 {
                    let [xx, xy, yy] = self.second[i];
                    self.second[i] = [
                        c[0] * xx + 2.0 * c[1] * x + c[3] * v,
                        c[0] * xy + c[1] * y + c[2] * x + c[4] * v,
                        c[0] * yy + 2.0 * c[2] * y + c[5] * v,
                    ];
                }
            }
        }
    }
}
