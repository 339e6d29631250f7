//! The numerical factorisation `P A Pᵀ = L Lᵀ`, multifrontal.
//!
//! The front of a supernode collects its entries of the matrix and the updates of its children, in
//! the order of the children. Subtrees are factored side by side.
//!
//! # Reference
//! [Duff1983]; [Liu1990].

use std::sync::Arc;

use rayon::prelude::*;

use super::etree::ROOT;
use super::kernels::factor_front;
use super::{Symbolic, SymmetricMatrix};

/// Why a matrix cannot be factored.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FactorError {
    /// A pivot was zero, negative or not finite.
    #[error(
        "the matrix is not positive definite at row {row}; is a part of the mesh without any constraint, or a coordinate not finite?"
    )]
    NotPositiveDefinite {
        /// Row of the matrix whose pivot failed.
        row: usize,
    },
    /// The symbolic factorisation belongs to another pattern.
    #[error("the matrix has {entries} entries, but was analysed with another pattern")]
    PatternChanged {
        /// Entries of this matrix.
        entries: usize,
    },
}

/// A Cholesky factorisation of a principal submatrix of a [`SymmetricMatrix`].
#[derive(Clone, Debug)]
pub struct Cholesky {
    pub(super) symbolic: Arc<Symbolic>,
    pub(super) values: Vec<f64>,
    /// Columns, in elimination order, that are left out although they were analysed.
    pub(super) left_out: Vec<bool>,
    entry_count: usize,
}

impl Cholesky {
    /// Factors `matrix`, whose pattern `symbolic` has analysed, in about `symbolic.flops()`.
    ///
    /// # Errors
    /// A matrix that is not positive definite, or of another pattern.
    pub fn factor(
        symbolic: impl Into<Arc<Symbolic>>,
        matrix: &SymmetricMatrix,
    ) -> Result<Self, FactorError> {
        Self::factor_kept(symbolic, matrix, |_| true)
    }

    /// Factors the principal submatrix of the rows for which `keep` holds with the analysis of a
    /// larger one.
    ///
    /// This saves the analysis when few rows are left out. Where they are many, it is better to
    /// analyse the submatrix ([`Symbolic::analyze_kept`]), whose factor is smaller.
    ///
    /// # Errors
    /// A submatrix that is not positive definite, or a matrix of another pattern.
    pub fn factor_kept(
        symbolic: impl Into<Arc<Symbolic>>,
        matrix: &SymmetricMatrix,
        keep: impl Fn(usize) -> bool,
    ) -> Result<Self, FactorError> {
        let symbolic = symbolic.into();
        let mut factor = Self {
            values: vec![0.0; symbolic.value_count()],
            left_out: left_out(&symbolic, keep),
            symbolic,
            entry_count: matrix.entry_count(),
        };
        factor.fill_in(matrix)?;
        Ok(factor)
    }

    /// Factors another matrix of the same pattern, reusing all memory.
    ///
    /// # Errors
    /// A matrix that is not positive definite, or of another pattern; the factor is then unusable.
    pub fn refactor(&mut self, matrix: &SymmetricMatrix) -> Result<(), FactorError> {
        if matrix.entry_count() != self.entry_count {
            return Err(FactorError::PatternChanged {
                entries: matrix.entry_count(),
            });
        }
        self.values.fill(0.0);
        self.fill_in(matrix)
    }

    /// Factors another principal submatrix of the same pattern, reusing all memory.
    ///
    /// # Errors
    /// As [`Self::refactor`].
    pub fn refactor_kept(
        &mut self,
        matrix: &SymmetricMatrix,
        keep: impl Fn(usize) -> bool,
    ) -> Result<(), FactorError> {
        self.left_out = left_out(&self.symbolic, keep);
        self.refactor(matrix)
    }

    /// Factors a matrix into values that are all zero.
    fn fill_in(&mut self, matrix: &SymmetricMatrix) -> Result<(), FactorError> {
        let symbolic = &self.symbolic;
        let roots: Vec<u32> = (0..symbolic.supernode_count() as u32)
            .filter(|&node| symbolic.parent[node as usize] == ROOT)
            .collect();
        let task = Task {
            symbolic,
            matrix: matrix.values(),
            left_out: &self.left_out,
        };
        task.branches(&roots, &mut self.values)
            .map(drop)
            .map_err(|column| FactorError::NotPositiveDefinite {
                row: symbolic.order[column] as usize,
            })
    }

    /// Returns the symbolic factorisation, to be used again.
    #[must_use]
    pub fn shared_symbolic(&self) -> Arc<Symbolic> {
        Arc::clone(&self.symbolic)
    }

    /// Returns what the pattern alone decided.
    #[must_use]
    pub fn symbolic(&self) -> &Symbolic {
        &self.symbolic
    }
}

/// Returns, in elimination order, which rows are not kept.
fn left_out(symbolic: &Symbolic, keep: impl Fn(usize) -> bool) -> Vec<bool> {
    let order = symbolic.order.iter();
    order.map(|&row| !keep(row as usize)).collect()
}

/// The update of a supernode to its ancestors: lower triangle of an r × r matrix.
type Update = Vec<f64>;

#[derive(Clone, Copy)]
struct Task<'a> {
    symbolic: &'a Symbolic,
    matrix: &'a [f64],
    left_out: &'a [bool],
}

impl Task<'_> {
    /// Factors the subtrees under `roots`, whose panels fill `values`, and returns their updates.
    ///
    /// The error is the column of the first bad pivot, the lowest of all branches.
    fn branches(self, roots: &[u32], values: &mut [f64]) -> Result<Vec<Update>, usize> {
        let mut parts = Vec::with_capacity(roots.len());
        let mut rest = values;
        for &root in roots {
            let nodes = self.symbolic.descendants(root as usize);
            let length =
                self.symbolic.value_starts[nodes.end] - self.symbolic.value_starts[nodes.start];
            let (part, tail) = rest.split_at_mut(length);
            parts.push((root as usize, part));
            rest = tail;
        }
        let results: Vec<Result<Update, usize>> = parts
            .into_par_iter()
            .map(|(root, part)| {
                if self.symbolic.in_subtree[root] {
                    self.subtree(root, part)
                } else {
                    self.top(root, part)
                }
            })
            .collect();
        let first_bad = results
            .iter()
            .filter_map(|r| r.as_ref().err().copied())
            .min();
        first_bad.map_or_else(|| Ok(results.into_iter().flatten().collect()), Err)
    }

    /// Factors a supernode above the subtrees, after its children.
    fn top(self, node: usize, values: &mut [f64]) -> Result<Update, usize> {
        let children = &self.symbolic.children[node];
        let own = self.symbolic.value_starts[node + 1] - self.symbolic.value_starts[node];
        let (below, panel) = values.split_at_mut(values.len() - own);
        let updates = self.branches(children, below)?;
        self.front(
            node,
            panel,
            children.iter().map(|&c| c as usize).zip(updates),
        )
    }

    /// Factors all supernodes under `root`, children first.
    fn subtree(self, root: usize, values: &mut [f64]) -> Result<Update, usize> {
        let nodes = self.symbolic.descendants(root);
        let start = self.symbolic.value_starts[nodes.start];
        let mut pending: Vec<(usize, Update)> = Vec::new();
        for node in nodes {
            let range = self.symbolic.value_starts[node] - start
                ..self.symbolic.value_starts[node + 1] - start;
            let children = self.symbolic.children[node].len();
            let updates = pending.drain(pending.len() - children..);
            let update = self.front(node, &mut values[range], updates)?;
            pending.push((node, update));
        }
        Ok(pending.pop().map(|(_, update)| update).unwrap_or_default())
    }

    /// Assembles and factors one front, and returns its update.
    fn front(
        self,
        node: usize,
        panel: &mut [f64],
        updates: impl Iterator<Item = (usize, Update)>,
    ) -> Result<Update, usize> {
        let columns = self.symbolic.columns(node).len();
        let below = self.symbolic.rows(node).len();
        for entry in self.symbolic.entries(node) {
            panel[entry.target as usize] = self.matrix[entry.source as usize];
        }
        self.decouple(node, panel, columns);
        let mut update = vec![0.0; below * below];
        for (child, child_update) in updates {
            let places = self.symbolic.places(child);
            extend_add(panel, columns, &mut update, places, &child_update);
        }
        factor_front(panel, columns, &mut update)
            .map_err(|column| self.symbolic.columns(node).start + column)?;
        Ok(update)
    }

    /// Turns the rows and columns that are left out into those of the identity.
    ///
    /// Updates of children are zero there, because their rows were cleared in the same way.
    fn decouple(self, node: usize, panel: &mut [f64], columns: usize) {
        let height = panel.len() / columns;
        let own = self.symbolic.columns(node);
        let below = self.symbolic.rows(node).iter().map(|&row| row as usize);
        for (place, row) in own.chain(below).enumerate() {
            if !self.left_out[row] {
                continue;
            }
            panel
                .iter_mut()
                .skip(place)
                .step_by(height)
                .for_each(|value| *value = 0.0);
            if place < columns {
                panel[place * height..(place + 1) * height].fill(0.0);
                panel[place * height + place] = 1.0;
            }
        }
    }
}

/// Adds the update of a child to the panel and update of its parent.
fn extend_add(
    panel: &mut [f64],
    columns: usize,
    update: &mut [f64],
    places: &[u32],
    child: &[f64],
) {
    let height = panel.len() / columns;
    let below = height - columns;
    for (column, &place) in places.iter().enumerate() {
        let source = &child[column * places.len() + column..(column + 1) * places.len()];
        let place = place as usize;
        let (target, shift) = if place < columns {
            (&mut panel[place * height..(place + 1) * height], 0)
        } else {
            let at = place - columns;
            (&mut update[at * below..(at + 1) * below], columns)
        };
        for (value, &row) in source.iter().zip(&places[column..]) {
            target[row as usize - shift] += value;
        }
    }
}
