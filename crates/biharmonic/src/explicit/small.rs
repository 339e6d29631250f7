//! The inverse of a small dense matrix.

/// Replaces a symmetric positive definite m × m matrix by its inverse, both triangles.
///
/// By its Cholesky factor. A pivot lost to rounding is replaced by the smallest that keeps the result
/// finite and definite: in the barrier method this comes from is then a slightly shorter step.
pub(super) fn invert(matrix: &mut [f64], size: usize) {
    let at = |row: usize, column: usize| row * size + column;
    for column in 0..size {
        for row in column..size {
            let known = (0..column).map(|k| matrix[at(row, k)] * matrix[at(column, k)]);
            let left = matrix[at(row, column)] - known.sum::<f64>();
            matrix[at(row, column)] = if row == column {
                left.max(f64::EPSILON * matrix[at(row, row)].abs())
                    .max(f64::MIN_POSITIVE)
                    .sqrt()
            } else {
                left / matrix[at(column, column)]
            };
        }
    }
    // The inverse of the factor takes its place, then is multiplied by its transpose.
    for column in 0..size {
        matrix[at(column, column)] = 1.0 / matrix[at(column, column)];
        for row in column + 1..size {
            let known = (column..row).map(|k| matrix[at(row, k)] * matrix[at(k, column)]);
            matrix[at(row, column)] = -known.sum::<f64>() / matrix[at(row, row)];
        }
    }
    for column in 0..size {
        for row in column..size {
            let products = (row..size).map(|k| matrix[at(k, row)] * matrix[at(k, column)]);
            let value = products.sum();
            matrix[at(column, row)] = value;
        }
    }
    for column in 0..size {
        for row in column..size {
            matrix[at(row, column)] = matrix[at(column, row)];
        }
    }
}
