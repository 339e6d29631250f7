//! Which integer periods the imaginary part of a form has: those of an even and short form.
//!
//! Forms of integer classes are dense among all forms, so that evenness alone is met best by classes
//! that wind round many times: their level lines are long and close together. The energy tells these.
//!
//! # Notation
//! `x` coordinates of a form: integers by a short basis of the classes, then real ones. `E = xᵀ G x` its
//! energy `∫ |ω|²`, in units of the period of the imaginary part. Cost: `Var log |ω| + w log E`.

mod reduction;
mod search;
mod space;

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

pub(crate) use search::{even_forms, rank};
pub(crate) use space::ClassSpace;

use crate::basis::HolomorphicBasis;
use crate::uniformity::Uniformity;
use reduction::reduced;

/// What forms of integer classes are compared by: `log_variance + energy * ln(∫ |ω|²)`.
///
/// The level lines of a form with period 1 are `∫ |ω|²` long in the mean, measured by the form, on a
/// surface whose size is the root of that: so their number side by side is the root of the energy too.
/// Whoever knows the levels of the zeros adds a cost of his own to the best few candidates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ClassObjective {
    /// Weight of the logarithm of the energy against the variance of `log |ω|`; with 0, classes win that
    /// wind round five or ten times.
    pub energy: f64,
}

impl Default for ClassObjective {
    fn default() -> Self {
        Self { energy: 0.06 }
    }
}

impl ClassObjective {
    /// Returns the cost of a form: less is better.
    #[must_use]
    pub fn cost(&self, log_variance: f64, energy: f64) -> f64 {
        log_variance + self.energy * energy.ln()
    }
}

/// Returns the forms of a closed surface with integer periods that cost least, best first, as
/// coefficients of their imaginary parts.
pub(crate) fn integer_forms(
    basis: &HolomorphicBasis,
    objective: ClassObjective,
    seed: u64,
    starts: usize,
) -> Vec<DVector<f64>> {
    let lift = reduced(basis.gram());
    let inverse = lift.clone().try_inverse();
    let turn = inverse.map(|inverse| inverse * basis.conjugation() * &lift);
    let measure = Uniformity::sample(basis).in_basis(&(-basis.conjugation() * &lift));
    let space = ClassSpace {
        gram: lift.transpose() * basis.gram() * &lift,
        classes: basis.classes(),
        levels: DMatrix::zeros(0, basis.classes()),
        turn,
        objective,
    };
    let ranked = rank(&space, &measure, seed, starts);
    ranked
        .into_iter()
        .map(|x| (&lift * x).map(f64::round))
        .collect()
}

/// Returns a short basis of the classes of forms with holes that have no flux there, and the forms of one
/// flux each, as columns of coefficients of the imaginary part.
pub(crate) fn lift_with_holes(
    gram: &DMatrix<f64>,
    handles: usize,
    with_fluxes: impl Fn(&[i64], &[f64]) -> Option<DVector<f64>>,
) -> Option<DMatrix<f64>> {
    let holes = gram.nrows() - handles;
    let none = vec![0.0; holes];
    let mut columns = Vec::new();
    let unit = |k: usize| (0..handles).map(move |i| i64::from(i == k));
    for k in 0..handles {
        columns.push(with_fluxes(&unit(k).collect::<Vec<_>>(), &none)?);
    }
    let closed = DMatrix::from_fn(gram.nrows(), handles, |i, k| columns[k][i]);
    let short = &closed * reduced(&(closed.transpose() * gram * &closed));
    let mut columns: Vec<DVector<f64>> = short.column_iter().map(|c| c.into_owned()).collect();
    for hole in 0..holes {
        let mut one = none.clone();
        one[hole] = 1.0;
        columns.push(with_fluxes(&vec![0; handles], &one)?);
    }
    Some(DMatrix::from_columns(&columns))
}
