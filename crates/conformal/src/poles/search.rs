//! Which class and which fluxes: those of the most even form.

use nalgebra::{Cholesky, DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use super::basis::PoledBasis;
use crate::choice::primitive;
use crate::descent::{Objective, minimise};
use crate::uniformity::Uniformity;

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
const STARTS: u64 = 12;

/// Largest entry of the integer classes that a search tries first.
const LARGEST_ENTRY: i32 = 3;

/// Classes that are improved entry by entry.
const CLIMBERS: usize = 3;

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

/// Returns forms of locally least variance, best first; none of their fluxes is too small.
pub(super) fn most_even(basis: &PoledBasis, seed: u64) -> Vec<Candidate> {
    let search = Search::over(basis);
    let mut found: Vec<Candidate> = (0..STARTS)
        .into_par_iter()
        .flat_map_iter(|start| search.from(seed.wrapping_add(start)))
        .collect();
    order(&mut found);
    let climbed: Vec<Candidate> = found
        .par_iter()
        .take(CLIMBERS)
        .filter_map(|start| search.climb(start))
        .collect();
    found.extend(climbed);
    order(&mut found);
    found
}

fn order(found: &mut Vec<Candidate>) {
    found.sort_by(|a, b| {
        let values = a.log_variance.total_cmp(&b.log_variance);
        values.then_with(|| a.class.cmp(&b.class))
    });
    found.dedup_by(|a, b| a.class == b.class && (a.log_variance - b.log_variance).abs() < 1e-9);
}

struct Search<'a> {
    basis: &'a PoledBasis,
    /// The measure in coordinates `x` with `G = R Rᵀ`, `x = Rᵀ a`.
    whitened: Uniformity,
    measure: Uniformity,
    root: DMatrix<f64>,
    inverse: DMatrix<f64>,
}

impl<'a> Search<'a> {
    fn over(basis: &'a PoledBasis) -> Self {
        let identity = || DMatrix::identity(basis.classes(), basis.classes());
        let factor = Cholesky::new(basis.gram().clone());
        let root = factor.map_or_else(identity, |factor| factor.l().transpose());
        let inverse = root.clone().try_inverse().unwrap_or_else(identity);
        let measure = basis.uniformity();
        Self {
            basis,
            whitened: measure.in_basis(&inverse),
            measure,
            root,
            inverse,
        }
    }

    /// Searches all real forms from a random one, and then those with integer classes near it.
    fn from(&self, seed: u64) -> Vec<Candidate> {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let entry = |_, _| random.random::<f64>() - 0.5;
        let start = DVector::from_fn(self.basis.classes(), entry);
        let (_, x) = self.whitened.minimise(&start);
        let best = &self.inverse * x;
        let handles = 2 * self.basis.genus();
        let scale = best.rows(0, handles).amax();
        let largest = if handles == 0 { 0 } else { LARGEST_ENTRY };
        let mut found: Vec<Candidate> = (1..=largest)
            .filter_map(|largest| {
                let near = &best * (f64::from(largest) / scale);
                let rounded = near.iter().take(handles).map(|n| n.round() as i64);
                let (class, divisor) = primitive(rounded.collect());
                let levels = near.rows(handles, near.len() - handles) / divisor as f64;
                self.levelled(class, levels)
            })
            .collect();
        // No class at all: the imaginary part is a function between the holes.
        let levels = best.rows(handles, best.len() - handles).into_owned();
        found.extend(self.levelled(vec![0; handles], levels));
        found
    }

    /// The most even form of a class, if no hole has too little flux.
    fn levelled(&self, class: Vec<i64>, start: DVector<f64>) -> Option<Candidate> {
        let scale = start.amax().max(f64::MIN_POSITIVE);
        let levels = Levels {
            search: self,
            class: &class,
            scale,
        };
        let (_, found) = minimise(&levels, start / scale);
        let mut imaginary = levels.coefficients(&found);
        let real = self.basis.real(&imaginary);
        let others = real.iter().skip(class.len()).copied();
        let sum: f64 = others.clone().sum();
        let mut fluxes: Vec<f64> = std::iter::once(-sum).chain(others).collect();
        for _ in 0..STEPS {
            let enough = balanced(fluxes.clone())?;
            if enough != fluxes {
                imaginary = self.basis.with_fluxes(&class, &enough[1..])?;
            }
            fluxes = enough;
            let uneven = self.basis.uneven_holes(&imaginary, &fluxes);
            if uneven.is_empty() {
                return Some(Candidate {
                    log_variance: self.measure.variance(&imaginary),
                    class,
                    fluxes,
                    imaginary,
                });
            }
            uneven.into_iter().for_each(|hole| fluxes[hole] *= STEP);
            fluxes = zero_sum(fluxes)?;
            imaginary = self.basis.with_fluxes(&class, &fluxes[1..])?;
        }
        None
    }

    /// Changes one entry of the class by one while that helps.
    fn climb(&self, start: &Candidate) -> Option<Candidate> {
        let mut best = start.clone();
        loop {
            let before = best.log_variance;
            for entry in 0..best.class.len() {
                for step in [-1, 1] {
                    let mut class = best.class.clone();
                    class[entry] += step;
                    let levels = best
                        .imaginary
                        .rows(class.len(), best.imaginary.len() - class.len());
                    let found = self.levelled(class, levels.into_owned());
                    if let Some(found) = found.filter(|f| f.log_variance < best.log_variance) {
                        best = found;
                    }
                }
            }
            if best.log_variance >= before {
                return (best.log_variance < start.log_variance).then_some(best);
            }
        }
    }
}

/// The variance of the forms of one class, by the levels of the holes.
struct Levels<'a> {
    search: &'a Search<'a>,
    class: &'a [i64],
    scale: f64,
}

impl Levels<'_> {
    fn coefficients(&self, levels: &DVector<f64>) -> DVector<f64> {
        let class = self.class.iter().map(|&n| n as f64);
        let all = class.chain(levels.iter().map(|level| level * self.scale));
        DVector::from_iterator(self.class.len() + levels.len(), all)
    }
}

impl Objective for Levels<'_> {
    fn evaluate(&self, levels: &DVector<f64>) -> (f64, DVector<f64>) {
        let x = &self.search.root * self.coefficients(levels);
        let (value, gradient) = self.search.whitened.evaluate(&x);
        let by_coefficients = self.search.root.tr_mul(&gradient);
        let handles = self.class.len();
        let by_levels = by_coefficients.rows(handles, levels.len()) * self.scale;
        (value, by_levels)
    }
}

/// Raises fluxes that are too small, and scales those of either sign so that all sum to zero; nothing
/// if some stay too small.
fn balanced(mut fluxes: Vec<f64>) -> Option<Vec<f64>> {
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
