//! An approximate inverse: that of the diagonal blocks of the matrix over cubes of the lattice.
//!
//! Inverses of products of B-splines die off within a few places, and smoothing is weak beside the
//! samples: what a cube of control points says of itself is nearly all there is to say. The blocks know
//! how samples lie, on faces or inside, where no product of three directions does.

use pulp::Arch;
use rayon::prelude::*;

use super::stencil::Stencil;

/// Most places of a cube in one direction.
const CORE: usize = 5;

/// Least pivot against its diagonal entry, so that rounding leaves every block positive definite.
const LEAST_PIVOT: f64 = 1e-12;

/// The inverse of the blocks of a matrix over cubes that cover the lattice without overlap.
#[derive(Clone, Debug)]
pub(crate) struct BlockInverse {
    /// The control points, block after block.
    places: Vec<u32>,
    /// Where each block begins among them, and where the last one ends.
    starts: Vec<u32>,
    /// Columns of the lower factor of each block from the diagonal down, which holds the inverse of
    /// the pivot.
    factors: Vec<Vec<f64>>,
}

impl BlockInverse {
    /// The inverse of the blocks of a symmetric positive definite matrix.
    ///
    /// Cost: a third of a million multiplications for each of the `(size / 5)³` blocks.
    pub(crate) fn build(matrix: &Stencil) -> Self {
        let size = matrix.size;
        let pieces = size.div_ceil(CORE);
        let range = |piece: usize| piece * size / pieces..(piece + 1) * size / pieces;
        let block = |at: usize| -> Vec<[usize; 3]> {
            let [x, y, z] = [at % pieces, at / pieces % pieces, at / pieces.pow(2)].map(range);
            let lines = z.flat_map(|k| y.clone().map(move |j| [j, k]));
            lines
                .flat_map(|[j, k]| x.clone().map(move |i| [i, j, k]))
                .collect()
        };
        let blocks: Vec<Vec<[usize; 3]>> = (0..pieces.pow(3)).map(block).collect();
        let mut starts = vec![0];
        for block in &blocks {
            starts.push(starts[starts.len() - 1] + block.len() as u32);
        }
        let index = |&[i, j, k]: &[usize; 3]| (i + size * (j + size * k)) as u32;
        Self {
            places: blocks.iter().flatten().map(index).collect(),
            starts,
            factors: blocks
                .par_iter()
                .map(|block| factor(matrix, block))
                .collect(),
        }
    }

    /// The control points of a block.
    fn block(&self, block: u32) -> &[u32] {
        let [from, to] = [block, block + 1].map(|at| self.starts[at as usize] as usize);
        &self.places[from..to]
    }

    /// The control points of some blocks, block after block.
    pub(crate) fn places(&self, blocks: &[u32]) -> impl Iterator<Item = u32> {
        blocks.iter().flat_map(|&block| self.block(block)).copied()
    }

    /// The blocks that have a marked control point.
    pub(crate) fn touching(&self, marked: &[bool]) -> Vec<u32> {
        let touches =
            |&block: &u32| (self.block(block).iter()).any(|&place| marked[place as usize]);
        self.all().into_iter().filter(touches).collect()
    }

    fn all(&self) -> Vec<u32> {
        (0..self.factors.len() as u32).collect()
    }

    /// Applies it to several columns, one lattice after another.
    pub(crate) fn apply(&self, x: &[f64]) -> Vec<f64> {
        let lattice = self.places.len();
        let columns = x.chunks_exact(lattice);
        let sorted: Vec<f64> = columns
            .flat_map(|column| self.places.iter().map(|&at| column[at as usize]))
            .collect();
        let solved = self.apply_within(&self.all(), &sorted);
        let mut out = vec![0.0; x.len()];
        let columns = out.chunks_exact_mut(lattice);
        for (column, values) in columns.zip(solved.chunks_exact(lattice)) {
            for (&at, &value) in self.places.iter().zip(values) {
                column[at as usize] = value;
            }
        }
        out
    }

    /// Applies it to several columns of the control points of some blocks, block after block.
    pub(crate) fn apply_within(&self, blocks: &[u32], x: &[f64]) -> Vec<f64> {
        let mut ranges = Vec::with_capacity(blocks.len());
        let mut length = 0;
        for &block in blocks {
            let start = length;
            length += self.block(block).len();
            ranges.push((block, start..length));
        }
        let solved: Vec<Vec<f64>> = ranges
            .par_iter()
            .map(|(block, range)| {
                let columns = x.chunks_exact(length);
                let mut values: Vec<f64> =
                    columns.flat_map(|c| &c[range.clone()]).copied().collect();
                let factor = &self.factors[*block as usize];
                Arch::new().dispatch(
                    #[inline(always)]
                    || {
                        for column in values.chunks_exact_mut(range.len()) {
                            solve(factor, column);
                        }
                    },
                );
                values
            })
            .collect();
        let mut out = vec![0.0; x.len()];
        for ((_, range), values) in ranges.iter().zip(&solved) {
            let columns = out.chunks_exact_mut(length);
            for (column, values) in columns.zip(values.chunks_exact(range.len())) {
                column[range.clone()].copy_from_slice(values);
            }
        }
        out
    }
}

/// Columns of the lower factor of the block of some places.
fn factor(matrix: &Stencil, places: &[[usize; 3]]) -> Vec<f64> {
    let columns = places.iter().enumerate();
    let mut factor: Vec<f64> = columns
        .flat_map(|(first, column)| {
            places[first..]
                .iter()
                .map(|row| matrix.entry(*row, *column))
        })
        .collect();
    Arch::new().dispatch(
        #[inline(always)]
        || cholesky(&mut factor, places.len()),
    );
    factor
}

/// Factors a symmetric matrix in place, whose columns from the diagonal down follow one another; the
/// inverses of the pivots take the place of the diagonal.
#[inline(always)]
fn cholesky(columns: &mut [f64], size: usize) {
    let mut least: Vec<f64> = Vec::with_capacity(size);
    let mut start = 0;
    for height in (1..=size).rev() {
        least.push(LEAST_PIVOT * columns[start]);
        start += height;
    }
    let mut rest = columns;
    for (height, least) in (1..=size).rev().zip(least) {
        let (column, mut later) = rest.split_at_mut(height);
        let inverse = 1.0 / column[0].max(least).sqrt();
        column[0] = inverse;
        column[1..].iter_mut().for_each(|entry| *entry *= inverse);
        for from in 1..height {
            let (target, next) = later.split_at_mut(height - from);
            subtract(column[from], &column[from..], target);
            later = next;
        }
        rest = &mut rest[height..];
    }
}

/// Solves with a lower factor and its transpose.
#[inline(always)]
fn solve(factor: &[f64], x: &mut [f64]) {
    let size = x.len();
    let mut start = 0;
    for i in 0..size {
        let column = &factor[start..start + size - i];
        let (now, below) = x[i..].split_at_mut(1);
        now[0] *= column[0];
        subtract(now[0], &column[1..], below);
        start += size - i;
    }
    for i in (0..size).rev() {
        start -= size - i;
        let column = &factor[start..start + size - i];
        let (now, below) = x[i..].split_at_mut(1);
        now[0] = (now[0] - dot(&column[1..], below)) * column[0];
    }
}

#[inline(always)]
fn subtract(factor: f64, from: &[f64], target: &mut [f64]) {
    for (value, other) in target.iter_mut().zip(from) {
        *value -= factor * other;
    }
}

/// Sums that a processor can form side by side.
const SUMS: usize = 8;

#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; SUMS];
    let (a, b) = (a.chunks_exact(SUMS), b.chunks_exact(SUMS));
    let rest = a.remainder().iter().zip(b.remainder());
    let tail: f64 = rest.map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    tail + sums.iter().sum::<f64>()
}
