//! `msplines fit powell-sabin`.

use msplines_compare::case::{Case, Input, Method, PowellSabinMethod};
use msplines_powell_sabin::{Fairness, Options, SurfaceOptions};

use crate::arguments::{Fill, PowellSabin, Weights};
use crate::session::Session;

/// Returns the run that the arguments ask for.
pub(crate) fn case(arguments: &PowellSabin, session: &Session) -> Case {
    let input = Input::File {
        path: arguments.input.clone(),
        repair: session.repair,
    };
    let method = PowellSabinMethod {
        form: arguments.form.clone(),
        puncture: arguments.puncture.clone(),
        surface: SurfaceOptions {
            spline: Options {
                membrane: arguments.fairness[0],
                thin_plate: arguments.fairness[1],
                fairness: match arguments.weights {
                    Weights::Parametric => Fairness::Parametric,
                    Weights::Geometric => Fairness::Geometric,
                },
                ..Options::default()
            },
            fill: match arguments.fill {
                Fill::Open => msplines_powell_sabin::Fill::Open,
                Fill::Minimal => msplines_powell_sabin::Fill::Minimal,
                Fill::Smooth => msplines_powell_sabin::Fill::Smooth,
            },
        },
        tessellate: arguments.tessellate,
        ..PowellSabinMethod::default()
    };
    Case {
        outputs: arguments.outputs.clone(),
        seed: session.seed,
        measure_distance: arguments.distance,
        ..Case::new(input, Method::PowellSabin(Box::new(method)))
    }
}
