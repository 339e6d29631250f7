//! A sparse matrix in compressed columns.

use msplines_common::linalg::{Mat, MatRef};

/// A sparse matrix, column after column, rows ascending in each.
#[derive(Clone, Debug, PartialEq)]
pub struct SparseColumns {
    height: usize,
    starts: Vec<usize>,
    rows: Vec<u32>,
    values: Vec<f64>,
}

impl SparseColumns {
    /// Returns the matrix whose columns hold these rows and values.
    pub(super) fn of_columns(
        height: usize,
        columns: impl IntoIterator<Item = (Vec<u32>, Vec<f64>)>,
    ) -> Self {
        let mut matrix = Self {
            height,
            starts: vec![0],
            rows: Vec::new(),
            values: Vec::new(),
        };
        for (rows, values) in columns {
            matrix.rows.extend(rows);
            matrix.values.extend(values);
            matrix.starts.push(matrix.rows.len());
        }
        matrix
    }

    /// Returns the number of rows and of columns.
    #[must_use]
    pub fn shape(&self) -> (usize, usize) {
        (self.height, self.starts.len() - 1)
    }

    /// Returns the number of stored entries.
    #[must_use]
    pub fn entry_count(&self) -> usize {
        self.rows.len()
    }

    /// Returns the rows and the values of a column.
    ///
    /// # Panics
    /// If there is no such column.
    #[must_use]
    pub fn column(&self, column: usize) -> (&[u32], &[f64]) {
        let range = self.starts[column]..self.starts[column + 1];
        (&self.rows[range.clone()], &self.values[range])
    }

    /// Returns this matrix times `x`, which has one row per column.
    ///
    /// # Panics
    /// If the shapes do not agree.
    #[must_use]
    pub fn multiply(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        assert_eq!(x.nrows(), self.shape().1, "one row per column");
        let mut out = Mat::zeros(self.height, x.ncols());
        for column in 0..self.shape().1 {
            let (rows, values) = self.column(column);
            for side in 0..x.ncols() {
                let factor = x[(column, side)];
                for (&row, value) in rows.iter().zip(values) {
                    out[(row as usize, side)] += value * factor;
                }
            }
        }
        out
    }

    /// Returns the transpose of this matrix times `y`, which has one row per row.
    ///
    /// # Panics
    /// If the shapes do not agree.
    #[must_use]
    pub fn multiply_transposed(&self, y: MatRef<'_, f64>) -> Mat<f64> {
        assert_eq!(y.nrows(), self.height, "one row per row");
        Mat::from_fn(self.shape().1, y.ncols(), |column, side| {
            let (rows, values) = self.column(column);
            let terms = rows.iter().zip(values);
            terms
                .map(|(&row, value)| value * y[(row as usize, side)])
                .sum()
        })
    }

    /// Returns some columns as a dense matrix.
    pub(super) fn dense(&self, columns: std::ops::Range<usize>) -> Mat<f64> {
        let mut out = Mat::zeros(self.height, columns.len());
        for (side, column) in columns.enumerate() {
            let (rows, values) = self.column(column);
            for (&row, &value) in rows.iter().zip(values) {
                out[(row as usize, side)] = value;
            }
        }
        out
    }

    /// Divides each row by its sum.
    pub(super) fn normalise_rows(&mut self) {
        let mut sums = vec![0.0; self.height];
        let entries = || self.rows.iter().zip(&self.values);
        entries().for_each(|(&row, value)| sums[row as usize] += value);
        for (&row, value) in self.rows.iter().zip(&mut self.values) {
            *value /= sums[row as usize];
        }
    }
}
