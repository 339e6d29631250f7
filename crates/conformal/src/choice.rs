//! Which holomorphic form to take: the more even its length, the better everything that follows.
//!
//! A form supported on one handle decays exponentially over the others, below the error of the
//! discretisation. So by default the area-weighted variance of `log |ω|` is minimised over all forms,
//! from several seeded starts.
//!
//! # Notation
//! `p_k = (H_k)_z` complex derivatives of the harmonic forms on a face; `q_k = p_k + i Σ_j C_jk p_j`,
//! so that `ω_z = Σ a_k q_k`; `G = R Rᵀ`, `a = R⁻ᵀ x` with `|x| = 1`.
//!
//! # Reference
//! [Jin2004] §4 asks for uniform forms. Deviation: the variance of `log |ω|` is minimised, not the
//! integral of `|ω|⁴`, see docs/papers/he2005.md.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use crate::basis::HolomorphicBasis;
use crate::classes::{ClassObjective, even_forms, integer_forms};
use crate::error::ConformalError;
use crate::uniformity::Uniformity;

/// Random forms that searches start from: together, for one handle, and at least and at most.
///
/// Up to genus 6 all of a dozen come within some percent of the best; more handles leave each search
/// more ways to go.
const STARTS: (usize, usize, usize) = (64, 3, 12);

/// Which form to take of all those of a surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FormChoice {
    /// The form of most even length that a search from seeded starts finds.
    Optimal {
        /// Seed of the starts.
        seed: u64,
    },
    /// The most even and shortest forms among those whose imaginary part has integer periods, so that
    /// all its horizontal trajectories are closed.
    Integer {
        /// Seed of the starts.
        seed: u64,
        /// What classes are compared by.
        #[serde(default)]
        objective: ClassObjective,
    },
    /// The form whose real part has these coefficients in the harmonic basis, 2g of them.
    Coefficients(Vec<f64>),
    /// The form whose real part has these periods over the loops of the homology, 2g of them.
    Periods(Vec<f64>),
    /// The form whose imaginary part has these integer periods over the loops of the homology.
    IntegerPeriods(Vec<i64>),
}

impl Default for FormChoice {
    fn default() -> Self {
        Self::Optimal { seed: 0 }
    }
}

/// The coefficients of a holomorphic form in the harmonic basis.
#[derive(Clone, Debug, PartialEq)]
pub struct HolomorphicForm {
    /// Coefficients of the real part.
    pub real: DVector<f64>,
    /// Coefficients of the imaginary part.
    pub imaginary: DVector<f64>,
    /// Area-weighted variance of `log |ω|`; 0 for a form of constant length.
    pub log_variance: f64,
    /// `∫ |ω|²`: the area of the surface measured by the form.
    pub energy: f64,
}

impl FormChoice {
    /// Returns the choice of integer periods by the usual objective.
    #[must_use]
    pub fn integer(seed: u64) -> Self {
        Self::Integer {
            seed,
            objective: ClassObjective::default(),
        }
    }

    /// Returns forms in the order in which they should be tried; one where the choice leaves none.
    ///
    /// # Errors
    /// Numbers that are not one for each class, or all zero.
    pub fn candidates(
        &self,
        basis: &HolomorphicBasis,
    ) -> Result<Vec<HolomorphicForm>, ConformalError> {
        match self {
            Self::Optimal { seed } => Ok(optimal(basis, *seed)),
            Self::Integer { seed, objective } => Ok(integer(basis, *objective, *seed)),
            Self::Coefficients(given) => {
                let real = checked(basis, given.clone())?;
                Ok(vec![from_real(basis, real)])
            }
            Self::Periods(given) => {
                let periods = checked(basis, given.clone())?;
                Ok(vec![from_real(basis, with_periods(basis, &periods)?)])
            }
            Self::IntegerPeriods(given) => {
                let periods = checked(basis, given.iter().map(|&n| n as f64).collect())?;
                let imaginary = with_periods(basis, &periods)?.map(f64::round);
                Ok(vec![from_imaginary(
                    basis,
                    &Uniformity::sample(basis),
                    imaginary,
                )])
            }
        }
    }
}

impl FormChoice {
    /// Whether the choice leaves one form only.
    pub(crate) fn is_given(&self) -> bool {
        match self {
            Self::Optimal { .. } | Self::Integer { .. } => false,
            Self::Coefficients(_) | Self::Periods(_) | Self::IntegerPeriods(_) => true,
        }
    }

    /// Returns the form of the same class over the basis of a mesh that was split or relaxed.
    pub(crate) fn carried(
        &self,
        form: &HolomorphicForm,
        basis: &HolomorphicBasis,
    ) -> HolomorphicForm {
        match self {
            Self::Integer { .. } | Self::IntegerPeriods(_) => {
                from_imaginary(basis, &Uniformity::sample(basis), form.imaginary.clone())
            }
            Self::Optimal { .. } | Self::Coefficients(_) | Self::Periods(_) => {
                from_real(basis, form.real.clone())
            }
        }
    }
}

fn checked(basis: &HolomorphicBasis, given: Vec<f64>) -> Result<DVector<f64>, ConformalError> {
    if given.len() != basis.classes() || given.iter().any(|value| !value.is_finite()) {
        return Err(ConformalError::ClassCount {
            given: given.iter().filter(|value| value.is_finite()).count(),
            needed: basis.classes(),
            genus: basis.genus(),
        });
    }
    if given.iter().all(|&value| value == 0.0) {
        return Err(ConformalError::ZeroForm);
    }
    Ok(DVector::from_vec(given))
}

/// Coefficients of the closed form with these periods over the loops.
fn with_periods(
    basis: &HolomorphicBasis,
    periods: &DVector<f64>,
) -> Result<DVector<f64>, ConformalError> {
    let rows = basis.homology().integer_periods();
    let classes = basis.classes();
    let matrix = DMatrix::from_fn(classes, classes, |i, j| rows[i][j] as f64);
    let factors = matrix.lu();
    let determinant = factors.determinant();
    factors.solve(periods).ok_or(ConformalError::Intersections {
        classes,
        determinant,
    })
}

fn from_real(basis: &HolomorphicBasis, real: DVector<f64>) -> HolomorphicForm {
    HolomorphicForm {
        imaginary: basis.conjugate(&real),
        log_variance: Uniformity::sample(basis).variance(&real),
        energy: energy(basis, &real),
        real,
    }
}

/// The form with this imaginary part; its real part is minus the conjugate.
fn from_imaginary(
    basis: &HolomorphicBasis,
    measure: &Uniformity,
    imaginary: DVector<f64>,
) -> HolomorphicForm {
    let real = -basis.conjugate(&imaginary);
    HolomorphicForm {
        log_variance: measure.variance(&real),
        energy: energy(basis, &imaginary),
        real,
        imaginary,
    }
}

/// `∫ |ω|²` from the coefficients of either part of a form.
fn energy(basis: &HolomorphicBasis, part: &DVector<f64>) -> f64 {
    part.dot(&(basis.gram() * part))
}

/// Random forms that searches start from. All forms of a torus are rotations and multiples of one.
fn starts(basis: &HolomorphicBasis) -> usize {
    match basis.genus() {
        1 => 1,
        handles => (STARTS.0 / handles).clamp(STARTS.1, STARTS.2),
    }
}

/// Forms of locally least variance, best first.
fn optimal(basis: &HolomorphicBasis, seed: u64) -> Vec<HolomorphicForm> {
    let measure = Uniformity::sample(basis);
    even_forms(&measure, basis.gram(), seed, starts(basis))
        .into_iter()
        .map(|(log_variance, real)| HolomorphicForm {
            imaginary: basis.conjugate(&real),
            energy: energy(basis, &real),
            real,
            log_variance,
        })
        .collect()
}

/// Forms with an integer imaginary part, best first.
fn integer(basis: &HolomorphicBasis, objective: ClassObjective, seed: u64) -> Vec<HolomorphicForm> {
    let measure = Uniformity::sample(basis);
    let found = integer_forms(basis, objective, seed, starts(basis));
    found
        .into_iter()
        .map(|imaginary| from_imaginary(basis, &measure, imaginary))
        .collect()
}
