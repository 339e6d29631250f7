//! Harmonic extension: the values at some vertices from those at the others.
//!
//! # Notation
//! `w` is the weight of an edge, the same at both of its half-edges: `(cot α + cot β) / 2`.

use msplines_common::linalg::{
    Cholesky, FactorError, Mat, Ordering, Symbolic, SymmetricMatrix, column_mut,
};
use msplines_common::mesh::{NONE, Topology};
use msplines_common::operators::half_cotangents;
use msplines_common::operators::intrinsic::IntrinsicTriangulation;
use rayon::prelude::*;

/// Solves after the first, each from the residual of the one before, which is formed from
/// differences: small triangles far from the origin keep their digits.
const REFINEMENTS: usize = 2;

/// Returns the cotangent weight of the edge of each half-edge.
///
/// # Reference
/// [Pinkall1993].
pub(crate) fn cotangent_weights(triangulation: &IntrinsicTriangulation) -> Vec<f64> {
    let lengths = triangulation.lengths.iter();
    let halves: Vec<f64> = lengths.flat_map(|&sides| half_cotangents(sides)).collect();
    let twins = &triangulation.twins;
    let total = |(h, &own): (usize, &f64)| match twins[h] {
        NONE => own,
        // The same order at both half-edges, so that both have the same bits.
        twin => halves[h.min(twin as usize)] + halves[h.max(twin as usize)],
    };
    halves.iter().enumerate().map(total).collect()
}

/// Raises weights below `ratio` times the median to that.
pub(crate) fn bound_below(weights: &mut [f64], ratio: f64) {
    let mut sorted = weights.to_vec();
    sorted.sort_by(f64::total_cmp);
    let floor = ratio * sorted[sorted.len() / 2];
    weights.iter_mut().for_each(|w| *w = w.max(floor));
}

/// Returns the Laplacian of edge weights: rows sum to zero, positive weights make it semidefinite.
pub(crate) fn laplacian(
    vertex_count: usize,
    triangulation: &IntrinsicTriangulation,
    weights: &[f64],
) -> SymmetricMatrix {
    let mut entries = Vec::with_capacity(2 * weights.len());
    entries.extend((0..vertex_count as u32).map(|v| (v, v, 0.0)));
    for (h, &weight) in (0u32..).zip(weights) {
        let twin = triangulation.twins[h as usize];
        let [a, b] = ends(triangulation, h);
        if h < twin && a != b {
            entries.extend([
                (a, a, weight),
                (b, b, weight),
                (a.max(b), a.min(b), -weight),
            ]);
        }
    }
    SymmetricMatrix::from_lower_triplets(vertex_count, &entries)
}

/// Returns the vertices that a half-edge joins.
pub(crate) fn ends(triangulation: &IntrinsicTriangulation, half_edge: u32) -> [u32; 2] {
    let origin = |h: u32| triangulation.faces[(h / 3) as usize][(h % 3) as usize];
    [origin(half_edge), origin(Topology::next(half_edge))]
}

/// A factored Laplacian on the free vertices.
pub(crate) struct Extension<'a> {
    laplacian: &'a SymmetricMatrix,
    free: Vec<bool>,
    factor: Option<Cholesky>,
}

impl<'a> Extension<'a> {
    /// Factors the rows of the free vertices; `ordering` is of the whole Laplacian.
    pub(crate) fn factor(
        laplacian: &'a SymmetricMatrix,
        ordering: &Ordering,
        free: Vec<bool>,
    ) -> Result<Self, FactorError> {
        let factor = if free.contains(&true) {
            let symbolic = Symbolic::analyze_kept(laplacian, ordering, |row| free[row]);
            Some(Cholesky::factor(symbolic, laplacian)?)
        } else {
            None
        };
        Ok(Self {
            laplacian,
            free,
            factor,
        })
    }

    /// Replaces the values at free vertices by those at which the Laplacian is zero.
    pub(crate) fn extend(&self, values: &mut Mat<f64>) {
        self.solve(values, &|_, _| 0.0);
    }

    /// Replaces the values at free vertices by those at which the Laplacian is `right(row, column)`.
    pub(crate) fn solve(
        &self,
        values: &mut Mat<f64>,
        right: &(impl Fn(usize, usize) -> f64 + Sync),
    ) {
        let Some(factor) = &self.factor else { return };
        for side in 0..values.ncols() {
            let column = column_mut(values.as_mut(), side);
            column
                .iter_mut()
                .zip(&self.free)
                .filter(|(_, free)| **free)
                .for_each(|(value, _)| *value = 0.0);
        }
        for _ in 0..=REFINEMENTS {
            let mut correction = self.residual(values, right);
            factor.solve_in_place(correction.as_mut());
            *values += correction;
        }
    }

    /// Returns right-hand side minus Laplacian at free vertices, zero elsewhere.
    fn residual(
        &self,
        values: &Mat<f64>,
        right: &(impl Fn(usize, usize) -> f64 + Sync),
    ) -> Mat<f64> {
        let mut residual = Mat::zeros(values.nrows(), values.ncols());
        for side in 0..values.ncols() {
            let value = msplines_common::linalg::column(values.as_ref(), side);
            let target = column_mut(residual.as_mut(), side);
            target.par_iter_mut().enumerate().for_each(|(row, target)| {
                if self.free[row] {
                    let terms = self.laplacian.column(row).filter(|entry| entry.0 != row);
                    let pull = |(other, entry): (usize, f64)| entry * (value[row] - value[other]);
                    // Off-diagonal entries are minus the weights.
                    *target = right(row, side) + terms.map(pull).sum::<f64>();
                }
            });
        }
        residual
    }
}
