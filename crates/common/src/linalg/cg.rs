//! Preconditioned conjugate gradients for several right-hand sides at once.

use faer::{Mat, MatRef};

/// When conjugate gradients have come close enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CgTolerance {
    /// In every column, when the residual is this small against the right-hand side, in the norm of
    /// the preconditioner.
    Relative(f64),
    /// In every column, when the squared residual in the norm of the preconditioner is below this.
    ///
    /// For normal equations that square is (up to the condition number) what the squared error of
    /// the fit exceeds its minimum by.
    Energy(f64),
}

/// How a run of conjugate gradients ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CgReport {
    /// Applications of the operator.
    pub iterations: u32,
    /// Largest ratio of a residual to its right-hand side, in the norm of the preconditioner.
    pub residual: f64,
    /// Whether every right-hand side met the tolerance.
    pub converged: bool,
}

/// Improves `x` until `A x = b` holds to the `tolerance` in every column.
///
/// `apply` returns `A` times its argument, `precondition` an approximate inverse times it; both must
/// be symmetric and positive definite. All columns step together, each with its own coefficients.
/// After each application `stepped` is told how far each column went along the direction that was
/// applied last; so what is linear in `x` can be kept up with it.
///
/// # Panics
/// If the shapes of `x` and `b` differ.
pub fn conjugate_gradient(
    mut apply: impl FnMut(MatRef<'_, f64>) -> Mat<f64>,
    mut precondition: impl FnMut(MatRef<'_, f64>) -> Mat<f64>,
    mut stepped: impl FnMut(&[f64]),
    b: MatRef<'_, f64>,
    x: &mut Mat<f64>,
    tolerance: CgTolerance,
    max_iterations: u32,
) -> CgReport {
    assert_eq!(
        (b.nrows(), b.ncols()),
        (x.nrows(), x.ncols()),
        "one unknown per equation"
    );
    let at_zero = x
        .col_iter()
        .all(|column| column.iter().all(|&value| value == 0.0));
    let mut residual = b.to_owned();
    if !at_zero {
        residual -= apply(x.as_ref());
    }
    let mut direction = precondition(residual.as_ref());
    let reference = column_products(b, precondition(b).as_ref());
    let mut product = column_products(residual.as_ref(), direction.as_ref());
    let limit: Vec<f64> = match tolerance {
        CgTolerance::Relative(ratio) => reference.iter().map(|r| r * ratio * ratio).collect(),
        CgTolerance::Energy(energy) => vec![energy; x.ncols()],
    };
    let mut iterations = 0;
    while iterations < max_iterations && product.iter().zip(&limit).any(|(p, l)| p > l) {
        let image = apply(direction.as_ref());
        let curvature = column_products(direction.as_ref(), image.as_ref());
        let steps: Vec<f64> = (0..x.ncols())
            .map(|side| {
                if product[side] <= limit[side] || curvature[side] <= 0.0 {
                    0.0
                } else {
                    product[side] / curvature[side]
                }
            })
            .collect();
        add_multiples(x, &steps, 1.0, &direction);
        add_multiples(&mut residual, &steps, -1.0, &image);
        stepped(&steps);
        let preconditioned = precondition(residual.as_ref());
        let next = column_products(residual.as_ref(), preconditioned.as_ref());
        let ratios: Vec<f64> = (next.iter().zip(&product))
            .map(|(next, before)| if *before > 0.0 { next / before } else { 0.0 })
            .collect();
        let before = std::mem::replace(&mut direction, preconditioned);
        add_multiples(&mut direction, &ratios, 1.0, &before);
        product = next;
        iterations += 1;
    }
    let ratios = product
        .iter()
        .zip(&reference)
        .map(|(p, r)| if *r > 0.0 { p / r } else { 0.0 });
    let converged = product.iter().zip(&limit).all(|(p, l)| p <= l);
    CgReport {
        iterations,
        residual: ratios.fold(0.0, f64::max).sqrt(),
        converged,
    }
}

/// Adds a multiple of each column of `y` to that of `x`.
fn add_multiples(x: &mut Mat<f64>, factors: &[f64], sign: f64, y: &Mat<f64>) {
    for (side, factor) in factors.iter().enumerate() {
        for row in 0..x.nrows() {
            x[(row, side)] += sign * factor * y[(row, side)];
        }
    }
}

fn column_products(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Vec<f64> {
    (0..a.ncols())
        .map(|c| (0..a.nrows()).map(|r| a[(r, c)] * b[(r, c)]).sum())
        .collect()
}
