//! The form of a closed surface: which class of integer periods, and on which triangulation.

use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::Observer;
use msplines_conformal::{Atlas, ClassObjective, FormChoice, HolomorphicBasis, HolomorphicForm};
use nalgebra::DVector;

use super::error::DomainError;
use super::form::PeriodicForm;
use super::{Domain, DomainOptions};

/// Cost of cylinders that stay thin, beside that of the form: levels so near that a sliver is left of a
/// cylinder, but not so that it can be collapsed.
const THIN: f64 = 0.1;

/// By how much a form that lies flat on the mesh as it is may cost more than the best one, for which the
/// mesh has to be mended.
const UNMENDED: f64 = 0.1;

impl Domain {
    /// Lays out a closed surface of genus >= 1 by the best form of integer periods.
    pub(super) fn closed(
        mesh: &TriangleMesh,
        options: &DomainOptions,
        observer: &mut Observer<'_>,
    ) -> Result<Self, DomainError> {
        let basis = HolomorphicBasis::build(mesh, observer)?;
        let priced = priced(&basis, &options.form)?;
        let Some((least, first)) = priced.first() else {
            return Err(DomainError::RealPeriods);
        };
        let mut best: Option<(f64, Self)> = None;
        for (cost, form) in &priced {
            let bound = best.as_ref().map_or(least + UNMENDED, |(found, _)| *found);
            if *cost > bound {
                break;
            }
            let on_mesh = basis.form_on_mesh(mesh, [&form.real, &form.imaginary]);
            let Ok(atlas) = Atlas::of_form(mesh, &on_mesh) else {
                continue;
            };
            let Ok(domain) = Self::of_form(&PeriodicForm::of_atlas(&atlas), &options.snap) else {
                continue;
            };
            let cost = cost + if domain.report.thin > 0 { THIN } else { 0.0 };
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, domain));
            }
        }
        if let Some((_, domain)) = best {
            return Ok(domain);
        }
        let choice = FormChoice::IntegerPeriods(periods(&basis, &first.imaginary));
        let found = Atlas::closed(mesh, &choice, observer)?;
        let mut domain = Self::of_form(&PeriodicForm::of_atlas(&found.atlas), &options.snap)?;
        domain.origins[mesh.vertex_count()..].fill(None);
        Ok(domain)
    }
}

/// Forms of integer periods and what they cost, in that order.
fn priced(
    basis: &HolomorphicBasis,
    choice: &FormChoice,
) -> Result<Vec<(f64, HolomorphicForm)>, DomainError> {
    let price = match choice {
        FormChoice::Integer { objective, .. } => *objective,
        FormChoice::IntegerPeriods(_) => ClassObjective::default(),
        _ => return Err(DomainError::RealPeriods),
    };
    let forms = choice.candidates(basis)?.into_iter();
    let cost = |form: &HolomorphicForm| price.cost(form.log_variance, form.energy);
    let mut priced: Vec<_> = forms.map(|form| (cost(&form), form)).collect();
    priced.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(priced)
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
