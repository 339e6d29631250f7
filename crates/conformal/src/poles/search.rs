//! Which class and which fluxes: those of the form that costs least.

use nalgebra::DVector;
use rayon::prelude::*;

use super::basis::PoledBasis;
use crate::classes::{ClassObjective, ClassSpace, lift_with_holes, rank};

/// Least flux of a hole, over the largest one. A hole with less swallows a zero on its own loop.
pub(super) const LEAST_FLUX: f64 = 0.25;

/// Fluxes below the least one are raised to this share, so that balancing them leaves enough.
const RAISED_FLUX: f64 = 0.3;

/// Rounds in which fluxes are raised and balanced.
const BALANCES: usize = 20;

/// What the flux of a hole whose own form is too uneven is multiplied by. A zero lies at a distance from
/// a hole that is proportional to its flux.
const STEP: f64 = 1.4;

/// Rounds in which fluxes of holes are multiplied: by a thousand at most.
const STEPS: usize = 20;

/// Random forms that searches start from.
const STARTS: usize = 12;

/// A form by its class and its integrals around the holes.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    pub(super) class: Vec<i64>,
    /// One for each hole; they sum to zero.
    pub(super) fluxes: Vec<f64>,
    pub(super) imaginary: DVector<f64>,
    pub(super) log_variance: f64,
}

/// Returns the form with this class and these integrals around all holes.
pub(super) fn given(basis: &PoledBasis, class: &[i64], fluxes: &[f64]) -> Option<Candidate> {
    let imaginary = basis.with_fluxes(class, &fluxes[1..])?;
    Some(Candidate {
        class: class.to_vec(),
        fluxes: fluxes.to_vec(),
        log_variance: basis.uniformity().variance(&imaginary),
        imaginary,
    })
}

/// Returns the forms that cost least, best first; none of their fluxes is too small.
pub(super) fn best(basis: &PoledBasis, objective: ClassObjective, seed: u64) -> Vec<Candidate> {
    let handles = 2 * basis.genus();
    let with_fluxes = |class: &[i64], fluxes: &[f64]| basis.with_fluxes(class, fluxes);
    let Some(lift) = lift_with_holes(basis.gram(), handles, with_fluxes) else {
        return Vec::new();
    };
    let space = ClassSpace {
        gram: lift.transpose() * basis.gram() * &lift,
        classes: handles,
        levels: lift.rows(handles, basis.classes() - handles).into_owned(),
        turn: None,
        objective,
    };
    let measure = basis.uniformity();
    let ranked = rank(&space, &measure.in_basis(&lift), seed, STARTS);
    let Some(inverse) = lift.clone().try_inverse() else {
        return Vec::new();
    };
    let enough = |x: &DVector<f64>| {
        let class = lift.view((0, 0), (handles, handles)) * x.rows(0, handles);
        let class = class.iter().map(|n| n.round() as i64).collect();
        let fluxes = x.rows(handles, x.len() - handles);
        let found = with_enough_flux(basis, class, fluxes.iter().copied())?;
        let log_variance = measure.variance(&found.imaginary);
        let cost = log_variance + space.cost_of_energy_of(&(&inverse * &found.imaginary));
        let found = Candidate {
            log_variance,
            ..found
        };
        Some((cost, found))
    };
    let mut found: Vec<(f64, Candidate)> = ranked.par_iter().filter_map(enough).collect();
    found.sort_by(|a, b| {
        let costs = a.0.total_cmp(&b.0);
        costs.then_with(|| a.1.class.cmp(&b.1.class))
    });
    found.into_iter().map(|(_, candidate)| candidate).collect()
}

/// The form of a class with fluxes near those given, if no hole has too little.
fn with_enough_flux(
    basis: &PoledBasis,
    class: Vec<i64>,
    others: impl Iterator<Item = f64> + Clone,
) -> Option<Candidate> {
    let sum: f64 = others.clone().sum();
    let mut fluxes: Vec<f64> = std::iter::once(-sum).chain(others).collect();
    for _ in 0..STEPS {
        fluxes = balanced(fluxes)?;
        let imaginary = basis.with_fluxes(&class, &fluxes[1..])?;
        let uneven = basis.uneven_holes(&imaginary, &fluxes);
        if uneven.is_empty() {
            return Some(Candidate {
                log_variance: 0.0,
                class,
                fluxes,
                imaginary,
            });
        }
        uneven.into_iter().for_each(|hole| fluxes[hole] *= STEP);
        fluxes = zero_sum(fluxes)?;
    }
    None
}

/// Raises fluxes that are too small, and scales those of either sign so that all sum to zero; nothing
/// if some stay too small.
pub(super) fn balanced(mut fluxes: Vec<f64>) -> Option<Vec<f64>> {
    let largest = |fluxes: &[f64]| fluxes.iter().fold(0.0_f64, |most, f| most.max(f.abs()));
    let least = |fluxes: &[f64]| fluxes.iter().fold(f64::INFINITY, |l, f| l.min(f.abs()));
    for _ in 0..BALANCES {
        let most = largest(&fluxes);
        if least(&fluxes) >= LEAST_FLUX * most {
            return most.is_normal().then_some(fluxes);
        }
        for flux in &mut fluxes {
            *flux = flux.signum() * flux.abs().max(RAISED_FLUX * most);
        }
        fluxes = zero_sum(fluxes)?;
    }
    None
}

/// Scales fluxes of either sign so that all sum to zero; nothing if all have one sign.
fn zero_sum(mut fluxes: Vec<f64>) -> Option<Vec<f64>> {
    let sum = |sign: f64| fluxes.iter().filter(|f| *f * sign > 0.0).sum::<f64>().abs();
    let ratio = (sum(-1.0) / sum(1.0)).sqrt();
    let scale = |flux: &mut f64| *flux *= if *flux > 0.0 { ratio } else { 1.0 / ratio };
    fluxes.iter_mut().for_each(scale);
    ratio.is_normal().then_some(fluxes)
}
