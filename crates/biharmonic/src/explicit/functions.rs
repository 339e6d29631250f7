//! The basis functions themselves, and how local they are.

use std::ops::ControlFlow;

use msplines_common::linalg::{Mat, column};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::columns::AT_ONCE;
use super::{ExplicitBasis, ExplicitError, Rule, SparseColumns};

/// Rings that mass is sorted into; whatever lies farther out counts as the last.
const SORTED: u8 = 4;

/// How local the functions of a basis are, and whether they sum to one.
///
/// Mass is the sum of absolute values over the vertices, not weighted by area: fits weigh vertices
/// alike, too. Shares are of the mass of one function.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Locality {
    /// Share of the mass outside of the first, second and third ring of cells, mean over the functions.
    pub outside: [f64; 3],
    /// The largest share of any function outside of the second ring.
    pub worst_outside: f64,
    /// The smallest value of any function.
    pub smallest: f64,
    /// The largest value of any function.
    pub largest: f64,
    /// Share of the mass where the function is negative, mean over the functions.
    pub negative: f64,
    /// Largest difference from one of the sum of all functions at a vertex.
    pub unity_error: f64,
}

/// Basis functions cut off beyond some rings.
#[derive(Clone, Debug, PartialEq)]
pub struct LocalFunctions {
    /// One column per function, one row per vertex.
    pub functions: SparseColumns,
    /// Share of the mass of each function that was cut off.
    pub lost: Vec<f64>,
}

/// What one function adds to [`Locality`].
struct Masses {
    /// By ring; the last holds all beyond.
    rings: [f64; SORTED as usize + 1],
    negative: f64,
    range: [f64; 2],
}

impl ExplicitBasis {
    /// Returns a basis function at all vertices. One solve.
    ///
    /// # Errors
    /// A function that does not exist, or a mesh that cannot be factored.
    pub fn function(&self, index: usize) -> Result<Vec<f64>, ExplicitError> {
        self.check_function(index)?;
        let block = self.block(index, 1)?;
        Ok(column(block.as_ref(), 0).to_vec())
    }

    /// Returns all functions, cut off beyond so many rings of cells: about 37 n numbers for 3.
    ///
    /// One solve per knot. What is cut off is missing from the partition of unity.
    ///
    /// # Errors
    /// A mesh that cannot be factored.
    pub fn local_functions(&self, rings: u32) -> Result<LocalFunctions, ExplicitError> {
        let (mut columns, mut lost) = (Vec::new(), Vec::new());
        self.for_each_block(|first, block| {
            let cut = |side: usize| {
                let cells = self.rings.around(first + side, rings);
                let members = cells.iter().flat_map(|&cell| self.rings.members(cell));
                let mut rows: Vec<u32> = members.copied().collect();
                rows.sort_unstable();
                let all = column(block.as_ref(), side);
                let values: Vec<f64> = rows.iter().map(|&v| all[v as usize]).collect();
                let mass = |values: &[f64]| values.iter().map(|x| x.abs()).sum::<f64>();
                let share = (1.0 - mass(&values) / mass(all)).max(0.0);
                ((rows, values), share)
            };
            let found: Vec<_> = (0..block.ncols()).into_par_iter().map(cut).collect();
            for (function, share) in found {
                columns.push(function);
                lost.push(share);
            }
            ControlFlow::Continue(())
        })?;
        let vertices = self.space.mesh().vertex_count();
        Ok(LocalFunctions {
            functions: SparseColumns::of_columns(vertices, columns),
            lost,
        })
    }

    /// Returns how local the functions are. One solve per knot; no function is cut off.
    ///
    /// # Errors
    /// A mesh that cannot be factored.
    pub fn locality(&self) -> Result<Locality, ExplicitError> {
        let mut sums = vec![0.0; self.space.mesh().vertex_count()];
        let mut masses = Vec::with_capacity(self.knots.len());
        self.for_each_block(|first, block| {
            let sides = (0..block.ncols()).into_par_iter();
            let found: Vec<Masses> = sides
                .map(|side| self.masses(first + side, column(block.as_ref(), side)))
                .collect();
            masses.extend(found);
            for side in 0..block.ncols() {
                let values = column(block.as_ref(), side);
                sums.iter_mut()
                    .zip(values)
                    .for_each(|(sum, value)| *sum += value);
            }
            ControlFlow::Continue(())
        })?;
        Ok(summary(&masses, &sums))
    }

    fn masses(&self, centre: usize, values: &[f64]) -> Masses {
        let ring = self.rings.distances(centre, SORTED);
        let mut masses = Masses {
            rings: [0.0; SORTED as usize + 1],
            negative: 0.0,
            range: [f64::INFINITY, f64::NEG_INFINITY],
        };
        for (vertex, &value) in values.iter().enumerate() {
            masses.rings[ring[self.rings.cell(vertex)] as usize] += value.abs();
            masses.negative += (-value).max(0.0);
            masses.range = [masses.range[0].min(value), masses.range[1].max(value)];
        }
        masses
    }

    /// Hands over all functions at all vertices, a few columns at a time.
    fn for_each_block(
        &self,
        mut see: impl FnMut(usize, &Mat<f64>) -> ControlFlow<()>,
    ) -> Result<(), ExplicitError> {
        let count = self.knots.len();
        for first in (0..count).step_by(AT_ONCE) {
            let block = self.block(first, AT_ONCE.min(count - first))?;
            if see(first, &block).is_break() {
                return Err(ExplicitError::Stopped);
            }
        }
        Ok(())
    }

    /// Returns some functions at all vertices.
    fn block(&self, first: usize, width: usize) -> Result<Mat<f64>, ExplicitError> {
        match &self.rule {
            Rule::Mixture(mixture) => {
                let values = mixture.matrix().dense(first..first + width);
                Ok(self.system()?.extend(values.as_ref()))
            }
            Rule::Masks(masks) => {
                let mut w = Mat::zeros(self.space.mesh().vertex_count(), width);
                for side in 0..width {
                    let (rows, values) = masks.masks.column(first + side);
                    for (&knot, &value) in rows.iter().zip(values) {
                        w[(self.knots[knot as usize] as usize, side)] = value;
                    }
                }
                let poisson = self.space.poisson()?;
                let mut f = poisson.solve_biharmonic(w);
                for side in 0..width {
                    let constant = masks.constants[first + side];
                    (0..f.nrows()).for_each(|v| f[(v, side)] += constant);
                }
                Ok(f)
            }
        }
    }
}

fn summary(masses: &[Masses], sums: &[f64]) -> Locality {
    let beyond = |m: &Masses, ring: usize| {
        let total: f64 = m.rings.iter().sum();
        m.rings[ring + 1..].iter().sum::<f64>() / total
    };
    let mean = |share: &dyn Fn(&Masses) -> f64| {
        masses.iter().map(share).sum::<f64>() / masses.len() as f64
    };
    Locality {
        outside: [1, 2, 3].map(|ring| mean(&|m| beyond(m, ring))),
        worst_outside: masses.iter().map(|m| beyond(m, 2)).fold(0.0, f64::max),
        smallest: masses
            .iter()
            .map(|m| m.range[0])
            .fold(f64::INFINITY, f64::min),
        largest: masses
            .iter()
            .map(|m| m.range[1])
            .fold(f64::NEG_INFINITY, f64::max),
        negative: mean(&|m| m.negative / m.rings.iter().sum::<f64>()),
        unity_error: sums.iter().map(|sum| (sum - 1.0).abs()).fold(0.0, f64::max),
    }
}
