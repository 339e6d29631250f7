//! The form of a closed surface: which class of integer periods, and on which triangulation.

use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::Observer;
use msplines_conformal::{Atlas, FormChoice, HolomorphicBasis, HolomorphicForm};
use nalgebra::DVector;
use rayon::prelude::*;

use super::error::DomainError;
use super::form::{PeriodicForm, Values};
use super::levels::Levels;
use super::{Domain, DomainOptions};

/// Cost of two critical levels nearer than `NEAR`, which leave a sliver of a cylinder, beside that of
/// the form itself.
const GAP: f64 = 0.1;
const NEAR: f64 = 0.01;

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
        FormChoice::Integer { objective, .. } => {
            let forms = choice.candidates(basis)?.into_iter();
            let priced = forms.map(|form| (objective.cost(form.log_variance, form.energy), form));
            Ok(by_gaps(priced.collect(), basis, mesh))
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
