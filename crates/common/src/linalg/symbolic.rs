//! The symbolic factorisation: everything that the pattern alone decides.
//!
//! Supernodes are runs of columns with (nearly) the same rows below them. They form a tree. Its
//! lower part is cut into *subtrees* of bounded work, each handled by one task; above them are the
//! *top* supernodes.
//!
//! # Notation
//! Columns are numbered in elimination order (a postorder of the elimination tree), so that the
//! columns, supernodes and values of any subtree are contiguous. A supernode with `c` columns and
//! `r` rows below them has a panel of `(c + r) × c` values, column-major.

use std::ops::Range;

use super::etree::{Pattern, ROOT, column_counts, parents, postorder};
use super::{Ordering, SymmetricMatrix};

/// Subtrees hold at most this fraction of all floating-point work: small enough to balance a dozen
/// threads, large enough that the top of the tree stays small.
const SUBTREE_FRACTION: f64 = 1.0 / 32.0;

/// Share of explicit zeros accepted when supernodes of up to so many columns are merged.
const RELAXATION: [(usize, f64); 4] = [(4, 0.5), (16, 0.2), (48, 0.08), (usize::MAX, 0.04)];

/// The symbolic Cholesky factorisation of a principal submatrix.
#[derive(Clone, Debug)]
pub struct Symbolic {
    /// Row of the matrix that is eliminated as number `k`.
    pub(super) order: Vec<u32>,
    /// First column of each supernode, and the number of columns as last entry.
    pub(super) first_columns: Vec<u32>,
    /// Start of each supernode in `rows`.
    row_starts: Vec<usize>,
    /// Rows below the columns of each supernode, ascending.
    rows: Vec<u32>,
    /// The same rows as places in the front (columns, then rows) of the parent.
    places: Vec<u32>,
    /// The same rows as places in the workspace of the subtree, for supernodes of subtrees.
    locals: Vec<u32>,
    /// Start of each panel in the values.
    pub(super) value_starts: Vec<usize>,
    /// For each supernode the entries of the matrix that its panel takes.
    entry_starts: Vec<usize>,
    entries: Vec<Entry>,
    pub(super) parent: Vec<u32>,
    pub(super) first_descendant: Vec<u32>,
    /// Largest supernode of each subtree, ascending.
    pub(super) subtrees: Vec<u32>,
    /// Whether a supernode belongs to a subtree.
    pub(super) in_subtree: Vec<bool>,
    pub(super) children: Vec<Vec<u32>>,
    flops: f64,
}

/// Value `source` of the matrix belongs to place `target` of a panel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) source: u32,
    pub(super) target: u32,
}

impl Symbolic {
    /// Analyses the whole `matrix` in the given order.
    ///
    /// # Panics
    /// If `ordering` is not of the matrix' size.
    #[must_use]
    pub fn analyze(matrix: &SymmetricMatrix, ordering: &Ordering) -> Self {
        Self::analyze_kept(matrix, ordering, |_| true)
    }

    /// Analyses the principal submatrix of the rows for which `keep` holds.
    ///
    /// # Panics
    /// If `ordering` is not of the matrix' size.
    #[must_use]
    pub fn analyze_kept(
        matrix: &SymmetricMatrix,
        ordering: &Ordering,
        keep: impl Fn(usize) -> bool,
    ) -> Self {
        assert_eq!(
            ordering.as_slice().len(),
            matrix.size(),
            "an ordering of this matrix"
        );
        let kept: Vec<u32> = ordering
            .as_slice()
            .iter()
            .copied()
            .filter(|&row| keep(row as usize))
            .collect();
        let tree = parents(&permuted_pattern(matrix, &kept));
        let order: Vec<u32> = postorder(&tree)
            .into_iter()
            .map(|k| kept[k as usize])
            .collect();
        let pattern = permuted_pattern(matrix, &order);
        let tree = parents(&pattern);
        let counts = column_counts(&pattern, &tree);
        let first_columns = supernodes(&tree, &counts);
        let mut symbolic = Self::structure(&pattern, order, first_columns);
        symbolic.find_subtrees();
        symbolic.map_entries(matrix);
        symbolic
    }

    /// Returns the number of rows that take part.
    #[must_use]
    pub fn size(&self) -> usize {
        self.order.len()
    }

    /// Returns the number of values of the factor, explicit zeros of merged supernodes included.
    #[must_use]
    pub fn value_count(&self) -> usize {
        self.value_starts[self.supernode_count()]
    }

    /// Returns the number of floating-point operations of a numerical factorisation.
    #[must_use]
    pub fn flops(&self) -> f64 {
        self.flops
    }

    pub(super) fn supernode_count(&self) -> usize {
        self.first_columns.len() - 1
    }

    pub(super) fn columns(&self, supernode: usize) -> Range<usize> {
        self.first_columns[supernode] as usize..self.first_columns[supernode + 1] as usize
    }

    pub(super) fn rows(&self, supernode: usize) -> &[u32] {
        &self.rows[self.row_starts[supernode]..self.row_starts[supernode + 1]]
    }

    pub(super) fn places(&self, supernode: usize) -> &[u32] {
        &self.places[self.row_starts[supernode]..self.row_starts[supernode + 1]]
    }

    pub(super) fn locals(&self, supernode: usize) -> &[u32] {
        &self.locals[self.row_starts[supernode]..self.row_starts[supernode + 1]]
    }

    pub(super) fn entries(&self, supernode: usize) -> &[Entry] {
        &self.entries[self.entry_starts[supernode]..self.entry_starts[supernode + 1]]
    }

    /// Returns the supernodes of the subtree under `root`.
    pub(super) fn descendants(&self, root: usize) -> Range<usize> {
        self.first_descendant[root] as usize..root + 1
    }

    /// Returns the columns of the subtree under `root`.
    pub(super) fn subtree_columns(&self, root: usize) -> Range<usize> {
        let first = self.first_descendant[root] as usize;
        self.first_columns[first] as usize..self.first_columns[root + 1] as usize
    }

    fn structure(pattern: &Pattern, order: Vec<u32>, first_columns: Vec<u32>) -> Self {
        let count = first_columns.len() - 1;
        let mut node_of = vec![0u32; pattern.size()];
        for node in 0..count {
            node_of[first_columns[node] as usize..first_columns[node + 1] as usize]
                .fill(node as u32);
        }
        let mut parent = vec![ROOT; count];
        let mut children: Vec<Vec<u32>> = vec![Vec::new(); count];
        let (mut row_starts, mut rows): (Vec<usize>, Vec<u32>) = (vec![0], Vec::new());
        let mut mark = vec![ROOT; pattern.size()];
        for node in 0..count {
            let (first, end) = (first_columns[node], first_columns[node + 1]);
            let mut add = |row: u32, rows: &mut Vec<u32>| {
                if row >= end && mark[row as usize] != node as u32 {
                    mark[row as usize] = node as u32;
                    rows.push(row);
                }
            };
            for column in first..end {
                pattern
                    .column(column as usize)
                    .iter()
                    .for_each(|&row| add(row, &mut rows));
            }
            for &child in &children[node] {
                for at in row_starts[child as usize]..row_starts[child as usize + 1] {
                    add(rows[at], &mut rows);
                }
            }
            rows[row_starts[node]..].sort_unstable();
            if let Some(&row) = rows.get(row_starts[node]) {
                parent[node] = node_of[row as usize];
                children[parent[node] as usize].push(node as u32);
            }
            row_starts.push(rows.len());
        }
        Self::number(order, first_columns, row_starts, rows, parent, children)
    }

    fn number(
        order: Vec<u32>,
        first_columns: Vec<u32>,
        row_starts: Vec<usize>,
        rows: Vec<u32>,
        parent: Vec<u32>,
        children: Vec<Vec<u32>>,
    ) -> Self {
        let count = parent.len();
        let mut first_descendant: Vec<u32> = (0..count as u32).collect();
        let (mut value_starts, mut places) = (vec![0usize], Vec::with_capacity(rows.len()));
        let mut flops = 0.0;
        for node in 0..count {
            let columns = (first_columns[node + 1] - first_columns[node]) as usize;
            let height = columns + row_starts[node + 1] - row_starts[node];
            value_starts.push(value_starts[node] + columns * height);
            flops += (0..columns)
                .map(|c| ((height - c) as f64).powi(2))
                .sum::<f64>();
            if parent[node] == ROOT {
                continue;
            }
            let above = parent[node] as usize;
            first_descendant[above] = first_descendant[above].min(first_descendant[node]);
            let (first, end) = (first_columns[above], first_columns[above + 1]);
            let mut at = row_starts[above];
            for &row in &rows[row_starts[node]..row_starts[node + 1]] {
                if row < end {
                    places.push(row - first);
                    continue;
                }
                while rows[at] != row {
                    at += 1;
                }
                places.push(end - first + (at - row_starts[above]) as u32);
            }
        }
        Self {
            locals: vec![0; rows.len()],
            in_subtree: vec![false; count],
            subtrees: Vec::new(),
            entry_starts: Vec::new(),
            entries: Vec::new(),
            order,
            first_columns,
            row_starts,
            rows,
            places,
            value_starts,
            parent,
            first_descendant,
            children,
            flops,
        }
    }

    /// Cuts the supernode tree into subtrees of bounded work and numbers their workspaces.
    fn find_subtrees(&mut self) {
        let count = self.supernode_count();
        let mut work = vec![0.0f64; count];
        for node in 0..count {
            let columns = self.columns(node).len();
            let height = columns + self.rows(node).len();
            work[node] += columns as f64 * (height as f64).powi(2);
            if self.parent[node] != ROOT {
                work[self.parent[node] as usize] += work[node];
            }
        }
        let total: f64 = (0..count)
            .filter(|&node| self.parent[node] == ROOT)
            .map(|node| work[node])
            .sum();
        let limit = total * SUBTREE_FRACTION;
        for root in 0..count {
            let above = self.parent[root];
            if work[root] > limit || (above != ROOT && work[above as usize] <= limit) {
                continue;
            }
            self.subtrees.push(root as u32);
            let columns = self.subtree_columns(root);
            for node in self.descendants(root) {
                self.in_subtree[node] = true;
                let mut outside = 0;
                for at in self.row_starts[node]..self.row_starts[node + 1] {
                    let row = self.rows[at] as usize;
                    if row >= columns.end {
                        let root_rows =
                            &self.rows[self.row_starts[root]..self.row_starts[root + 1]];
                        while root_rows[outside] as usize != row {
                            outside += 1;
                        }
                    }
                    let local = if row < columns.end {
                        row - columns.start
                    } else {
                        columns.len() + outside
                    };
                    self.locals[at] = local as u32;
                }
            }
        }
    }

    /// Finds the panel and place of every entry of the matrix.
    fn map_entries(&mut self, matrix: &SymmetricMatrix) {
        let mut number = vec![ROOT; matrix.size()];
        for (k, &row) in self.order.iter().enumerate() {
            number[row as usize] = k as u32;
        }
        let mut place = vec![0u32; self.size()];
        self.entry_starts = vec![0];
        for node in 0..self.supernode_count() {
            let columns = self.columns(node);
            let height = columns.len() + self.rows(node).len();
            for (offset, column) in columns.clone().enumerate() {
                place[column] = offset as u32;
            }
            for at in self.row_starts[node]..self.row_starts[node + 1] {
                place[self.rows[at] as usize] = (columns.len() + at - self.row_starts[node]) as u32;
            }
            for (offset, column) in columns.clone().enumerate() {
                let original = self.order[column] as usize;
                for source in matrix.starts()[original]..matrix.starts()[original + 1] {
                    let row = number[matrix.rows()[source] as usize];
                    if row != ROOT && row as usize >= column {
                        let target = offset as u32 * height as u32 + place[row as usize];
                        self.entries.push(Entry {
                            source: source as u32,
                            target,
                        });
                    }
                }
            }
            self.entry_starts.push(self.entries.len());
        }
    }
}

fn permuted_pattern(matrix: &SymmetricMatrix, order: &[u32]) -> Pattern {
    let mut number = vec![ROOT; matrix.size()];
    for (k, &row) in order.iter().enumerate() {
        number[row as usize] = k as u32;
    }
    let (mut starts, mut rows) = (Vec::with_capacity(order.len() + 1), Vec::new());
    starts.push(0);
    for &original in order {
        let range = matrix.starts()[original as usize]..matrix.starts()[original as usize + 1];
        rows.extend(
            matrix.rows()[range]
                .iter()
                .filter(|&&row| row != original)
                .map(|&row| number[row as usize])
                .filter(|&k| k != ROOT),
        );
        starts.push(rows.len());
    }
    Pattern { starts, rows }
}

/// Returns the first column of each supernode, and the number of columns as last entry.
///
/// A run of columns absorbs the run of its last child as long as few explicit zeros appear; where
/// the structures agree there are none.
fn supernodes(parent: &[u32], counts: &[u32]) -> Vec<u32> {
    /// First column, columns, rows below, true nonzeros.
    struct Run {
        first: usize,
        columns: usize,
        below: usize,
        nonzeros: usize,
    }
    let mut runs: Vec<Run> = Vec::new();
    for (column, &count) in counts.iter().enumerate() {
        let count = count as usize;
        let mut run = Run {
            first: column,
            columns: 1,
            below: count - 1,
            nonzeros: count,
        };
        while let Some(last) = runs.last() {
            let tail = last.first + last.columns - 1;
            let linked = parent[tail] != ROOT
                && (parent[tail] as usize) < run.first + run.columns
                && last.first + last.columns == run.first;
            if !linked {
                break;
            }
            let columns = last.columns + run.columns;
            let values = columns * (columns + 1) / 2 + columns * run.below;
            let nonzeros = last.nonzeros + run.nonzeros;
            let zeros = (values - nonzeros) as f64 / values as f64;
            let limit = RELAXATION
                .iter()
                .find(|r| columns <= r.0)
                .map_or(0.0, |r| r.1);
            if zeros > limit {
                break;
            }
            run = Run {
                first: last.first,
                columns,
                below: run.below,
                nonzeros,
            };
            runs.pop();
        }
        runs.push(run);
    }
    let mut first_columns: Vec<u32> = runs.iter().map(|run| run.first as u32).collect();
    first_columns.push(parent.len() as u32);
    first_columns
}
