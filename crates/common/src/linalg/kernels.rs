//! Dense kernels of one front: partial factorisation and triangular solves.
//!
//! Fronts go to faer, sequentially, the largest tile by tile. Small ones, where a call costs more than
//! the arithmetic, and solves with few right-hand sides, where one pass over the panel is all that
//! matters, are plain loops compiled for the vector units of the machine.
//!
//! # Notation
//! A panel has `c` columns of height `m`, column-major; its upper part is the triangle `L11`, its
//! lower part `L21` has `r = m - c` rows.

use super::dense::{self, column_mut};
use super::tiles::factor_by_tiles;
use dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{
    LltError, LltParams, LltRegularization, cholesky_in_place, cholesky_in_place_scratch,
};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{BlockStructure, matmul as triangular_matmul};
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par, Spec};

/// Panels with fewer multiplications than this are factored by plain loops.
const SMALL_FRONT: usize = 6_000;

/// Panels with more multiplications than this are factored on all threads; eight times as many make no
/// difference at a million vertices.
const LARGE_FRONT: usize = 60_000_000;

/// Solves with fewer right-hand sides than this pass over a panel once, column after column.
pub(super) const FEW_SIDES: usize = 6;

/// Factors a panel in place and subtracts `L21 L21ᵀ` from the lower triangle of `update` (r × r).
///
/// Returns the column of the first pivot that is not positive.
pub(super) fn factor_front(
    panel: &mut [f64],
    columns: usize,
    update: &mut [f64],
) -> Result<(), usize> {
    let height = panel.len() / columns;
    let below = height - columns;
    if columns * height * height < SMALL_FRONT {
        return pulp::Arch::new().dispatch(Small {
            panel,
            columns,
            update,
        });
    }
    let matrix = MatMut::from_column_major_slice_mut(panel, height, columns);
    let mut update = MatMut::from_column_major_slice_mut(update, below, below);
    if columns * height * height > LARGE_FRONT {
        return factor_by_tiles(matrix, update);
    }
    let (mut top, mut bottom) = matrix.split_at_row_mut(columns);
    factor_diagonal(top.rb_mut())?;
    if below > 0 {
        solve_lower_triangular_in_place(top.rb(), bottom.rb_mut().transpose_mut(), Par::Seq);
        triangular_matmul(
            update.rb_mut(),
            BlockStructure::TriangularLower,
            Accum::Add,
            bottom.rb(),
            BlockStructure::Rectangular,
            bottom.rb().transpose(),
            BlockStructure::Rectangular,
            -1.0,
            Par::Seq,
        );
    }
    Ok(())
}

/// Factors a symmetric matrix of which the lower triangle is given, in place.
///
/// Returns the column of the first pivot that is not positive.
pub(super) fn factor_diagonal(matrix: MatMut<'_, f64>) -> Result<(), usize> {
    let params: Spec<LltParams, f64> = Spec::default();
    let scratch = cholesky_in_place_scratch::<f64>(matrix.ncols(), Par::Seq, params);
    let mut memory = MemBuffer::new(scratch);
    let stack = MemStack::new(&mut memory);
    let none = LltRegularization::default();
    match cholesky_in_place(matrix, none, Par::Seq, stack, params) {
        Ok(_) => Ok(()),
        Err(LltError::NonPositivePivot { index }) => Err(index),
    }
}

struct Small<'a> {
    panel: &'a mut [f64],
    columns: usize,
    update: &'a mut [f64],
}

impl pulp::NullaryFnOnce for Small<'_> {
    type Output = Result<(), usize>;

    #[inline(always)]
    fn call(self) -> Result<(), usize> {
        let height = self.panel.len() / self.columns;
        let below = height - self.columns;
        for column in 0..self.columns {
            let (done, rest) = self.panel.split_at_mut((column + 1) * height);
            let pivot_column = &mut done[column * height + column..];
            let pivot = pivot_column[0];
            if !(pivot > 0.0 && pivot.is_finite()) {
                return Err(column);
            }
            let root = pivot.sqrt();
            let inverse = 1.0 / root;
            pivot_column[0] = root;
            pivot_column[1..]
                .iter_mut()
                .for_each(|value| *value *= inverse);
            for (offset, later) in rest.chunks_exact_mut(height).enumerate() {
                let factor = pivot_column[1 + offset];
                let later = &mut later[column + 1 + offset..];
                subtract_multiple(later, factor, &pivot_column[1 + offset..]);
            }
        }
        for column in 0..self.columns {
            let lower = &self.panel[column * height + self.columns..(column + 1) * height];
            for (row, factor) in lower.iter().enumerate() {
                let target = &mut self.update[row * below + row..(row + 1) * below];
                subtract_multiple(target, *factor, &lower[row..]);
            }
        }
        Ok(())
    }
}

#[inline(always)]
fn subtract_multiple(target: &mut [f64], factor: f64, source: &[f64]) {
    for (value, other) in target.iter_mut().zip(source) {
        *value -= factor * other;
    }
}

/// Solves `L11 y = x` in place and returns `L21 y` in `below` (r × k, overwritten).
///
/// `x` is c × k and `below` r × k, both with contiguous columns.
pub(super) fn forward(panel: &[f64], mut x: MatMut<'_, f64>, mut below: MatMut<'_, f64>) {
    let columns = x.nrows();
    if x.ncols() < FEW_SIDES {
        pulp::Arch::new().dispatch(Forward { panel, x, below });
        return;
    }
    let height = panel.len() / columns;
    let (top, bottom) =
        MatRef::from_column_major_slice(panel, height, columns).split_at_row(columns);
    solve_lower_triangular_in_place(top, x.rb_mut(), Par::Seq);
    matmul(
        below.rb_mut(),
        Accum::Replace,
        bottom,
        x.rb(),
        1.0,
        Par::Seq,
    );
}

struct Forward<'a> {
    panel: &'a [f64],
    x: MatMut<'a, f64>,
    below: MatMut<'a, f64>,
}

impl pulp::NullaryFnOnce for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        let columns = self.x.nrows();
        let height = self.panel.len() / columns;
        self.below.fill(0.0);
        for first in (0..columns).step_by(BLOCK) {
            let width = BLOCK.min(columns - first);
            let at = |i: usize| &self.panel[(first + i) * height..(first + i + 1) * height];
            let next = first + width;
            for side in 0..self.x.ncols() {
                let x = column_mut(self.x.rb_mut(), side);
                let below = column_mut(self.below.rb_mut(), side);
                for i in 0..width {
                    let (column, here) = (at(i), first + i);
                    let value = x[here] / column[here];
                    x[here] = value;
                    subtract_multiple(&mut x[here + 1..next], value, &column[here + 1..next]);
                }
                if width == BLOCK {
                    let factors: [f64; BLOCK] = std::array::from_fn(|i| x[first + i]);
                    let rest = std::array::from_fn(|i| &at(i)[next..columns]);
                    add_multiples(&mut x[next..], factors.map(|f| -f), rest);
                    add_multiples(below, factors, std::array::from_fn(|i| &at(i)[columns..]));
                } else {
                    for i in 0..width {
                        subtract_multiple(below, -x[first + i], &at(i)[columns..]);
                    }
                }
            }
        }
    }
}

/// Columns of a panel that one pass over a right-hand side serves.
const BLOCK: usize = 4;

#[inline(always)]
fn add_multiples(target: &mut [f64], factors: [f64; BLOCK], sources: [&[f64]; BLOCK]) {
    let length = target.len();
    let sources = sources.map(|source| &source[..length]);
    for (row, value) in target.iter_mut().enumerate() {
        *value += (factors[0] * sources[0][row] + factors[1] * sources[1][row])
            + (factors[2] * sources[2][row] + factors[3] * sources[3][row]);
    }
}

/// Solves `L11ᵀ y = x - L21ᵀ below` in place.
pub(super) fn backward(panel: &[f64], mut x: MatMut<'_, f64>, below: MatRef<'_, f64>) {
    let columns = x.nrows();
    if x.ncols() < FEW_SIDES {
        pulp::Arch::new().dispatch(Backward { panel, x, below });
        return;
    }
    let height = panel.len() / columns;
    let (top, bottom) =
        MatRef::from_column_major_slice(panel, height, columns).split_at_row(columns);
    matmul(
        x.rb_mut(),
        Accum::Add,
        bottom.transpose(),
        below,
        -1.0,
        Par::Seq,
    );
    solve_upper_triangular_in_place(top.transpose(), x.rb_mut(), Par::Seq);
}

struct Backward<'a> {
    panel: &'a [f64],
    x: MatMut<'a, f64>,
    below: MatRef<'a, f64>,
}

impl pulp::NullaryFnOnce for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        let columns = self.x.nrows();
        let height = self.panel.len() / columns;
        for first in (0..columns).step_by(BLOCK).rev() {
            let width = BLOCK.min(columns - first);
            let at = |i: usize| &self.panel[(first + i) * height..(first + i + 1) * height];
            let next = first + width;
            for side in 0..self.x.ncols() {
                let x = column_mut(self.x.rb_mut(), side);
                let below = dense::column(self.below, side);
                if width == BLOCK {
                    let rest = dots(std::array::from_fn(|i| &at(i)[next..columns]), &x[next..]);
                    let bottom = dots(std::array::from_fn(|i| &at(i)[columns..]), below);
                    (0..BLOCK).for_each(|i| x[first + i] -= rest[i] + bottom[i]);
                } else {
                    for i in 0..width {
                        let rest = dot(&at(i)[next..columns], &x[next..]);
                        x[first + i] -= rest + dot(&at(i)[columns..], below);
                    }
                }
                for i in (0..width).rev() {
                    let (column, here) = (at(i), first + i);
                    let later = dot(&column[here + 1..next], &x[here + 1..next]);
                    x[here] = (x[here] - later) / column[here];
                }
            }
        }
    }
}

/// Returns four scalar products with the same vector, each summed in four lanes.
#[inline(always)]
fn dots(columns: [&[f64]; BLOCK], vector: &[f64]) -> [f64; BLOCK] {
    let (blocks, rest) = vector.as_chunks::<4>();
    let tails = columns.map(|column| &column[4 * blocks.len()..]);
    let columns = columns.map(|column| &column.as_chunks::<4>().0[..blocks.len()]);
    let mut lanes = [[0.0f64; 4]; BLOCK];
    for (at, block) in blocks.iter().enumerate() {
        for (sums, column) in lanes.iter_mut().zip(&columns) {
            for lane in 0..4 {
                sums[lane] += column[at][lane] * block[lane];
            }
        }
    }
    std::array::from_fn(|i| {
        (lanes[i][0] + lanes[i][2]) + (lanes[i][1] + lanes[i][3]) + dot(tails[i], rest)
    })
}

/// Returns the scalar product, summed in eight lanes whatever the machine.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0f64; 8];
    let (a_blocks, b_blocks) = (a.chunks_exact(8), b.chunks_exact(8));
    let (a_rest, b_rest) = (a_blocks.remainder(), b_blocks.remainder());
    for (x, y) in a_blocks.zip(b_blocks) {
        for lane in 0..8 {
            lanes[lane] += x[lane] * y[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(x, y)| x * y).sum();
    let pairs = [
        lanes[0] + lanes[4],
        lanes[1] + lanes[5],
        lanes[2] + lanes[6],
        lanes[3] + lanes[7],
    ];
    (pairs[0] + pairs[2]) + (pairs[1] + pairs[3]) + rest
}
