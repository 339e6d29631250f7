//! Points as weighted sums of control points.

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Rows that are computed together.
const BLOCK: usize = 256;

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

    pub(super) fn from_rows(
        columns: usize,
        rows: impl IntoIterator<Item = Vec<(u32, f64)>>,
    ) -> Self {
        let mut stencils = Self {
            offsets: vec![0],
            indices: Vec::new(),
            weights: Vec::new(),
            columns,
        };
        for row in rows {
            for (index, weight) in row {
                stencils.indices.push(index);
                stencils.weights.push(weight);
            }
            stencils.offsets.push(stencils.indices.len() as u32);
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
        let blocks: Vec<Vec<Vec<(u32, f64)>>> = (0..self.len().div_ceil(BLOCK))
            .into_par_iter()
            .map(|block| {
                let mut sums = vec![0.0; inner.columns];
                let mut seen = vec![false; inner.columns];
                let rows = block * BLOCK..((block + 1) * BLOCK).min(self.len());
                rows.map(|row| self.product_row(row, inner, &mut sums, &mut seen))
                    .collect()
            })
            .collect();
        Self::from_rows(inner.columns, blocks.into_iter().flatten())
    }

    fn product_row(
        &self,
        row: usize,
        inner: &Self,
        sums: &mut [f64],
        seen: &mut [bool],
    ) -> Vec<(u32, f64)> {
        let mut touched = Vec::new();
        let (indices, weights) = self.row(row);
        for (&index, &weight) in indices.iter().zip(weights) {
            let (columns, values) = inner.row(index as usize);
            for (&column, &value) in columns.iter().zip(values) {
                if !std::mem::replace(&mut seen[column as usize], true) {
                    touched.push(column);
                }
                sums[column as usize] += weight * value;
            }
        }
        touched.sort_unstable();
        touched
            .into_iter()
            .map(|column| {
                seen[column as usize] = false;
                (column, std::mem::take(&mut sums[column as usize]))
            })
            .collect()
    }
}
