//! Points as weighted sums of control points.

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Rows that are computed together.
const BLOCK: usize = 1024;

/// Sparse rows: each is a point as a weighted sum of control points.
#[derive(Clone, Debug, PartialEq)]
pub struct Stencils {
    offsets: Vec<u32>,
    indices: Vec<u32>,
    weights: Vec<f64>,
    columns: usize,
}

impl Stencils {
    /// Returns the stencils that are the control points themselves.
    #[must_use]
    pub fn identity(columns: usize) -> Self {
        Self {
            offsets: (0..=columns as u32).collect(),
            indices: (0..columns as u32).collect(),
            weights: vec![1.0; columns],
            columns,
        }
    }

    /// Returns stencils of `count` rows, each of which `row` appends to an empty list: columns in any
    /// order, also repeated.
    pub(super) fn build(
        columns: usize,
        count: usize,
        row: impl Fn(usize, &mut Vec<(u32, f64)>) + Sync,
    ) -> Self {
        let block = |block: usize| {
            let mut flat = Flat::default();
            let mut scratch = Vec::new();
            for index in block * BLOCK..((block + 1) * BLOCK).min(count) {
                scratch.clear();
                row(index, &mut scratch);
                // A stable sort keeps the order of equal columns, and so the bits of their sum.
                scratch.sort_by_key(|entry| entry.0);
                flat.push_merged(&scratch);
            }
            flat
        };
        let blocks: Vec<Flat> = (0..count.div_ceil(BLOCK))
            .into_par_iter()
            .map(block)
            .collect();
        Self::joined(columns, &blocks)
    }

    fn joined(columns: usize, blocks: &[Flat]) -> Self {
        let size = blocks.iter().map(|block| block.indices.len()).sum();
        let mut stencils = Self {
            offsets: vec![0],
            indices: Vec::with_capacity(size),
            weights: Vec::with_capacity(size),
            columns,
        };
        for block in blocks {
            let start = stencils.indices.len() as u32;
            stencils
                .offsets
                .extend(block.ends.iter().map(|end| start + end));
            stencils.indices.extend_from_slice(&block.indices);
            stencils.weights.extend_from_slice(&block.weights);
        }
        stencils
    }

    /// Returns the number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Returns whether there is no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the number of control points.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Returns the control points of a point and their weights.
    #[must_use]
    pub fn row(&self, row: usize) -> (&[u32], &[f64]) {
        let range = self.offsets[row] as usize..self.offsets[row + 1] as usize;
        (&self.indices[range.clone()], &self.weights[range])
    }

    /// Returns one point.
    #[must_use]
    pub fn point(&self, row: usize, controls: &[Point3<f64>]) -> Point3<f64> {
        let (indices, weights) = self.row(row);
        let mut sum = Vector3::zeros();
        for (&index, &weight) in indices.iter().zip(weights) {
            sum += controls[index as usize].coords * weight;
        }
        Point3::from(sum)
    }

    /// Returns all points.
    ///
    /// # Panics
    /// If there are not as many controls as columns.
    #[must_use]
    pub fn apply(&self, controls: &[Point3<f64>]) -> Vec<Point3<f64>> {
        assert_eq!(controls.len(), self.columns, "one position per column");
        (0..self.len())
            .into_par_iter()
            .with_min_len(BLOCK)
            .map(|row| self.point(row, controls))
            .collect()
    }

    /// Returns the stencils of `self`, whose columns are the rows of `inner`, over the columns of
    /// `inner`.
    ///
    /// # Panics
    /// If the columns of `self` are not the rows of `inner`.
    #[must_use]
    pub fn after(&self, inner: &Self) -> Self {
        assert_eq!(
            self.columns,
            inner.len(),
            "columns of one, rows of the other"
        );
        let block = |block: usize| {
            let mut sums = vec![0.0; inner.columns];
            let mut seen = vec![false; inner.columns];
            let mut flat = Flat::default();
            for row in block * BLOCK..((block + 1) * BLOCK).min(self.len()) {
                self.product_row(row, inner, (&mut sums, &mut seen), &mut flat);
            }
            flat
        };
        let blocks: Vec<Flat> = (0..self.len().div_ceil(BLOCK))
            .into_par_iter()
            .map(block)
            .collect();
        Self::joined(inner.columns, &blocks)
    }

    fn product_row(
        &self,
        row: usize,
        inner: &Self,
        (sums, seen): (&mut [f64], &mut [bool]),
        out: &mut Flat,
    ) {
        let start = out.indices.len();
        let (indices, weights) = self.row(row);
        for (&index, &weight) in indices.iter().zip(weights) {
            let (columns, values) = inner.row(index as usize);
            for (&column, &value) in columns.iter().zip(values) {
                if !std::mem::replace(&mut seen[column as usize], true) {
                    out.indices.push(column);
                }
                sums[column as usize] += weight * value;
            }
        }
        out.indices[start..].sort_unstable();
        for &column in &out.indices[start..] {
            seen[column as usize] = false;
            out.weights.push(std::mem::take(&mut sums[column as usize]));
        }
        out.ends.push(out.indices.len() as u32);
    }
}

/// Rows of a block, one after another.
#[derive(Default)]
struct Flat {
    ends: Vec<u32>,
    indices: Vec<u32>,
    weights: Vec<f64>,
}

impl Flat {
    /// Appends a row of ascending columns, of which equal ones are summed.
    fn push_merged(&mut self, row: &[(u32, f64)]) {
        let start = self.indices.len();
        for &(index, weight) in row {
            if self.indices.len() > start && self.indices.last() == Some(&index) {
                if let Some(last) = self.weights.last_mut() {
                    *last += weight;
                }
            } else {
                self.indices.push(index);
                self.weights.push(weight);
            }
        }
        self.ends.push(self.indices.len() as u32);
    }
}
