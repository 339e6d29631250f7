//! The form of a closed surface: which class of integer periods, and on which triangulation.

use msplines_common::mesh::TriangleMesh;
use msplines_conformal::{Atlas, FormChoice, HolomorphicBasis, HolomorphicForm};
use nalgebra::{DMatrix, DVector};

use super::error::DomainError;
use super::form::{PeriodicForm, Values};
use super::levels::Levels;
use super::{Domain, DomainOptions};

/// Cost of the logarithm of the energy `∫ |ω|²`: without it classes win that wind round many times.
const ENERGY: f64 = 0.06;

/// Cost of two critical levels nearer than `NEAR`, which leave a sliver of a cylinder.
const GAP: f64 = 0.1;
const NEAR: f64 = 0.01;

impl Domain {
    /// Lays out a closed surface of genus >= 1 by the best form of integer periods.
    pub(super) fn closed(mesh: &TriangleMesh, options: &DomainOptions) -> Result<Self, DomainError> {
        let basis = HolomorphicBasis::build(mesh)?;
        let ranked = ranked(&basis, mesh, &options.form)?;
        for form in &ranked {
            let on_mesh = basis.form_on_mesh(mesh, [&form.real, &form.imaginary]);
            let Ok(atlas) = Atlas::of_form(mesh, &on_mesh) else {
                continue;
            };
            if let Ok(domain) = Self::of_form(&unscaled(mesh, &on_mesh, &atlas), &options.snap) {
                return Ok(domain);
            }
        }
        let Some(best) = ranked.first() else {
            return Err(DomainError::RealPeriods);
        };
        let choice = FormChoice::IntegerPeriods(periods(&basis, &best.imaginary));
        let found = Atlas::closed(mesh, &choice)?;
        let parts = [&found.form.real, &found.form.imaginary];
        let on_mesh = found.basis.form_on_mesh(&found.mesh, parts);
        let given = unscaled(&found.mesh, &on_mesh, &found.atlas);
        let mut domain = Self::of_form(&given, &options.snap)?;
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
    let forms = match choice {
        FormChoice::Integer { .. } if basis.genus() == 1 => {
            let imaginary = shortest(basis.gram());
            return Ok(vec![HolomorphicForm {
                real: -basis.conjugate(&imaginary),
                imaginary,
                log_variance: 0.0,
            }]);
        }
        FormChoice::Integer { .. } | FormChoice::IntegerPeriods(_) => choice.candidates(basis)?,
        _ => return Err(DomainError::RealPeriods),
    };
    let faces = basis.triangulation().faces.clone();
    let Ok(delaunay) = TriangleMesh::build(mesh.positions().to_vec(), faces) else {
        return Ok(forms);
    };
    let cost = |form: HolomorphicForm| {
        let energy = form.imaginary.dot(&(basis.gram() * &form.imaginary));
        let given = PeriodicForm {
            mesh: delaunay.clone(),
            form: basis.form([&form.real, &form.imaginary]),
            ends: Vec::new(),
        };
        let levels = Values::integrate(&given).and_then(|v| Levels::find(&given.mesh, &v));
        // A form without levels is tried last.
        let near = match levels {
            Ok(levels) if levels.least_gap() >= NEAR => 0.0,
            Ok(_) => GAP,
            Err(_) => f64::INFINITY,
        };
        (form.log_variance + ENERGY * energy.ln() + near, form)
    };
    let mut ranked: Vec<(f64, HolomorphicForm)> = forms.into_iter().map(cost).collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(ranked.into_iter().map(|(_, form)| form).collect())
}

/// The shortest class of a torus in the energy norm, by Gauss's reduction; its first entry that is not
/// zero is positive.
fn shortest(gram: &DMatrix<f64>) -> DVector<f64> {
    let dot = |a: &DVector<f64>, b: &DVector<f64>| a.dot(&(gram * b));
    let mut short = DVector::from_vec(vec![1.0, 0.0]);
    let mut long = DVector::from_vec(vec![0.0, 1.0]);
    loop {
        if dot(&long, &long) < dot(&short, &short) {
            std::mem::swap(&mut short, &mut long);
        }
        let times = (dot(&short, &long) / dot(&short, &short)).round();
        // Energies that are no numbers end here as well.
        if !(times.abs() >= 1.0) {
            break;
        }
        let reduced = &long - times * &short;
        if !(dot(&reduced, &reduced) < dot(&long, &long)) {
            break;
        }
        long = reduced;
    }
    let first = short.iter().copied().find(|&n| n != 0.0);
    if first.is_some_and(|n| n < 0.0) { -short } else { short }
}

/// Periods of a closed form with these coefficients.
fn periods(basis: &HolomorphicBasis, coefficients: &DVector<f64>) -> Vec<i64> {
    let period = |row: &Vec<i64>| {
        let terms = row.iter().zip(coefficients.iter());
        terms.map(|(&n, &c)| n * c.round() as i64).sum()
    };
    basis.homology().integer_periods().iter().map(period).collect()
}

/// The form on the mesh of an atlas, with the periods of the form it was made of: the integral of the
/// area form is the same on every triangulation.
fn unscaled(mesh: &TriangleMesh, on_mesh: &[[f64; 2]], atlas: &Atlas) -> PeriodicForm {
    debug_assert_eq!(3 * mesh.face_count(), on_mesh.len());
    let scale = (doubled_area(on_mesh) / doubled_area(atlas.form())).sqrt();
    PeriodicForm {
        mesh: atlas.mesh().clone(),
        form: atlas.form().iter().map(|v| v.map(|x| x * scale)).collect(),
        ends: Vec::new(),
    }
}

fn doubled_area(form: &[[f64; 2]]) -> f64 {
    let faces = form.as_chunks::<3>().0.iter();
    faces.map(|[a, b, _]| a[0] * b[1] - a[1] * b[0]).sum()
}
