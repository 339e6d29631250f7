//! `msplines fit t-spline`.

use msplines_compare::case::{Case, DomainStorage, FaceSamples, Input, Method, TSplineMethod};
use msplines_t_spline::fit::Correction;
use msplines_t_spline::{FitOptions, Stop};

use crate::arguments::{Solver, TSpline, Toggle};
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
        face_samples: FaceSamples {
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
