//! Short bases of a lattice.

use nalgebra::{DMatrix, DVector};

/// Part of the square of a vector below which the square of the next one, less what is along those
/// before, has to lie for the two to be swapped. In two dimensions all but the last digits of 1 give the
/// shortest vector.
const SWAPPED: f64 = 1.0 - 1e-9;

/// Visits of a vector after which a basis is left as it is, for each of them and for each pair.
const VISITS: usize = 100;

/// Returns a basis of short integer vectors, in the norm that a positive definite matrix gives, as
/// columns; its determinant is ±1. O(n²) for each of some n² visits.
///
/// # Reference
/// [Lenstra1982], basis reduction; [Gauss1801] art. 171 in two dimensions.
pub(super) fn reduced(gram: &DMatrix<f64>) -> DMatrix<f64> {
    let classes = gram.nrows();
    let mut basis = DMatrix::<f64>::identity(classes, classes);
    // Squares of what is orthogonal to the vectors before, and shares of these.
    let mut squares = vec![0.0; classes];
    let mut shares = DMatrix::<f64>::zeros(classes, classes);
    let mut k = 0;
    for _ in 0..VISITS * classes * classes {
        if k == classes {
            break;
        }
        squares[k] = orthogonalise(gram, &basis, &squares, &mut shares, k);
        for j in (0..k).rev() {
            let times = shares[(k, j)].round();
            if times != 0.0 {
                let shorter: DVector<f64> = basis.column(k) - basis.column(j) * times;
                basis.set_column(k, &shorter);
                (0..j).for_each(|i| shares[(k, i)] -= times * shares[(j, i)]);
                shares[(k, j)] -= times;
            }
        }
        let beside = |k: usize| squares[k] + shares[(k, k - 1)].powi(2) * squares[k - 1];
        if k > 0 && beside(k) < SWAPPED * squares[k - 1] {
            basis.swap_columns(k - 1, k);
            k -= 1;
        } else {
            k += 1;
        }
    }
    basis
}

/// Fills in the shares of the vectors before in vector `k`; returns the square of what is left.
fn orthogonalise(
    gram: &DMatrix<f64>,
    basis: &DMatrix<f64>,
    squares: &[f64],
    shares: &mut DMatrix<f64>,
    k: usize,
) -> f64 {
    let image: DVector<f64> = gram * basis.column(k);
    for j in 0..k {
        let along: f64 = (0..j)
            .map(|i| shares[(j, i)] * shares[(k, i)] * squares[i])
            .sum();
        shares[(k, j)] = (basis.column(j).dot(&image) - along) / squares[j];
    }
    let before: f64 = (0..k).map(|j| shares[(k, j)].powi(2) * squares[j]).sum();
    basis.column(k).dot(&image) - before
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheared_lattice_of_squares_is_found_again() {
        for shear in [3.0, -7.0, 100.0] {
            let skew = DMatrix::from_row_slice(
                3,
                3,
                &[
                    1.0, shear, 2.0, //
                    0.0, 1.0, -shear, //
                    0.0, 0.0, 1.0,
                ],
            );
            let basis = reduced(&(skew.transpose() * &skew));
            assert!((basis.determinant().abs() - 1.0).abs() < 1e-9);
            let vectors = &skew * basis;
            assert!((vectors.transpose() * &vectors - DMatrix::identity(3, 3)).norm() < 1e-9);
        }
    }

    #[test]
    fn the_first_of_two_is_the_shortest_of_all() {
        let gram = DMatrix::from_row_slice(2, 2, &[5.0, 8.9, 8.9, 16.0]);
        let first = reduced(&gram).column(0).into_owned();
        let square = |n: &DVector<f64>| n.dot(&(&gram * n));
        for (a, b) in (-9..=9).flat_map(|a| (-9..=9).map(move |b| (a, b))) {
            let other = DVector::from_vec(vec![f64::from(a), f64::from(b)]);
            assert!((a, b) == (0, 0) || square(&first) <= square(&other) * (1.0 + 1e-12));
        }
    }
}
