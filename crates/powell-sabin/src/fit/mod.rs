//! The fit: the fairest surface through given positions and normals.

mod data;
mod orientation;
mod stiffness;
mod system;

use msplines_common::Vector3;
use msplines_common::progress::{Observer, Outcome, Progress};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

pub use data::VertexCondition;
pub(crate) use data::{tangents, unit};

use crate::domain::FlatDomain;
use crate::error::FitError;
use crate::options::{Options, Orientation};
use crate::spline::PowellSabinSpline;
use data::Unknowns;
use orientation::{opposed, repair, violations};
use stiffness::Stiffness;
use system::System;

/// What a solve may leave of the right-hand side before a warning is due.
const RESIDUAL_TOLERANCE: f64 = 1e-9;

/// A spline and how it was found.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The surface.
    pub spline: PowellSabinSpline,
    /// How the fit went.
    pub report: Report,
}

/// How a fit went.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// `Converged`; `Stalled` if orientations are left that no repair could turn; `Stopped` if the
    /// observer broke off before the repair.
    pub outcome: Outcome,
    /// Number of unknowns.
    pub unknowns: usize,
    /// Largest entry of the right-hand side that is left, relative to its largest.
    pub residual: f64,
    /// Vertices that the fairest surface passes inside out.
    pub violations_before: usize,
    /// Those left after the repair.
    pub violations_after: usize,
    /// Rounds of the repair.
    pub repair_rounds: u32,
    /// What the result should be read with.
    pub warnings: Vec<Warning>,
}

/// What a result should be read with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Warning {
    /// Normals that point against all facets around, where the surface must fold.
    #[error(
        "the normals at vertices {vertices:?} point against all facets around, so that the surface folds there; turn them"
    )]
    OpposedNormals {
        /// The vertices.
        vertices: Vec<u32>,
    },
    /// Vertices that the surface passes inside out.
    #[error(
        "the surface is inside out at vertices {vertices:?}; allow repairs, or check their normals"
    )]
    InsideOut {
        /// The vertices.
        vertices: Vec<u32>,
    },
    /// A system that is nearly singular.
    #[error(
        "the system is nearly singular: {residual:.0e} of its right-hand side is left; give more vertices a position, or the membrane a weight"
    )]
    NearlySingular {
        /// What is left.
        residual: f64,
    },
}

/// Returns the fairest surface that does at every vertex what `data` says.
///
/// It minimises the weighted sum of membrane and thin-plate energy, in one sparse factorisation; 4
/// numbers are free at a vertex with position and normal. `observer` sees the phase `fit`; a
/// break leaves orientations as they are.
///
/// # Reference
/// [He2005] Eq. (5), Eq. (6), Eq. (9). Deviation: four numbers are free at a vertex, not three: of
/// nine, the position takes three and the direction of the normal two. The sign of the normal is an
/// inequality, which the paper's equations do not see; it is repaired.
///
/// # Errors
/// Data or weights that are no task, or a system that is singular to rounding.
pub fn fit(
    domain: &FlatDomain,
    data: &[VertexCondition],
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Fit, FitError> {
    check_weights(options)?;
    data::check(domain, data)?;
    let unknowns = Unknowns::new(domain, data);
    let active = |v: u32| !unknowns.range(v).is_empty();
    let system = {
        let stiffness = Stiffness::assemble(domain, options, active);
        System::assemble(domain, &stiffness, &unknowns)?
    };
    let (mut x, residual) = system.solve(&unknowns)?;
    let mut report = Report {
        outcome: Outcome::Converged,
        unknowns: unknowns.count(),
        residual,
        violations_before: violations(data, &unknowns, &x).len(),
        violations_after: 0,
        repair_rounds: 0,
        warnings: Vec::new(),
    };
    if observer(&Progress::new("fit", 1, 2)).is_break() {
        report.outcome = Outcome::Stopped;
    } else if options.orientation == Orientation::Repair {
        report.repair_rounds = repair(domain, data, &unknowns, &system, &mut x)?;
    }
    // The work is done: a break has nothing left to interrupt.
    let _ = observer(&Progress::new("fit", 2, 2));
    report.finish(domain, data, &unknowns, &x);
    let spline = spline(domain, data, &unknowns, &x)?;
    Ok(Fit { spline, report })
}

impl Report {
    fn finish(
        &mut self,
        domain: &FlatDomain,
        data: &[VertexCondition],
        unknowns: &Unknowns,
        x: &[f64],
    ) {
        let left = violations(data, unknowns, x);
        self.violations_after = left.len();
        if !left.is_empty() {
            if self.outcome == Outcome::Converged && self.repair_rounds > 0 {
                self.outcome = Outcome::Stalled;
            }
            self.warnings.push(Warning::InsideOut { vertices: left });
        }
        let vertices = opposed(domain, data, unknowns);
        if !vertices.is_empty() {
            self.warnings.push(Warning::OpposedNormals { vertices });
        }
        if self.residual > RESIDUAL_TOLERANCE {
            let residual = self.residual;
            self.warnings.push(Warning::NearlySingular { residual });
        }
    }
}

fn check_weights(options: &Options) -> Result<(), FitError> {
    let Options {
        membrane,
        thin_plate,
        ..
    } = *options;
    let good = |w: f64| w.is_finite() && w >= 0.0;
    if good(membrane) && good(thin_plate) && membrane + thin_plate > 0.0 {
        Ok(())
    } else {
        Err(FitError::Weights {
            membrane,
            thin_plate,
        })
    }
}

fn spline(
    domain: &FlatDomain,
    data: &[VertexCondition],
    unknowns: &Unknowns,
    x: &[f64],
) -> Result<PowellSabinSpline, FitError> {
    let count = domain.mesh().vertex_count();
    let (mut values, mut gradients) =
        (Vec::with_capacity(3 * count), Vec::with_capacity(6 * count));
    for vertex in 0..count as u32 {
        let [value, by_u, by_v] = unknowns.numbers(vertex, x);
        values.extend(value);
        let gradient = data[vertex as usize].kept([by_u, by_v].map(Vector3::from));
        gradients.extend(gradient.into_iter().flat_map(<[f64; 3]>::from));
    }
    Ok(PowellSabinSpline::from_parts(
        domain.clone(),
        3,
        values,
        gradients,
    )?)
}

impl PowellSabinSpline {
    /// Returns the energy that [`fit`] minimises, over all components.
    ///
    /// # Reference
    /// [He2005] Eq. (9).
    #[must_use]
    pub fn energy(&self, options: &Options) -> f64 {
        let domain = self.flat_domain();
        let weights = stiffness::plate_weights(domain, options);
        let faces: Vec<f64> = (0..domain.mesh().face_count() as u32)
            .into_par_iter()
            .map(|face| {
                let matrix = stiffness::element(domain, face, options, weights[face as usize]);
                let component = |c: usize| {
                    let mut numbers = self.corner_numbers(face, c);
                    // Constants have no energy, and large ones cost digits.
                    let first = numbers[0];
                    (0..3).for_each(|i| numbers[3 * i] -= first);
                    crate::energy::energy(&matrix, &numbers)
                };
                (0..self.dimension()).map(component).sum()
            })
            .collect();
        faces.iter().sum()
    }
}
