//! A sparse symmetric matrix in compressed columns, both triangles stored.

use faer::reborrow::ReborrowMut;
use faer::{Mat, MatMut, MatRef};
use rayon::prelude::*;

use super::dense::{column, column_mut};

/// Rows whose products are computed by one task: a fixed number, so that results do not depend on
/// the number of threads.
const ROWS_PER_TASK: usize = 4096;

/// Columns that one pass over the matrix multiplies.
const SIDES: usize = 4;

/// A sparse symmetric matrix, both triangles stored, rows ascending in each column.
#[derive(Clone, Debug, PartialEq)]
pub struct SymmetricMatrix {
    starts: Vec<usize>,
    rows: Vec<u32>,
    values: Vec<f64>,
}

impl SymmetricMatrix {
    /// Builds the matrix whose lower and upper triangle are given by `entries(row, column, value)`;
    /// values of equal places are added in the order given.
    ///
    /// Only entries with `row >= column` are read, and mirrored.
    ///
    /// # Panics
    /// If an index is not below `size`.
    #[must_use]
    pub fn from_lower_triplets(size: usize, entries: &[(u32, u32, f64)]) -> Self {
        let mut starts = vec![0usize; size + 1];
        for &(row, column, _) in entries.iter().filter(|e| e.0 >= e.1) {
            starts[column as usize + 1] += 1;
            if row != column {
                starts[row as usize + 1] += 1;
            }
        }
        for column in 0..size {
            starts[column + 1] += starts[column];
        }
        let mut next = starts.clone();
        let mut items = vec![(0u32, 0.0f64); starts[size]];
        let mut put = |column: u32, row: u32, value: f64| {
            items[next[column as usize]] = (row, value);
            next[column as usize] += 1;
        };
        for &(row, column, value) in entries.iter().filter(|e| e.0 >= e.1) {
            put(column, row, value);
            if row != column {
                put(row, column, value);
            }
        }
        Self::from_unsorted_columns(&starts, &mut items)
    }

    fn from_unsorted_columns(starts: &[usize], items: &mut [(u32, f64)]) -> Self {
        let size = starts.len() - 1;
        let (mut rows, mut values) = (Vec::new(), Vec::new());
        let mut merged = vec![0usize; size + 1];
        for column in 0..size {
            let entries = &mut items[starts[column]..starts[column + 1]];
            entries.sort_by_key(|e| e.0); // stable: equal places are added in the order given
            for &(row, value) in entries.iter() {
                if rows.len() > merged[column] && rows.last() == Some(&row) {
                    *values.last_mut().expect("one value per row") += value;
                } else {
                    rows.push(row);
                    values.push(value);
                }
            }
            merged[column + 1] = rows.len();
        }
        Self {
            starts: merged,
            rows,
            values,
        }
    }

    /// Returns the number of rows.
    #[must_use]
    pub fn size(&self) -> usize {
        self.starts.len() - 1
    }

    /// Returns the number of stored entries, both triangles counted.
    #[must_use]
    pub fn entry_count(&self) -> usize {
        self.rows.len()
    }

    /// Returns the start of each column in [`Self::rows`] and [`Self::values`].
    #[must_use]
    pub fn starts(&self) -> &[usize] {
        &self.starts
    }

    /// Returns the row of each entry.
    #[must_use]
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// Returns the value of each entry.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Returns the value of each entry to be changed; both halves must be.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Returns where an entry is stored among [`Self::values`].
    ///
    /// # Panics
    /// If there is no such column.
    #[must_use]
    pub fn place(&self, row: u32, column: u32) -> Option<usize> {
        let range = self.starts[column as usize]..self.starts[column as usize + 1];
        let at = self.rows[range.clone()].binary_search(&row).ok()?;
        Some(range.start + at)
    }

    /// Returns the rows and values of one column, which are also those of the row.
    ///
    /// # Panics
    /// If there is no such column.
    pub fn column(&self, column: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.starts[column]..self.starts[column + 1];
        self.rows[range.clone()]
            .iter()
            .map(|&r| r as usize)
            .zip(self.values[range].iter().copied())
    }

    /// Returns the diagonal, with zeros where no entry is stored.
    #[must_use]
    pub fn diagonal(&self) -> Vec<f64> {
        (0..self.size())
            .map(|c| self.column(c).find(|e| e.0 == c).map_or(0.0, |e| e.1))
            .collect()
    }

    /// Returns the matrix with `shift[i]` added to diagonal entry `i`, which must be stored.
    ///
    /// # Panics
    /// If a shifted diagonal entry is not stored.
    #[must_use]
    pub fn plus_diagonal(&self, shift: &[f64]) -> Self {
        let mut result = self.clone();
        for (column, &value) in shift.iter().enumerate().filter(|e| *e.1 != 0.0) {
            let range = self.starts[column]..self.starts[column + 1];
            let at = self.rows[range.clone()].binary_search(&(column as u32));
            result.values[range.start + at.expect("a stored diagonal")] += value;
        }
        result
    }

    /// Adds `(row, column, value)` to stored entries; a symmetric change names both halves.
    ///
    /// # Panics
    /// If an entry is not stored.
    pub fn add_to_entries(&mut self, entries: &[(u32, u32, f64)]) {
        for &(row, column, value) in entries {
            let range = self.starts[column as usize]..self.starts[column as usize + 1];
            let at = self.rows[range.clone()].binary_search(&row);
            self.values[range.start + at.expect("a stored entry")] += value;
        }
    }

    /// Returns `S D S` of this matrix `S` and the diagonal `D`.
    ///
    /// # Panics
    /// If `diagonal` has not one entry per row.
    #[must_use]
    pub fn congruence(&self, diagonal: &[f64]) -> Self {
        assert_eq!(diagonal.len(), self.size(), "one diagonal entry per row");
        let tasks = self.size().div_ceil(ROWS_PER_TASK);
        let blocks: Vec<(Vec<usize>, Vec<u32>, Vec<f64>)> = (0..tasks)
            .into_par_iter()
            .map(|task| {
                let first = task * ROWS_PER_TASK;
                self.congruence_columns(diagonal, first..self.size().min(first + ROWS_PER_TASK))
            })
            .collect();
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for (lengths, block_rows, block_values) in blocks {
            for length in lengths {
                starts.push(starts[starts.len() - 1] + length);
            }
            rows.extend(block_rows);
            values.extend(block_values);
        }
        Self {
            starts,
            rows,
            values,
        }
    }

    fn congruence_columns(
        &self,
        diagonal: &[f64],
        columns: std::ops::Range<usize>,
    ) -> (Vec<usize>, Vec<u32>, Vec<f64>) {
        let mut sums = vec![0.0f64; self.size()];
        let mut seen = vec![false; self.size()];
        let mut found: Vec<u32> = Vec::new();
        let (mut lengths, mut rows, mut values) = (Vec::new(), Vec::new(), Vec::new());
        for column in columns {
            for (middle, right) in self.column(column) {
                let factor = diagonal[middle] * right;
                for (row, left) in self.column(middle) {
                    if !seen[row] {
                        seen[row] = true;
                        found.push(row as u32);
                    }
                    sums[row] += left * factor;
                }
            }
            found.sort_unstable();
            lengths.push(found.len());
            for row in found.drain(..) {
                rows.push(row);
                values.push(std::mem::take(&mut sums[row as usize]));
                seen[row as usize] = false;
            }
        }
        (lengths, rows, values)
    }

    /// Writes this matrix times `x` to `out`.
    ///
    /// # Panics
    /// If the shapes do not agree.
    pub fn multiply_into(&self, x: MatRef<'_, f64>, mut out: MatMut<'_, f64>) {
        assert_eq!(
            (x.nrows(), out.nrows()),
            (self.size(), self.size()),
            "one row per unknown"
        );
        assert_eq!(x.ncols(), out.ncols(), "as many columns out as in");
        for first in (0..x.ncols()).step_by(SIDES) {
            let width = SIDES.min(x.ncols() - first);
            let input = interleaved(x, first);
            let tasks = self.size().div_ceil(ROWS_PER_TASK);
            let blocks: Vec<Vec<[f64; SIDES]>> = (0..tasks)
                .into_par_iter()
                .map(|task| {
                    let rows = task * ROWS_PER_TASK..self.size().min((task + 1) * ROWS_PER_TASK);
                    rows.map(|row| self.row_products(row, &input)).collect()
                })
                .collect();
            for side in 0..width {
                let column = column_mut(out.rb_mut(), first + side);
                for (value, sums) in column.iter_mut().zip(blocks.iter().flatten()) {
                    *value = sums[side];
                }
            }
        }
    }

    /// Returns some rows of this matrix times `x`, in the order of `rows`.
    ///
    /// # Panics
    /// If `x` has not one row per unknown, or a row does not exist.
    #[must_use]
    pub fn multiply_rows(&self, rows: &[u32], x: MatRef<'_, f64>) -> Mat<f64> {
        let mut out = Mat::zeros(rows.len(), x.ncols());
        for first in (0..x.ncols()).step_by(SIDES) {
            let width = SIDES.min(x.ncols() - first);
            let input = interleaved(x, first);
            let sums: Vec<[f64; SIDES]> = rows
                .par_iter()
                .map(|&row| self.row_products(row as usize, &input))
                .collect();
            for side in 0..width {
                let column = column_mut(out.as_mut(), first + side);
                column
                    .iter_mut()
                    .zip(&sums)
                    .for_each(|(value, sums)| *value = sums[side]);
            }
        }
        out
    }

    /// Returns this matrix times the vectors that hold `values` (one row per entry of `columns`) and
    /// zeros elsewhere, in time proportional to the entries of these columns.
    ///
    /// # Panics
    /// If `values` has not one row per column, or a column does not exist.
    #[must_use]
    pub fn multiply_columns(&self, columns: &[u32], values: MatRef<'_, f64>) -> Mat<f64> {
        assert_eq!(
            columns.len(),
            values.nrows(),
            "one row of values per column"
        );
        let mut out = Mat::zeros(self.size(), values.ncols());
        for side in 0..values.ncols() {
            let target = column_mut(out.as_mut(), side);
            for (k, &column) in columns.iter().enumerate() {
                let factor = values[(k, side)];
                self.column(column as usize)
                    .for_each(|(row, entry)| target[row] += entry * factor);
            }
        }
        out
    }

    fn row_products(&self, row: usize, input: &[[f64; SIDES]]) -> [f64; SIDES] {
        let mut sums = [0.0; SIDES];
        for (other, entry) in self.column(row) {
            let values = &input[other];
            for side in 0..SIDES {
                sums[side] += entry * values[side];
            }
        }
        sums
    }

    /// Returns this matrix times `x`.
    ///
    /// # Panics
    /// If `x` has not one row per unknown.
    #[must_use]
    pub fn multiply(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        let mut out = Mat::zeros(self.size(), x.ncols());
        self.multiply_into(x, out.as_mut());
        out
    }
}

/// Returns some columns of `x` side by side, padded with zeros: one cache line serves them all.
fn interleaved(x: MatRef<'_, f64>, first: usize) -> Vec<[f64; SIDES]> {
    let mut rows = vec![[0.0; SIDES]; x.nrows()];
    for side in 0..SIDES.min(x.ncols() - first) {
        rows.iter_mut()
            .zip(column(x, first + side))
            .for_each(|(row, value)| row[side] = *value);
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path_laplacian(size: u32) -> SymmetricMatrix {
        let mut entries = Vec::new();
        for i in 0..size {
            entries.push((i, i, if i == 0 || i + 1 == size { 1.0 } else { 2.0 }));
            if i > 0 {
                entries.push((i, i - 1, -1.0));
            }
        }
        SymmetricMatrix::from_lower_triplets(size as usize, &entries)
    }

    #[test]
    fn repeated_places_are_added_and_upper_entries_ignored() {
        let matrix = SymmetricMatrix::from_lower_triplets(
            2,
            &[
                (1, 0, 2.0),
                (0, 0, 1.0),
                (1, 0, 3.0),
                (0, 1, 9.0),
                (1, 1, 4.0),
            ],
        );
        assert_eq!(matrix.column(0).collect::<Vec<_>>(), [(0, 1.0), (1, 5.0)]);
        assert_eq!(matrix.column(1).collect::<Vec<_>>(), [(0, 5.0), (1, 4.0)]);
    }

    #[test]
    fn entries_are_added_where_they_are_stored() {
        let mut matrix = path_laplacian(4);
        matrix.add_to_entries(&[(1, 2, 5.0), (2, 1, 5.0), (3, 3, 0.5)]);
        assert_eq!(
            matrix.column(2).collect::<Vec<_>>(),
            [(1, 4.0), (2, 2.0), (3, -1.0)]
        );
        assert_eq!(matrix.diagonal(), [1.0, 2.0, 2.0, 1.5]);
    }

    #[test]
    fn congruence_equals_three_products() {
        let matrix = path_laplacian(9);
        let diagonal: Vec<f64> = (0..9).map(|i| 1.0 + f64::from(i)).collect();
        let product = matrix.congruence(&diagonal);
        let x = Mat::from_fn(9, 2, |i, j| ((3 * i + 5 * j) % 7) as f64);
        let inner = matrix.multiply(x.as_ref());
        let scaled = Mat::from_fn(9, 2, |i, j| diagonal[i] * inner[(i, j)]);
        let expected = matrix.multiply(scaled.as_ref());
        assert_eq!(product.multiply(x.as_ref()), expected);
    }

    #[test]
    fn parts_of_a_product_equal_the_whole() {
        let matrix = path_laplacian(30);
        let x = Mat::from_fn(30, 6, |i, j| ((3 * i + 5 * j) % 7) as f64);
        let whole = matrix.multiply(x.as_ref());
        let rows = [3u32, 0, 29, 11];
        let part = matrix.multiply_rows(&rows, x.as_ref());
        let gathered = Mat::from_fn(4, 6, |k, j| whole[(rows[k] as usize, j)]);
        assert_eq!(part, gathered);
        let values = Mat::from_fn(4, 6, |k, j| (k + 2 * j) as f64);
        let mut spread = Mat::zeros(30, 6);
        rows.iter().enumerate().for_each(|(k, &row)| {
            (0..6).for_each(|j| spread[(row as usize, j)] = values[(k, j)]);
        });
        let product = matrix.multiply(spread.as_ref());
        assert_eq!(matrix.multiply_columns(&rows, values.as_ref()), product);
    }
}
