//! The form of a closed surface: which class of integer periods, and on which triangulation.

use std::f64::consts::PI;

use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::Observer;
use msplines_conformal::{Atlas, FormChoice, HolomorphicBasis, HolomorphicForm, Uniformity};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::error::DomainError;
use super::form::{PeriodicForm, Values};
use super::levels::Levels;
use super::{Domain, DomainOptions};

/// Cost of the logarithm of the energy `∫ |ω|²`: without it classes win that wind round many times.
const ENERGY: f64 = 0.06;

/// Cost of two critical levels nearer than `NEAR`, which leave a sliver of a cylinder.
const GAP: f64 = 0.1;
const NEAR: f64 = 0.01;

/// Directions of an even form that are rounded to classes, and the largest entry of these.
const DIRECTIONS: u32 = 24;
const LARGEST_ENTRY: i32 = 3;

/// Classes that are improved entry by entry, and of which the levels are compared.
const CLIMBERS: usize = 12;

impl Domain {
    /// Lays out a closed surface of genus >= 1 by the best form of integer periods.
    pub(super) fn closed(
        mesh: &TriangleMesh,
        options: &DomainOptions,
        observer: &mut Observer<'_>,
    ) -> Result<Self, DomainError> {
        let basis = HolomorphicBasis::build(mesh, observer)?;
        let ranked = ranked(&basis, mesh, &options.form)?;
        for form in &ranked {
            let on_mesh = basis.form_on_mesh(mesh, [&form.real, &form.imaginary]);
            let Ok(atlas) = Atlas::of_form(mesh, &on_mesh) else {
                continue;
            };
            if let Ok(domain) = Self::of_form(&PeriodicForm::of_atlas(&atlas), &options.snap) {
                return Ok(domain);
            }
        }
        let Some(best) = ranked.first() else {
            return Err(DomainError::RealPeriods);
        };
        let choice = FormChoice::IntegerPeriods(periods(&basis, &best.imaginary));
        let found = Atlas::closed(mesh, &choice, observer)?;
        let mut domain = Self::of_form(&PeriodicForm::of_atlas(&found.atlas), &options.snap)?;
        domain.origins[mesh.vertex_count()..].fill(None);
        Ok(domain)
    }
}

/// Forms of integer periods, in the order in which they should be tried.
fn ranked(
    basis: &HolomorphicBasis,
    mesh: &TriangleMesh,
    choice: &FormChoice,
) -> Result<Vec<HolomorphicForm>, DomainError> {
    match choice {
        FormChoice::Integer { .. } if basis.genus() == 1 => {
            let shortest = shortest(basis.gram());
            Ok(vec![Search::over(basis).form(&shortest)])
        }
        FormChoice::Integer { seed } => {
            let forms = Search::over(basis).best(*seed)?;
            Ok(by_gaps(forms, basis, mesh))
        }
        FormChoice::IntegerPeriods(_) => Ok(choice.candidates(basis)?),
        _ => Err(DomainError::RealPeriods),
    }
}

/// Adds the cost of near levels, and sorts by the sum.
fn by_gaps(
    forms: Vec<(f64, HolomorphicForm)>,
    basis: &HolomorphicBasis,
    mesh: &TriangleMesh,
) -> Vec<HolomorphicForm> {
    let faces = basis.triangulation().faces.clone();
    let delaunay = TriangleMesh::build(mesh.positions().to_vec(), faces).ok();
    let near = |form: &HolomorphicForm| {
        let given = PeriodicForm {
            mesh: delaunay.clone()?,
            form: basis.form([&form.real, &form.imaginary]),
            ends: Vec::new(),
        };
        let values = Values::integrate(&given).ok()?;
        let gap = Levels::find(&given.mesh, &values).ok()?.least_gap();
        Some(if gap < NEAR { GAP } else { 0.0 })
    };
    let mut forms: Vec<(f64, HolomorphicForm)> = (forms.into_par_iter())
        // A form without levels is tried last.
        .map(|(cost, form)| (cost + near(&form).unwrap_or(f64::INFINITY), form))
        .collect();
    forms.sort_by(|a, b| a.0.total_cmp(&b.0));
    forms.into_iter().map(|(_, form)| form).collect()
}

/// A search for integer classes that are even and short.
struct Search<'a> {
    basis: &'a HolomorphicBasis,
    measure: Uniformity,
}

impl<'a> Search<'a> {
    fn over(basis: &'a HolomorphicBasis) -> Self {
        Self {
            basis,
            measure: Uniformity::sample(basis),
        }
    }

    /// The form whose imaginary part is of a class; its real part is minus the conjugate.
    fn form(&self, class: &[i64]) -> HolomorphicForm {
        let imaginary = vector(class);
        let real = -self.basis.conjugate(&imaginary);
        HolomorphicForm {
            log_variance: self.measure.variance(&real),
            real,
            imaginary,
        }
    }

    fn cost(&self, class: &[i64]) -> f64 {
        let n = vector(class);
        let energy = n.dot(&(self.basis.gram() * &n));
        self.measure.variance(&-self.basis.conjugate(&n)) + ENERGY * energy.ln()
    }

    /// The best classes with their costs, best first: from classes of one and two handles, and from
    /// those that the most even real forms round to, changed entry by entry while that helps.
    fn best(&self, seed: u64) -> Result<Vec<(f64, HolomorphicForm)>, DomainError> {
        let classes = self.basis.classes();
        let mut tried: Vec<Vec<i64>> = Vec::new();
        for i in 0..classes {
            let unit = |k: usize, n: i64| (0..classes).map(move |j| if j == k { n } else { 0 });
            tried.push(unit(i, 1).collect());
            for (j, sign) in (0..i).flat_map(|j| [(j, 1), (j, -1)]) {
                tried.push(unit(j, 1).zip(unit(i, sign)).map(|(a, b)| a + b).collect());
            }
        }
        for form in (FormChoice::Optimal { seed }).candidates(self.basis)? {
            for direction in 0..DIRECTIONS {
                let angle = PI * f64::from(direction) / f64::from(DIRECTIONS);
                let turned = &form.imaginary * angle.cos() + &form.real * angle.sin();
                let scale = turned.amax();
                let rounded = (1..=LARGEST_ENTRY).map(|largest| {
                    let entries = turned.iter().map(|n| n / scale * f64::from(largest));
                    primitive(entries.map(|n| n.round() as i64).collect())
                });
                tried.extend(rounded);
            }
        }
        tried.sort_unstable();
        tried.dedup();
        let ranked = tried
            .into_par_iter()
            .map(|class| (self.cost(&class), class));
        let ranked = sorted(ranked.collect(), CLIMBERS);
        let climbed = ranked.into_par_iter().map(|start| self.climb(start));
        let best = sorted(climbed.collect(), CLIMBERS);
        Ok(best
            .into_iter()
            .map(|(cost, class)| (cost, self.form(&class)))
            .collect())
    }

    /// Changes one entry by one while that helps.
    fn climb(&self, start: (f64, Vec<i64>)) -> (f64, Vec<i64>) {
        let (mut best, mut class) = start;
        loop {
            let before = best;
            for (entry, step) in (0..class.len()).flat_map(|entry| [(entry, -1), (entry, 1)]) {
                let mut changed = class.clone();
                changed[entry] += step;
                if changed.iter().all(|&n| n == 0) {
                    continue;
                }
                let changed = primitive(changed);
                let cost = self.cost(&changed);
                if cost < best {
                    (best, class) = (cost, changed);
                }
            }
            if best >= before {
                return (best, class);
            }
        }
    }
}

/// The first of all, best first, each once.
fn sorted(mut classes: Vec<(f64, Vec<i64>)>, count: usize) -> Vec<(f64, Vec<i64>)> {
    classes.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
    classes.dedup_by(|a, b| a.1 == b.1);
    classes.truncate(count);
    classes
}

fn vector(class: &[i64]) -> DVector<f64> {
    DVector::from_iterator(class.len(), class.iter().map(|&n| n as f64))
}

/// Divides a class by the greatest common divisor of its entries, and makes the first one that is not
/// zero positive.
fn primitive(class: Vec<i64>) -> Vec<i64> {
    let divisor = class
        .iter()
        .fold(0, |a, &b| greatest_common_divisor(a, b.abs()));
    let first = class.iter().find(|&&n| n != 0).map_or(1, |n| n.signum());
    let divisor = first * divisor.max(1);
    class.into_iter().map(|n| n / divisor).collect()
}

fn greatest_common_divisor(a: i64, b: i64) -> i64 {
    if b == 0 {
        a
    } else {
        greatest_common_divisor(b, a % b)
    }
}

/// The shortest class of a torus in the energy norm, by Gauss's reduction.
fn shortest(gram: &DMatrix<f64>) -> Vec<i64> {
    let dot = |a: &[i64], b: &[i64]| vector(a).dot(&(gram * vector(b)));
    let (mut short, mut long) = (vec![1, 0], vec![0, 1]);
    loop {
        if dot(&long, &long) < dot(&short, &short) {
            std::mem::swap(&mut short, &mut long);
        }
        let times = (dot(&short, &long) / dot(&short, &short)).round() as i64;
        let reduced: Vec<i64> = (0..2).map(|k| long[k] - times * short[k]).collect();
        // Rounding may find two that are as long better by turns.
        if times == 0 || dot(&reduced, &reduced) >= dot(&long, &long) {
            return primitive(short);
        }
        long = reduced;
    }
}

/// Periods of a closed form with these coefficients.
fn periods(basis: &HolomorphicBasis, coefficients: &DVector<f64>) -> Vec<i64> {
    let period = |row: &Vec<i64>| {
        let terms = row.iter().zip(coefficients.iter());
        terms.map(|(&n, &c)| n * c.round() as i64).sum()
    };
    basis
        .homology()
        .integer_periods()
        .iter()
        .map(period)
        .collect()
}
