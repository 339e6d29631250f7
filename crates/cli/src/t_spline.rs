//! `msplines fit t-spline` and what `msplines reshape` does with its splines.

use msplines_common::{Point3, Vector3};
use msplines_compare::case::{Case, DomainStorage, Input, Method, TSplineMethod};
use msplines_compare::run::TSplineChanges;
use msplines_t_spline::edit::Drag;
use msplines_t_spline::fit::Correction;
use msplines_t_spline::{FitOptions, Sampling, Stop};

use crate::arguments::{Reshape, Solver, TSpline, Toggle};
use crate::session::Session;

/// Conjugate gradients as they are asked for by name.
const ITERATED: msplines_t_spline::fit::Solver =
    msplines_t_spline::fit::Solver::ConjugateGradients {
        tolerance: 1e-8,
        steps: 20_000,
    };

/// Returns the run that the arguments ask for.
pub(crate) fn case(arguments: &TSpline, session: &Session) -> Case {
    let input = Input::File {
        path: arguments.input.clone(),
        repair: session.repair,
    };
    let defaults = FitOptions::default();
    let stop = match (arguments.control_points, arguments.tolerance) {
        (_, Some(share)) => Stop::Tolerance(share),
        (Some(count), None) => Stop::ControlPoints(count),
        (None, None) => defaults.stop,
    };
    let method = TSplineMethod {
        form: arguments.form.clone(),
        puncture: arguments.puncture.clone().unwrap_or_default(),
        fit: FitOptions {
            stop,
            fairness: arguments.fairness.unwrap_or(defaults.fairness),
            correction: match arguments.correction {
                Toggle::On => Correction::default(),
                Toggle::Off => Correction::Off,
            },
            solver: match arguments.solver {
                Solver::Factorisation => msplines_t_spline::fit::Solver::Factorisation,
                Solver::ConjugateGradients => ITERATED,
            },
            ..defaults
        },
        face_samples: Sampling {
            per_control_point: arguments.face_samples,
        },
        tessellate: arguments.tessellate,
        ..TSplineMethod::default()
    };
    Case {
        outputs: arguments.outputs.clone(),
        seed: session.seed,
        measure_distance: arguments.distance,
        domain: if arguments.domain_by_digest {
            DomainStorage::Digest
        } else {
            DomainStorage::Embedded
        },
        ..Case::new(input, Method::TSpline(Box::new(method)))
    }
}

/// Returns the movements of control points that are asked for.
pub(crate) fn changes(reshape: &Reshape) -> TSplineChanges {
    let drag = |&[x, y, z, dx, dy, dz]: &[f64; 6]| Drag {
        at: Point3::new(x, y, z),
        by: Vector3::new(dx, dy, dz),
        within: reshape.within,
    };
    let moves = reshape.control.iter();
    let pulls = reshape.pull.iter();
    TSplineChanges {
        level: None,
        moves: moves.map(|m| (m.index, Vector3::from(m.numbers))).collect(),
        drags: reshape.moves.iter().map(drag).collect(),
        pulls: pulls.map(|p| (p.index, Point3::from(p.numbers))).collect(),
        list: reshape.list.clone(),
    }
}
