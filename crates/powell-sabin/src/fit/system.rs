//! The symmetric system of all unknowns, and its solution.
//!
//! # Reference
//! [He2005] Eq. (9). Deviation: unknowns that keep positions and normals, instead of Lagrange
//! multipliers; the matrix is positive definite and smaller.

use msplines_common::linalg::{Cholesky, Mat, Ordering, Symbolic, SymmetricMatrix};
use rayon::prelude::*;

use super::data::{Numbers, Unknowns};
use super::stiffness::{Block, Stiffness};
use crate::domain::FlatDomain;
use crate::error::FitError;

/// Vertices whose rows one task assembles.
const VERTICES_PER_TASK: usize = 512;

/// The system `A x = b`.
pub(super) struct System {
    pub(super) matrix: SymmetricMatrix,
    pub(super) right: Vec<f64>,
    /// Elimination order of the unknowns.
    pub(super) order: Vec<u32>,
}

/// Lower triangle of rows, and right-hand sides.
type Rows = (Vec<(u32, u32, f64)>, Vec<f64>);

impl System {
    pub(super) fn assemble(
        domain: &FlatDomain,
        stiffness: &Stiffness<'_>,
        unknowns: &Unknowns,
    ) -> Result<Self, FitError> {
        let active: Vec<u32> = (0..domain.mesh().vertex_count() as u32)
            .filter(|&v| !unknowns.range(v).is_empty())
            .collect();
        let parts: Vec<Rows> = active
            .par_chunks(VERTICES_PER_TASK)
            .map(|vertices| rows(vertices, stiffness, unknowns))
            .collect();
        let entries = parts.iter().map(|p| p.0.len()).sum();
        let (mut triplets, mut right) = (Vec::with_capacity(entries), Vec::new());
        for (entries, values) in parts {
            triplets.extend(entries);
            right.extend(values);
        }
        Ok(Self {
            matrix: SymmetricMatrix::from_lower_triplets(unknowns.count(), &triplets),
            right,
            order: order(domain, unknowns, &active)?,
        })
    }

    /// Returns the solution, and what it leaves of the right-hand side.
    pub(super) fn solve(&self, unknowns: &Unknowns) -> Result<(Vec<f64>, f64), FitError> {
        if self.right.is_empty() {
            return Ok((Vec::new(), 0.0));
        }
        let ordering = Ordering::given(self.order.clone());
        let symbolic = Symbolic::analyze(&self.matrix, &ordering);
        let factor = Cholesky::factor(symbolic, &self.matrix).map_err(|source| {
            let vertex = match source {
                msplines_common::linalg::FactorError::NotPositiveDefinite { row } => {
                    unknowns.starts.partition_point(|&s| s as usize <= row) - 1
                }
                _ => 0,
            };
            FitError::Factor {
                vertex: vertex as u32,
                source,
            }
        })?;
        let size = self.right.len();
        let mut x = Mat::from_fn(size, 1, |i, _| self.right[i]);
        factor.solve_in_place(x.as_mut());
        // One step of refinement: the condition number costs digits that are cheap to get back.
        let mut left = self.left(&x);
        factor.solve_in_place(left.as_mut());
        x += &left;
        let left = self.left(&x);
        let largest =
            |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, |m, v| m.max(v.abs()));
        let due = largest(&mut self.right.iter().copied());
        let rest = largest(&mut (0..size).map(|i| left[(i, 0)]));
        let residual = if due > 0.0 { rest / due } else { rest };
        Ok(((0..size).map(|i| x[(i, 0)]).collect(), residual))
    }

    fn left(&self, x: &Mat<f64>) -> Mat<f64> {
        let product = self.matrix.multiply(x.as_ref());
        Mat::from_fn(self.right.len(), 1, |i, _| self.right[i] - product[(i, 0)])
    }
}

/// Returns the unknowns in the order of a nested dissection of their vertices: the graph of vertices
/// has sixteen times fewer entries.
fn order(domain: &FlatDomain, unknowns: &Unknowns, active: &[u32]) -> Result<Vec<u32>, FitError> {
    let mut places = vec![u32::MAX; domain.mesh().vertex_count()];
    for (place, &vertex) in active.iter().enumerate() {
        places[vertex as usize] = place as u32;
    }
    let mut entries = Vec::new();
    for (place, &vertex) in active.iter().enumerate() {
        entries.push((place as u32, place as u32, 1.0));
        let others = domain.topology().neighbours(vertex);
        let others = others.map(|other| places[other as usize]);
        entries.extend(
            others
                .filter(|&other| other < place as u32)
                .map(|other| (place as u32, other, 1.0)),
        );
    }
    let graph = SymmetricMatrix::from_lower_triplets(active.len(), &entries);
    let ordering = Ordering::nested_dissection(&graph)?;
    let vertices = ordering
        .as_slice()
        .iter()
        .map(|&place| active[place as usize]);
    Ok(vertices
        .flat_map(|vertex| unknowns.range(vertex))
        .map(|k| k as u32)
        .collect())
}

fn rows(vertices: &[u32], stiffness: &Stiffness<'_>, unknowns: &Unknowns) -> Rows {
    let (mut triplets, mut right) = (Vec::new(), Vec::new());
    for &vertex in vertices {
        let own = unknowns.range(vertex);
        let mut sums = vec![0.0; own.len()];
        let here = unknowns.base[vertex as usize][0];
        for (other, block) in stiffness.blocks(vertex) {
            // The energy does not see constants: positions relative to this vertex keep digits.
            let mut base = unknowns.base[other as usize];
            (0..3).for_each(|c| base[0][c] -= here[c]);
            let force = apply(&block, &base);
            for (k, sum) in own.clone().zip(&mut sums) {
                *sum -= product(&unknowns.columns[k], &force);
            }
            for column in unknowns.range(other) {
                let force = apply(&block, &unknowns.columns[column]);
                for row in own.clone().filter(|&row| row >= column) {
                    let value = product(&unknowns.columns[row], &force);
                    triplets.push((row as u32, column as u32, value));
                }
            }
        }
        right.extend(sums);
    }
    (triplets, right)
}

fn apply(block: &Block, numbers: &Numbers) -> Numbers {
    block.map(|row| {
        std::array::from_fn(|c| {
            row[0] * numbers[0][c] + row[1] * numbers[1][c] + row[2] * numbers[2][c]
        })
    })
}

fn product(a: &Numbers, b: &Numbers) -> f64 {
    a.iter()
        .flatten()
        .zip(b.iter().flatten())
        .map(|(a, b)| a * b)
        .sum()
}
