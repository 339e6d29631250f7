//! The factorisation of one large front on all threads.
//!
//! Near the root there are fewer fronts than threads, and they are the largest. Their tiles do not
//! depend on the number of threads, so neither do the bits of the factor.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

use super::kernels::factor_diagonal;

/// Rows and columns of a tile.
const TILE: usize = 256;

/// Factors a panel in place and subtracts `L21 L21ᵀ` from the lower triangle of `update`; what lies
/// above the two triangles is lost.
///
/// Returns the column of the first pivot that is not positive.
pub(super) fn factor_by_tiles(
    mut panel: MatMut<'_, f64>,
    mut update: MatMut<'_, f64>,
) -> Result<(), usize> {
    let columns = panel.ncols();
    for first in (0..columns).step_by(TILE) {
        let width = TILE.min(columns - first);
        let (_, trailing) = panel.rb_mut().split_at_row_mut(first);
        let (_, trailing) = trailing.split_at_col_mut(first);
        let (here, later) = trailing.split_at_col_mut(width);
        let (mut top, mut bottom) = here.split_at_row_mut(width);
        factor_diagonal(top.rb_mut()).map_err(|column| first + column)?;
        let top = top.rb();
        row_tiles(bottom.rb_mut()).into_par_iter().for_each(|tile| {
            solve_lower_triangular_in_place(top, tile.transpose_mut(), Par::Seq);
        });
        subtract_square(later.split_at_row_mut(width).1, bottom.rb());
    }
    let below = panel.rb().split_at_row(columns).1;
    for first in (0..columns).step_by(TILE) {
        let width = TILE.min(columns - first);
        subtract_square(update.rb_mut(), below.subcols(first, width));
    }
    Ok(())
}

/// Subtracts the first columns of `A Aᵀ`, as many as the target has, from its lower trapezoid.
fn subtract_square(target: MatMut<'_, f64>, a: MatRef<'_, f64>) {
    let tiles = column_tiles(target).into_par_iter().enumerate();
    tiles.for_each(|(tile, target)| {
        let (first, width) = (tile * TILE, target.ncols());
        let (_, lower) = a.split_at_row(first);
        matmul(
            target.split_at_row_mut(first).1,
            Accum::Add,
            lower,
            lower.subrows(0, width).transpose(),
            -1.0,
            Par::Seq,
        );
    });
}

fn column_tiles(matrix: MatMut<'_, f64>) -> Vec<MatMut<'_, f64>> {
    let mut tiles = Vec::with_capacity(matrix.ncols().div_ceil(TILE));
    let mut rest = matrix;
    while rest.ncols() > 0 {
        let width = TILE.min(rest.ncols());
        let (tile, tail) = rest.split_at_col_mut(width);
        tiles.push(tile);
        rest = tail;
    }
    tiles
}

fn row_tiles(matrix: MatMut<'_, f64>) -> Vec<MatMut<'_, f64>> {
    let columns = column_tiles(matrix.transpose_mut()).into_iter();
    columns.map(MatMut::transpose_mut).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::Mat;

    /// A front of more than two tiles each way, diagonally dominant.
    const COLUMNS: usize = 2 * TILE + 40;
    const HEIGHT: usize = COLUMNS + 2 * TILE + 9;

    fn front() -> Mat<f64> {
        let entry = |i: usize, j: usize| ((i * 31 + j * 17) % 23) as f64 - 11.0;
        Mat::from_fn(HEIGHT, COLUMNS, |i, j| {
            if i == j {
                20.0 * HEIGHT as f64
            } else {
                entry(i.max(j), i.min(j))
            }
        })
    }

    #[test]
    fn a_front_by_tiles_is_the_factor_and_its_complement() {
        let panel = front();
        let (mut factor, mut update) = (
            panel.clone(),
            Mat::zeros(HEIGHT - COLUMNS, HEIGHT - COLUMNS),
        );
        factor_by_tiles(factor.as_mut(), update.as_mut()).unwrap();
        let lower = Mat::from_fn(
            HEIGHT,
            COLUMNS,
            |i, j| if i >= j { factor[(i, j)] } else { 0.0 },
        );
        let product = &lower * lower.subrows(0, COLUMNS).transpose();
        let bottom = lower.subrows(COLUMNS, HEIGHT - COLUMNS);
        let square = bottom * bottom.transpose();
        for j in 0..COLUMNS {
            for i in j..HEIGHT {
                assert!((product[(i, j)] - panel[(i, j)]).abs() < 1e-9, "{i} {j}");
            }
        }
        for j in 0..HEIGHT - COLUMNS {
            for i in j..HEIGHT - COLUMNS {
                assert!((square[(i, j)] + update[(i, j)]).abs() < 1e-9, "{i} {j}");
            }
        }
    }

    #[test]
    fn the_first_bad_pivot_is_named_in_a_later_tile() {
        let mut panel = front();
        panel[(TILE + 7, TILE + 7)] = -1.0;
        panel[(TILE + 9, TILE + 9)] = -1.0;
        let mut update = Mat::zeros(HEIGHT - COLUMNS, HEIGHT - COLUMNS);
        let found = factor_by_tiles(panel.as_mut(), update.as_mut());
        assert_eq!(found, Err(TILE + 7));
    }
}
