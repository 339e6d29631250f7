//! `msplines fit powell-sabin` and `msplines reshape`.

use msplines_common::{Point3, Vector3};
use msplines_compare::case::{Case, Input, Method, PowellSabinMethod};
use msplines_compare::run::{Change, ChangeKind, Evaluation, TSplineChanges};
use msplines_powell_sabin::{Fairness, Options, SurfaceOptions};

use crate::arguments::{Fill, PowellSabin, Reshape, Weights};
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

/// Returns the evaluation of a spline that is changed.
pub(crate) fn reshaping(reshape: &Reshape, session: &Session) -> Evaluation {
    let change = |at: &[f64], what| Change {
        at: Point3::from_slice(&at[..3]),
        what,
    };
    let vector = |numbers: &[f64; 6]| Vector3::from_column_slice(&numbers[3..]);
    let inserted = reshape.insert.iter().map(|numbers| {
        let (by, normal) = (vector(numbers), None);
        change(numbers, ChangeKind::Insert { by, normal })
    });
    let turned = reshape.turn.iter();
    let turned = turned.map(|numbers| change(numbers, ChangeKind::Turn(vector(numbers))));
    let scaled = reshape.scale.iter();
    let scaled = scaled.map(|numbers| change(numbers, ChangeKind::Scale(numbers[3])));
    Evaluation {
        spline: reshape.spline.clone(),
        mesh: None,
        shifts: Vec::new(),
        changes: inserted.chain(turned).chain(scaled).collect(),
        t_spline: TSplineChanges::default(),
        sum: None,
        subdivide: 0,
        cells: reshape.tessellate.map(|segments| segments as usize),
        at: None,
        moved: Vec::new(),
        outputs: reshape.outputs.clone(),
        seed: session.seed,
    }
}
