//! The columns of `H` near their knots.
//!
//! `H e_k`, the spline that is 1 at one knot and 0 at all others, decays by about a factor of five
//! from ring to ring. What lies beyond the fourth ring is left out: less than 0.3 % of its mass, and a
//! hundred-thousandth of its square, which is all that the optimisation of a basis sees.

use std::ops::ControlFlow;

use msplines_common::linalg::{Mat, column};
use rayon::prelude::*;

use crate::knot_values::KnotValues;
use crate::rings::Rings;

/// Rings of cells in which a column is kept.
const RINGS: u32 = 4;

/// Columns that are solved for at once: a few passes of the solver, and little memory.
pub(super) const AT_ONCE: usize = 32;

/// The columns of `H`, each in the cells around its knot. About 61 n numbers, whatever the number of
/// knots.
pub(super) struct LocalColumns {
    columns: Vec<LocalColumn>,
}

struct LocalColumn {
    /// The cells, ascending.
    cells: Vec<u32>,
    /// Where the values in each cell start.
    starts: Vec<u32>,
    /// The values, in the order of the vertices of a cell.
    values: Vec<f64>,
}

impl LocalColumns {
    /// Solves for all columns; `progress` is asked after every few whether to go on.
    pub(super) fn build(
        system: &KnotValues<'_>,
        rings: &Rings,
        mut progress: impl FnMut(usize) -> ControlFlow<()>,
    ) -> Option<Self> {
        let count = rings.len();
        let mut columns = Vec::with_capacity(count);
        for first in (0..count).step_by(AT_ONCE) {
            if progress(first).is_break() {
                return None;
            }
            let width = AT_ONCE.min(count - first);
            let units = Mat::from_fn(count, width, |k, side| {
                f64::from(u8::from(k == first + side))
            });
            let solved = system.extend(units.as_ref());
            let block = (0..width).into_par_iter().map(|side| {
                let cells = rings.around(first + side, RINGS);
                LocalColumn::cut(column(solved.as_ref(), side), cells, rings)
            });
            columns.extend(block.collect::<Vec<_>>());
        }
        Some(Self { columns })
    }

    /// Returns the values of a column in a cell, none if the cell is too far away.
    pub(super) fn within(&self, knot: u32, cell: u32) -> Option<&[f64]> {
        let column = &self.columns[knot as usize];
        let at = column.cells.binary_search(&cell).ok()?;
        let range = column.starts[at] as usize..column.starts[at + 1] as usize;
        Some(&column.values[range])
    }

    /// Returns the cells in which a column is kept, ascending.
    pub(super) fn cells(&self, knot: u32) -> &[u32] {
        &self.columns[knot as usize].cells
    }
}

impl LocalColumn {
    fn cut(values: &[f64], cells: Vec<u32>, rings: &Rings) -> Self {
        let mut column = Self {
            starts: vec![0],
            values: Vec::new(),
            cells,
        };
        for &cell in &column.cells {
            let members = rings.members(cell).iter();
            column.values.extend(members.map(|&v| values[v as usize]));
            column.starts.push(column.values.len() as u32);
        }
        column
    }
}
