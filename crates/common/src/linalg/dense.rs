//! Columns of dense matrices as slices.

use faer::{MatMut, MatRef};

/// Returns a column as a slice, empty if the matrix has no rows.
///
/// # Panics
/// If there is no such column.
#[must_use]
pub fn column(matrix: MatRef<'_, f64>, column: usize) -> &[f64] {
    matrix
        .col(column)
        .try_as_col_major()
        .map_or(&[][..], |c| c.as_slice())
}

/// Returns a column as a mutable slice, empty if the matrix has no rows.
///
/// # Panics
/// If there is no such column.
#[must_use]
pub fn column_mut(matrix: MatMut<'_, f64>, column: usize) -> &mut [f64] {
    matrix
        .col_mut(column)
        .try_as_col_major_mut()
        .map_or(&mut [][..], |c| c.as_slice_mut())
}
