//! Solves with a factorisation: down the elimination tree and up again.
//!
//! A subtree works in a workspace of its own: its columns, then the rows of its root. What it adds
//! to those rows is handed to its parent, and added there in the order of the children.

use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Mat, MatMut, MatRef};
use rayon::prelude::*;

use super::Symbolic;
use super::cholesky::Cholesky;
use super::dense::{column, column_mut};
use super::etree::ROOT;
use super::kernels::{backward, forward};

/// Right-hand sides that one pass over the factor serves: what lies between is all in cache.
const SIDES_PER_PASS: usize = 16;

impl Cholesky {
    /// Solves for the rows that take part, in place, for all columns of `x`.
    ///
    /// `x` has one row for every row of the matrix; rows left out of the factorisation are neither
    /// read nor written. Many right-hand sides at once cost five times less each than one.
    ///
    /// # Panics
    /// If `x` has fewer rows than the matrix.
    pub fn solve_in_place(&self, mut x: MatMut<'_, f64>) {
        let sides = x.ncols();
        let order = &self.symbolic.order;
        let passes = sides.div_ceil(SIDES_PER_PASS);
        let solved: Vec<Mat<f64>> = (0..passes)
            .into_par_iter()
            .map(|pass| {
                let first = pass * SIDES_PER_PASS;
                let width = SIDES_PER_PASS.min(sides - first);
                let mut y = Mat::from_fn(order.len(), width, |k, side| {
                    if self.left_out[k] {
                        0.0
                    } else {
                        x[(order[k] as usize, first + side)]
                    }
                });
                self.solve_ordered(y.as_mut());
                y
            })
            .collect();
        for (pass, y) in solved.iter().enumerate() {
            for side in 0..y.ncols() {
                for (k, &row) in order.iter().enumerate().filter(|k| !self.left_out[k.0]) {
                    x[(row as usize, pass * SIDES_PER_PASS + side)] = y[(k, side)];
                }
            }
        }
    }

    fn solve_ordered(&self, mut y: MatMut<'_, f64>) {
        let symbolic = &self.symbolic;
        let roots: Vec<u32> = (0..symbolic.supernode_count() as u32)
            .filter(|&node| symbolic.parent[node as usize] == ROOT)
            .collect();
        let solver = Solver {
            symbolic,
            values: &self.values,
        };
        solver.forward_branches(&roots, y.rb_mut());
        let nothing: Mat<f64> = Mat::zeros(0, y.ncols());
        solver.backward_branches(&roots, y, nothing.as_ref());
    }
}

#[derive(Clone, Copy)]
struct Solver<'a> {
    symbolic: &'a Symbolic,
    values: &'a [f64],
}

impl<'a> Solver<'a> {
    fn panel(self, node: usize) -> &'a [f64] {
        &self.values[self.symbolic.value_starts[node]..self.symbolic.value_starts[node + 1]]
    }

    /// Splits `x`, the columns under all of `roots`, into those of each root.
    fn split<'x>(self, roots: &[u32], x: MatMut<'x, f64>) -> Vec<(usize, MatMut<'x, f64>)> {
        let mut parts = Vec::with_capacity(roots.len());
        let mut rest = x;
        for &root in roots {
            let length = self.symbolic.subtree_columns(root as usize).len();
            let (part, tail) = rest.split_at_row_mut(length);
            parts.push((root as usize, part));
            rest = tail;
        }
        parts
    }

    /// Returns, for each root, what is to be subtracted from its rows.
    fn forward_branches(self, roots: &[u32], x: MatMut<'_, f64>) -> Vec<Mat<f64>> {
        self.split(roots, x)
            .into_par_iter()
            .map(|(root, part)| {
                if self.symbolic.in_subtree[root] {
                    self.forward_subtree(root, part)
                } else {
                    self.forward_top(root, part)
                }
            })
            .collect()
    }

    fn forward_top(self, node: usize, x: MatMut<'_, f64>) -> Mat<f64> {
        let columns = self.symbolic.columns(node).len();
        let descendants = x.nrows() - columns;
        let (under, mut own) = x.split_at_row_mut(descendants);
        let children = &self.symbolic.children[node];
        let updates = self.forward_branches(children, under);
        let mut rows: Mat<f64> = Mat::zeros(self.symbolic.rows(node).len(), own.ncols());
        for (&child, update) in children.iter().zip(&updates) {
            for (at, &place) in self.symbolic.places(child as usize).iter().enumerate() {
                let place = place as usize;
                for side in 0..own.ncols() {
                    if place < columns {
                        own[(place, side)] -= update[(at, side)];
                    } else {
                        rows[(place - columns, side)] += update[(at, side)];
                    }
                }
            }
        }
        let mut below = Mat::zeros(rows.nrows(), own.ncols());
        forward(self.panel(node), own, below.as_mut());
        rows + below
    }

    fn forward_subtree(self, root: usize, mut x: MatMut<'_, f64>) -> Mat<f64> {
        let (inside, sides) = (x.nrows(), x.ncols());
        let outside = self.symbolic.rows(root).len();
        let mut work: Mat<f64> = Mat::zeros(inside + outside, sides);
        work.as_mut().subrows_mut(0, inside).copy_from(x.rb());
        let start = self.symbolic.subtree_columns(root).start;
        let mut below = Mat::zeros(self.tallest(root), sides);
        for node in self.symbolic.descendants(root) {
            let columns = self.symbolic.columns(node);
            let locals = self.symbolic.locals(node);
            let own = work
                .as_mut()
                .subrows_mut(columns.start - start, columns.len());
            let mut below = below.as_mut().subrows_mut(0, locals.len());
            forward(self.panel(node), own, below.rb_mut());
            for side in 0..sides {
                let target = column_mut(work.as_mut(), side);
                for (&local, value) in locals.iter().zip(column(below.rb(), side)) {
                    target[local as usize] -= value;
                }
            }
        }
        x.copy_from(work.as_ref().subrows(0, inside));
        Mat::from_fn(outside, sides, |row, side| -work[(inside + row, side)])
    }

    /// Solves upwards below `roots`; `ancestors` holds the solved front of their parent.
    fn backward_branches(self, roots: &[u32], x: MatMut<'_, f64>, ancestors: MatRef<'_, f64>) {
        self.split(roots, x)
            .into_par_iter()
            .for_each(|(root, part)| {
                let places = self.symbolic.places(root);
                let rows = Mat::from_fn(
                    if self.symbolic.parent[root] == ROOT {
                        0
                    } else {
                        places.len()
                    },
                    part.ncols(),
                    |at, side| ancestors[(places[at] as usize, side)],
                );
                if self.symbolic.in_subtree[root] {
                    self.backward_subtree(root, part, &rows);
                } else {
                    self.backward_top(root, part, &rows);
                }
            });
    }

    fn backward_top(self, node: usize, x: MatMut<'_, f64>, rows: &Mat<f64>) {
        let columns = self.symbolic.columns(node).len();
        let descendants = x.nrows() - columns;
        let (under, mut own) = x.split_at_row_mut(descendants);
        backward(self.panel(node), own.rb_mut(), rows.as_ref());
        let front = Mat::from_fn(columns + rows.nrows(), own.ncols(), |at, side| {
            if at < columns {
                own[(at, side)]
            } else {
                rows[(at - columns, side)]
            }
        });
        self.backward_branches(&self.symbolic.children[node], under, front.as_ref());
    }

    fn backward_subtree(self, root: usize, mut x: MatMut<'_, f64>, rows: &Mat<f64>) {
        let (inside, sides) = (x.nrows(), x.ncols());
        let mut work: Mat<f64> = Mat::zeros(inside + rows.nrows(), sides);
        work.as_mut().subrows_mut(0, inside).copy_from(x.rb());
        work.as_mut()
            .subrows_mut(inside, rows.nrows())
            .copy_from(rows);
        let start = self.symbolic.subtree_columns(root).start;
        let mut below = Mat::zeros(self.tallest(root), sides);
        for node in self.symbolic.descendants(root).rev() {
            let columns = self.symbolic.columns(node);
            let locals = self.symbolic.locals(node);
            let mut below = below.as_mut().subrows_mut(0, locals.len());
            for side in 0..sides {
                let source = column(work.as_ref(), side);
                let target = column_mut(below.rb_mut(), side);
                for (value, &local) in target.iter_mut().zip(locals) {
                    *value = source[local as usize];
                }
            }
            let own = work
                .as_mut()
                .subrows_mut(columns.start - start, columns.len());
            backward(self.panel(node), own, below.rb());
        }
        x.copy_from(work.as_ref().subrows(0, inside));
    }

    fn tallest(self, root: usize) -> usize {
        let nodes = self.symbolic.descendants(root);
        nodes
            .map(|node| self.symbolic.rows(node).len())
            .max()
            .unwrap_or(0)
    }
}
