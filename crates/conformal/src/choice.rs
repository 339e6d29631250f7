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

use nalgebra::{Cholesky, DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::basis::HolomorphicBasis;
use crate::error::ConformalError;
use crate::uniformity::Uniformity;

/// Random forms that searches start from: together, for one handle, and at least and at most.
///
/// Up to genus 6 all of a dozen come within some percent of the best; more handles leave each search
/// more ways to go.
const STARTS: (usize, usize, usize) = (64, 3, 12);

/// Largest entry of the integer classes that a search tries first.
const LARGEST_ENTRY: i32 = 3;

/// Directions of a form that are rounded to integer classes.
const DIRECTIONS: u32 = 24;

/// Integer classes that are improved entry by entry.
const CLIMBERS: usize = 6;

/// Which form to take of all those of a surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FormChoice {
    /// The form of most even length that a search from seeded starts finds.
    Optimal {
        /// Seed of the starts.
        seed: u64,
    },
    /// The most even form among those whose imaginary part has small integer periods, so that all
    /// its horizontal trajectories are closed.
    Integer {
        /// Seed of the starts.
        seed: u64,
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
}

impl FormChoice {
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
            Self::Integer { seed } => Ok(integer(basis, *seed)),
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
                Ok(vec![from_imaginary(basis, imaginary)])
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
                from_imaginary(basis, form.imaginary.clone())
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
    let imaginary = basis.conjugate(&real);
    let log_variance = Uniformity::sample(basis).variance(&real);
    HolomorphicForm {
        real,
        imaginary,
        log_variance,
    }
}

/// The form with this imaginary part; its real part is minus the conjugate.
fn from_imaginary(basis: &HolomorphicBasis, imaginary: DVector<f64>) -> HolomorphicForm {
    let real = -basis.conjugate(&imaginary);
    let log_variance = Uniformity::sample(basis).variance(&real);
    HolomorphicForm {
        real,
        imaginary,
        log_variance,
    }
}

/// Forms of locally least variance, best first.
fn optimal(basis: &HolomorphicBasis, seed: u64) -> Vec<HolomorphicForm> {
    let measure = Uniformity::sample(basis);
    minima(basis, &measure, seed)
        .into_iter()
        .map(|(log_variance, real)| HolomorphicForm {
            imaginary: basis.conjugate(&real),
            real,
            log_variance,
        })
        .collect()
}

fn minima(basis: &HolomorphicBasis, measure: &Uniformity, seed: u64) -> Vec<(f64, DVector<f64>)> {
    let classes = basis.classes();
    let root = Cholesky::new(basis.gram().clone()).map_or_else(
        || DMatrix::identity(classes, classes),
        |factor| factor.l().transpose(),
    );
    let to_coefficients = root
        .clone()
        .try_inverse()
        .unwrap_or_else(|| DMatrix::identity(classes, classes));
    let whitened = measure.in_basis(&to_coefficients);
    // One complex dimension: all forms are rotations and multiples of one.
    let starts = match basis.genus() {
        1 => 1,
        handles => (STARTS.0 / handles).clamp(STARTS.1, STARTS.2),
    };
    let mut found: Vec<(f64, DVector<f64>)> = (0..starts)
        .into_par_iter()
        .map(|start| {
            let mut random = Pcg64Mcg::seed_from_u64(seed.wrapping_add(start as u64));
            let entry = |_, _| random.random::<f64>() - 0.5;
            let (value, x) = whitened.minimise(&DVector::from_fn(classes, entry));
            (value, &to_coefficients * x)
        })
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found
}

/// Forms with an integer imaginary part, best first.
fn integer(basis: &HolomorphicBasis, seed: u64) -> Vec<HolomorphicForm> {
    let measure = Uniformity::sample(basis);
    let cost = |class: &[i64]| {
        let n = DVector::from_iterator(class.len(), class.iter().map(|&n| n as f64));
        measure.variance(&-basis.conjugate(&n))
    };
    let mut tried: Vec<Vec<i64>> = Vec::new();
    for (_, real) in minima(basis, &measure, seed) {
        let imaginary = basis.conjugate(&real);
        for direction in 0..DIRECTIONS {
            let (sin, cos) =
                (f64::from(direction) * std::f64::consts::PI / f64::from(DIRECTIONS)).sin_cos();
            let turned = &imaginary * cos + &real * sin;
            let scale = turned.amax();
            tried.extend((1..=LARGEST_ENTRY).map(|largest| {
                let rounded = turned
                    .iter()
                    .map(|v| (v / scale * f64::from(largest)).round());
                primitive(rounded.map(|v| v as i64).collect()).0
            }));
        }
    }
    tried.sort_unstable();
    tried.dedup();
    let mut ranked: Vec<(f64, Vec<i64>)> = tried
        .into_par_iter()
        .map(|class| (cost(&class), class))
        .collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    ranked.truncate(CLIMBERS);
    let mut climbed: Vec<(f64, Vec<i64>)> = ranked
        .into_par_iter()
        .map(|start| climb(start, cost))
        .collect();
    climbed.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
    climbed.dedup_by(|a, b| a.1 == b.1);
    climbed
        .into_iter()
        .map(|(log_variance, class)| {
            let entries = class.iter().map(|&n| n as f64);
            let imaginary = DVector::from_iterator(class.len(), entries);
            HolomorphicForm {
                real: -basis.conjugate(&imaginary),
                imaginary,
                log_variance,
            }
        })
        .collect()
}

/// Changes one entry by one while that helps.
fn climb(start: (f64, Vec<i64>), cost: impl Fn(&[i64]) -> f64) -> (f64, Vec<i64>) {
    let (mut best, mut class) = start;
    loop {
        let before = best;
        for entry in 0..class.len() {
            for step in [-1, 1] {
                let mut changed = class.clone();
                changed[entry] += step;
                if changed.iter().all(|&n| n == 0) {
                    continue;
                }
                let value = cost(&changed);
                if value < best {
                    (best, class) = (value, changed);
                }
            }
        }
        if best >= before {
            return (best, primitive(class).0);
        }
    }
}

/// Divides a class by the greatest common divisor of its entries, and returns that too.
pub(crate) fn primitive(class: Vec<i64>) -> (Vec<i64>, i64) {
    let divisors = class
        .iter()
        .fold(0, |a, &b| greatest_common_divisor(a, b.abs()));
    let divisor = divisors.max(1);
    (class.into_iter().map(|n| n / divisor).collect(), divisor)
}

fn greatest_common_divisor(a: i64, b: i64) -> i64 {
    if b == 0 {
        a
    } else {
        greatest_common_divisor(b, a % b)
    }
}
