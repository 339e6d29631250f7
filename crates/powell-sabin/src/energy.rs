//! Exact element matrices of membrane and thin-plate energy.

use crate::element::{MacroTriangle, gradient_places};

/// A symmetric matrix over the nine numbers of a macro triangle.
pub type ElementMatrix = [[f64; 9]; 9];

/// Returns, for each of the nine numbers, the gradients at the seven points when it alone is 1.
fn unit_gradients(triangle: &MacroTriangle) -> [[[f64; 2]; 7]; 9] {
    let mut unit = [[[0.0; 2]; 7]; 9];
    for (k, gradients) in unit.iter_mut().enumerate() {
        let mut corners = [0.0; 9];
        corners[k] = 1.0;
        *gradients = triangle.gradients(&corners);
    }
    unit
}

/// Adds `weight` times the products of the entries of `row` to the lower triangle.
fn add_square(matrix: &mut ElementMatrix, weight: f64, row: &[f64; 9]) {
    for (i, entries) in matrix.iter_mut().enumerate() {
        let factor = weight * row[i];
        for (entry, value) in entries[..=i].iter_mut().zip(row) {
            *entry += factor * value;
        }
    }
}

fn mirrored(lower: &ElementMatrix) -> ElementMatrix {
    std::array::from_fn(|i| std::array::from_fn(|j| lower[i.max(j)][i.min(j)]))
}

/// Returns the matrix of the integral of `s_u² + s_v²` over a macro triangle; it does not depend on the
/// unit of length of values over constants.
///
/// Gradients are linear on the micro triangles, so that squares of them integrate exactly:
/// `area / 12 (|a|² + |b|² + |c|² + |a + b + c|²)`.
///
/// # Reference
/// [He2005] Eq. (9).
#[must_use]
pub fn membrane(triangle: &MacroTriangle) -> ElementMatrix {
    let unit = unit_gradients(triangle);
    let mut matrix = [[0.0; 9]; 9];
    for micro in 0..6 {
        let weight = triangle.micro_area(micro) / 12.0;
        let places = gradient_places(micro);
        for direction in 0..2 {
            let mut sum = [0.0; 9];
            for at in places {
                let row = unit.map(|gradients| gradients[at][direction]);
                add_square(&mut matrix, weight, &row);
                sum.iter_mut()
                    .zip(row)
                    .for_each(|(sum, value)| *sum += value);
            }
            add_square(&mut matrix, weight, &sum);
        }
    }
    mirrored(&matrix)
}

/// Returns the matrix of the integral of `s_uu² + 2 s_uv² + s_vv²` over a macro triangle, in one over the
/// square of the unit of length of the domain.
///
/// # Reference
/// [He2005] Eq. (9).
#[must_use]
pub fn thin_plate(triangle: &MacroTriangle) -> ElementMatrix {
    let unit = unit_gradients(triangle);
    let mut matrix = [[0.0; 9]; 9];
    for micro in 0..6 {
        let hessians = unit.map(|gradients| triangle.hessian(&gradients, micro));
        let area = triangle.micro_area(micro);
        for (entry, weight) in [(0, area), (1, 2.0 * area), (2, area)] {
            add_square(&mut matrix, weight, &hessians.map(|h| h[entry]));
        }
    }
    mirrored(&matrix)
}

/// Returns the energy of nine numbers.
#[must_use]
pub fn energy(matrix: &ElementMatrix, corners: &[f64; 9]) -> f64 {
    let row = |i: usize| -> f64 { matrix[i].iter().zip(corners).map(|(a, b)| a * b).sum() };
    (0..9).map(|i| corners[i] * row(i)).sum()
}
