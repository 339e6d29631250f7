//! The least-squares problem on a T-mesh: assembled leaf by leaf, factored as one system.
//!
//! # Notation
//! `B` rows of the rational basis at the samples, `W` their weights, `K` the fairness; the unknowns `x`
//! minimise `|B x - p|²_W + λ xᵀ K x`. With `D` the roots of the diagonal, `D⁻¹ (Bᵀ W B + λ K) D⁻¹` is
//! factored: coefficients of caps and control points are of different sizes.
//!
//! On a leaf the same functions meet all samples, so that their products are collected in a small dense
//! matrix, and its entries have a fixed place in the large one.
//!
//! # Reference
//! [He2006] Eq. (3).

use msplines_common::Vector3;
use msplines_common::linalg::{
    CgTolerance, Cholesky, FactorError, Mat, Ordering, OrderingError, Symbolic, SymmetricMatrix,
    conjugate_gradient,
};
use rayon::prelude::*;

use super::fairness::{self, Weights};
use super::samples::Sorted;
use crate::complex::Point;
use crate::options::Solver;
use crate::space::{Row, Rows, TSplineSpace};

/// What is added to the scaled diagonal, all ones: enough to make functions that nothing holds zero.
const RIDGE: f64 = 1e-11;
/// The equations of one T-mesh.
pub(super) struct System {
    /// Unknowns on each leaf, ascending.
    unknowns: Vec<Vec<u32>>,
    /// For each leaf, where the lower triangle of its dense matrix goes: both halves.
    places: Vec<Vec<[u32; 2]>>,
    /// The fairness, and a zero wherever there may be more.
    fair: SymmetricMatrix,
    matrix: SymmetricMatrix,
    factor: Option<Cholesky>,
}

/// A dense matrix over the unknowns of a leaf, lower triangle by rows, and right-hand sides.
struct Local {
    matrix: Vec<f64>,
    right: Vec<Vector3<f64>>,
    /// The row that is added: places among the unknowns of the leaf, and numbers.
    places: Vec<(usize, f64)>,
}

impl System {
    /// Lays out the equations of a space, with the fairness in it.
    pub(super) fn build(space: &TSplineSpace, sorted: &Sorted, rows: &Rows, fairness: f64) -> Self {
        let leaves = space.mesh().leaves().len();
        let gauss = fairness::gauss_points(space);
        let plates = space.rows_without_caps(&gauss.iter().map(|g| g.0).collect::<Vec<_>>());
        let unknowns: Vec<Vec<u32>> = (0..leaves)
            .into_par_iter()
            .map(|leaf| {
                let mut found: Vec<u32> = space.functions_on(leaf as u32).collect();
                let seen = sorted.on(leaf).flat_map(|i| rows.row(i).unknowns);
                found.extend(seen);
                found.sort_unstable();
                found.dedup();
                found
            })
            .collect();
        let caps = cap_unknowns(space);
        let entries: Vec<(u32, u32, f64)> = (unknowns.iter().chain(&caps))
            .flat_map(|list| pairs(list).map(|[row, column]| (row, column, 0.0)))
            .collect();
        let empty =
            SymmetricMatrix::from_lower_triplets(space.unknowns(), &with_diagonal(entries, space));
        let places = unknowns
            .par_iter()
            .map(|list| {
                let place = |row, column| empty.place(row, column).unwrap_or(0) as u32;
                let pairs = pairs(list);
                pairs.map(|[i, j]| [place(i, j), place(j, i)]).collect()
            })
            .collect();
        let mut system = Self {
            unknowns,
            places,
            matrix: empty.clone(),
            fair: empty,
            factor: None,
        };
        let weights = Weights::new(space, sorted, fairness);
        system.add_plates(&gauss, &plates, &weights.leaves);
        for ((cap, list), weight) in space.caps().caps().iter().zip(&caps).zip(weights.caps) {
            system
                .fair
                .add_to_entries(&fairness::of_cap(cap.degree, list, weight));
        }
        system
    }

    /// Whether all unknowns of rows have a place.
    pub(super) fn holds(&self, sorted: &Sorted, rows: &Rows) -> bool {
        (0..self.unknowns.len()).into_par_iter().all(|leaf| {
            let list = &self.unknowns[leaf];
            let mut seen = sorted.on(leaf).flat_map(|i| rows.row(i).unknowns);
            seen.all(|unknown| list.binary_search(unknown).is_ok())
        })
    }

    fn add_plates(&mut self, gauss: &[(Point, u32, [f64; 2])], rows: &Rows, weights: &[f64]) {
        let mut locals: Vec<Local> = self.unknowns.iter().map(|l| Local::zero(l.len())).collect();
        for (i, &(_, leaf, [w, h])) in gauss.iter().enumerate() {
            let (row, list) = (rows.row(i), &self.unknowns[leaf as usize]);
            let weight = 0.25 * weights[leaf as usize];
            let scales = [w * w, w * h * std::f64::consts::SQRT_2, h * h];
            for (k, scale) in scales.into_iter().enumerate() {
                let entry = |j: usize| scale * row.second[j][k];
                locals[leaf as usize].add(list, &row, entry, weight, None);
            }
        }
        scatter(self.fair.values_mut(), &self.places, &locals);
    }

    /// Returns the unknowns that fit the samples best.
    ///
    /// # Errors
    /// A system that is not definite in spite of the ridge: numbers that are none.
    pub(super) fn solve(
        &mut self,
        sorted: &Sorted,
        rows: &Rows,
        solver: Solver,
    ) -> Result<Vec<Vector3<f64>>, SolveError> {
        let locals: Vec<Local> = (0..self.unknowns.len())
            .into_par_iter()
            .map(|leaf| {
                let list = &self.unknowns[leaf];
                let mut local = Local::zero(list.len());
                for i in sorted.on(leaf) {
                    let (row, sample) = (rows.row(i), &sorted.samples[i]);
                    let due = Some(sample.position.coords);
                    local.add(list, &row, |j| row.values[j], sample.weight, due);
                }
                local
            })
            .collect();
        let mut right = vec![Vector3::zeros(); self.matrix.size()];
        for (list, local) in self.unknowns.iter().zip(&locals) {
            for (&unknown, value) in list.iter().zip(&local.right) {
                right[unknown as usize] += value;
            }
        }
        let values = self.matrix.values_mut();
        values.copy_from_slice(self.fair.values());
        scatter(values, &self.places, &locals);
        let scales = self.scale();
        let mut x = Mat::from_fn(right.len(), 3, |i, c| scales[i] * right[i][c]);
        match solver {
            Solver::Factorisation => self.factored()?.solve_in_place(x.as_mut()),
            Solver::ConjugateGradients { tolerance, steps } => {
                x = self.iterated(&x, tolerance, steps)?;
            }
        }
        let scaled = scales.iter().enumerate();
        Ok(scaled
            .map(|(i, s)| Vector3::from_fn(|c, _| s * x[(i, c)]))
            .collect())
    }

    /// Scales the matrix to a diagonal of ones and adds the ridge; returns the scales.
    fn scale(&mut self) -> Vec<f64> {
        let scales: Vec<f64> = self
            .matrix
            .diagonal()
            .iter()
            .map(|d| if *d > 0.0 { 1.0 / d.sqrt() } else { 1.0 })
            .collect();
        let starts = self.matrix.starts().to_vec();
        let rows = self.matrix.rows().to_vec();
        let values = self.matrix.values_mut();
        for column in 0..scales.len() {
            for at in starts[column]..starts[column + 1] {
                values[at] *= scales[column] * scales[rows[at] as usize];
                if rows[at] as usize == column {
                    values[at] += RIDGE;
                }
            }
        }
        scales
    }

    fn factored(&mut self) -> Result<&Cholesky, SolveError> {
        let factor = match self.factor.take() {
            Some(mut factor) => {
                factor.refactor(&self.matrix)?;
                factor
            }
            None => {
                let ordering = Ordering::nested_dissection(&self.matrix)?;
                let symbolic = Symbolic::analyze(&self.matrix, &ordering);
                Cholesky::factor(symbolic, &self.matrix)?
            }
        };
        Ok(self.factor.insert(factor))
    }

    fn iterated(
        &self,
        right: &Mat<f64>,
        tolerance: f64,
        steps: u32,
    ) -> Result<Mat<f64>, SolveError> {
        let mut x = Mat::zeros(right.nrows(), right.ncols());
        let report = conjugate_gradient(
            |x| self.matrix.multiply(x),
            |x| x.to_owned(),
            |_| {},
            right.as_ref(),
            &mut x,
            CgTolerance::Relative(tolerance),
            steps,
        );
        if report.converged {
            Ok(x)
        } else {
            Err(SolveError::Steps {
                steps,
                residual: report.residual,
            })
        }
    }
}

/// Why a system has no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum SolveError {
    #[error(
        "after {steps} steps of conjugate gradients the residual is still {residual:.1e} of the right-hand side; \
         allow more steps or a larger residual, or factor the system"
    )]
    Steps { steps: u32, residual: f64 },
    #[error(transparent)]
    Factor(#[from] FactorError),
    #[error(transparent)]
    Ordering(#[from] OrderingError),
}

impl Local {
    fn zero(size: usize) -> Self {
        Self {
            matrix: vec![0.0; size * (size + 1) / 2],
            right: vec![Vector3::zeros(); size],
            places: Vec::with_capacity(size),
        }
    }

    /// Adds the square of a row, `entry` its numbers, and its right-hand side.
    #[inline]
    fn add(
        &mut self,
        list: &[u32],
        row: &Row<'_>,
        entry: impl Fn(usize) -> f64,
        weight: f64,
        due: Option<Vector3<f64>>,
    ) {
        let places = &mut self.places;
        places.clear();
        let mut from = 0;
        for (j, unknown) in row.unknowns.iter().enumerate() {
            from += list[from..].iter().position(|u| u == unknown).unwrap_or(0);
            match places.last_mut() {
                // Images of one function stand side by side.
                Some((place, sum)) if *place == from => *sum += entry(j),
                _ => places.push((from, entry(j))),
            }
        }
        for (i, &(place, value)) in places.iter().enumerate() {
            let factor = weight * value;
            let line = &mut self.matrix[place * (place + 1) / 2..];
            for &(other, entry) in &places[..=i] {
                line[other] += factor * entry;
            }
            if let Some(due) = due {
                self.right[place] += factor * due;
            }
        }
    }
}

/// Returns the lower triangle of a list with itself, by rows.
fn pairs(list: &[u32]) -> impl Iterator<Item = [u32; 2]> + '_ {
    let rows = list.iter().enumerate();
    rows.flat_map(|(i, &row)| list[..=i].iter().map(move |&column| [row, column]))
}

fn with_diagonal(mut pairs: Vec<(u32, u32, f64)>, space: &TSplineSpace) -> Vec<(u32, u32, f64)> {
    pairs.extend((0..space.unknowns() as u32).map(|i| (i, i, 0.0)));
    pairs
}

fn scatter(values: &mut [f64], places: &[Vec<[u32; 2]>], locals: &[Local]) {
    for (places, local) in places.iter().zip(locals) {
        for (&[one, other], value) in places.iter().zip(&local.matrix) {
            values[one as usize] += value;
            if one != other {
                values[other as usize] += value;
            }
        }
    }
}

/// Returns the coefficients of each cap.
fn cap_unknowns(space: &TSplineSpace) -> Vec<Vec<u32>> {
    let caps = space.caps().caps().iter();
    let from = |offset: u32| space.functions().len() as u32 + offset;
    caps.map(|cap| (from(cap.offset)..from(cap.offset) + cap.coefficients() as u32).collect())
        .collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use msplines_common::evaluate::Order;
    use msplines_common::mesh::shapes;
    use msplines_common::progress::unobserved;

    use super::*;
    use crate::caps::CapOptions;
    use crate::domain::{Domain, DomainOptions};
    use crate::options::{Sampling, Stop};
    use crate::tmesh::{Grid, TMesh};

    /// The fairness is symmetric, and zero for surfaces that are one point, but for nothing else of caps
    /// that bends.
    #[test]
    fn the_fairness_is_that_of_bends() {
        let mesh = shapes::sphere(900);
        let options = DomainOptions {
            poles: vec![0, 400, 800],
            ..DomainOptions::default()
        };
        let domain = Domain::of_surface(&mesh, &options, &mut unobserved()).expect("a domain");
        let complex = Arc::new(domain.complex().clone());
        let grids: Vec<Grid> = (complex.cylinders().iter())
            .map(|cylinder| Grid::of_cells(cylinder, 30.0, 1.0))
            .collect();
        let samples = Sampling::default().samples(&domain, &mesh, Stop::ControlPoints(400));
        let mesh = TMesh::build(&complex, &grids).expect("a mesh");
        let sorted = Sorted::new(&samples.expect("samples"), &mesh);
        let space = TSplineSpace::build(mesh, &CapOptions::default()).expect("a space");
        let rows = space.rows(&sorted.points, Order::Value);
        let fair = System::build(&space, &sorted, &rows, 1.0).fair;
        let functions = space.functions().len();
        for column in 0..fair.size() {
            for (row, value) in fair.column(column) {
                let twin = fair.place(column as u32, row as u32).expect("both halves");
                assert_eq!(value, fair.values()[twin], "{row} {column}");
            }
        }
        let energy = |control: &[f64]| -> f64 {
            let columns = (0..fair.size()).map(|c| {
                let products = fair.column(c).map(|(row, value)| value * control[row]);
                control[c] * products.sum::<f64>()
            });
            columns.sum()
        };
        let mut one = vec![0.0; fair.size()];
        one[..functions].fill(1.0);
        for cap in space.caps().caps() {
            let from = functions + cap.offset as usize;
            one[from] = 1.0;
            let scale: f64 = fair.diagonal().iter().sum();
            assert!(energy(&one).abs() < 1e-12 * scale, "{}", energy(&one));
            for place in 0..cap.coefficients() {
                let mut monomial = vec![0.0; fair.size()];
                monomial[from + place] = 1.0;
                // The first three are constant and linear.
                assert_eq!(energy(&monomial) > 0.0, place > 2, "{place}");
            }
        }
    }
}
