//! `msplines fit trivariate` and `msplines deform`.

use msplines_compare::case::{Case, Filler, Input, Method, SolidMap, TrivariateMethod};
use msplines_compare::error::exit;
use msplines_compare::experiment::{FitName, RowSolid, Settings};
use msplines_compare::run::{Evaluation, TSplineChanges};
use msplines_trivariate::domain::Sampling;
use msplines_trivariate::domain::mesher::Spacing;

use crate::arguments::{Deform, Map, SolidFit, Trivariate};
use crate::session::{Failure, Session};

/// Returns the run that the arguments ask for.
pub(crate) fn case(arguments: &Trivariate, session: &Session) -> Result<Case, Failure> {
    let input = Input::File {
        path: arguments.input.clone(),
        repair: session.repair,
    };
    let method = method(arguments)?;
    Ok(Case {
        outputs: arguments.outputs.clone(),
        seed: session.seed,
        measure_distance: arguments.distance,
        ..Case::new(input, Method::Trivariate(Box::new(method)))
    })
}

fn method(arguments: &Trivariate) -> Result<TrivariateMethod, Failure> {
    let fit = arguments.fit.map(|fit| match fit {
        SolidFit::Certified => FitName::Certified,
        SolidFit::LeastSquares => FitName::LeastSquares,
        SolidFit::Multilevel => FitName::Multilevel,
    });
    let is_multilevel = fit.map_or(arguments.paper, |fit| fit == FitName::Multilevel);
    if arguments.stop.is_some() && !is_multilevel {
        return Err(Failure {
            code: exit::USAGE,
            text: "--stop is for multilevel B-splines; add --fit multilevel, or leave it out"
                .to_owned(),
        });
    }
    let surface_weight = match Sampling::default() {
        Sampling::Even { surface_weight, .. } => surface_weight,
        Sampling::Vertices => 1.0,
    };
    let sizes = |sizes: &[u32]| sizes.iter().map(|&n| n as usize).collect();
    let options = RowSolid {
        settings: if arguments.paper {
            Settings::Paper
        } else {
            Settings::Ours
        },
        map: match arguments.map {
            Map::Cube => SolidMap::Cube,
            Map::Cylinder => SolidMap::Cylinder,
        },
        filler: if arguments.tetgen {
            Filler::Tetgen
        } else {
            Filler::Lattice
        },
        corners: arguments.corners,
        spacing: match arguments.cells {
            Some(cells) => Some(Spacing::Cells(cells)),
            None => arguments.spacing.map(Spacing::AlongDiagonal),
        },
        fit,
        sampling: arguments.samples.map(|[interior, surface]| Sampling::Even {
            interior,
            surface,
            surface_weight,
        }),
        spans: match arguments.levels {
            Some(levels) => Some(levels.last),
            None => arguments.spans.map(|spans| spans as usize),
        },
        coarsest: arguments.levels.map(|levels| levels.first),
        stop_rms: arguments.stop,
        validate_at: Some(sizes(&arguments.validate_at)),
        cells: Some(arguments.tessellate as usize),
        ..RowSolid::default()
    };
    Ok(options.method())
}

/// Returns the evaluation of a spline whose control points are moved.
pub(crate) fn deformation(deform: &Deform, session: &Session) -> Evaluation {
    let moves = deform.moves.iter();
    Evaluation {
        spline: deform.spline.clone(),
        mesh: None,
        shifts: Vec::new(),
        changes: Vec::new(),
        t_spline: TSplineChanges::default(),
        sum: None,
        subdivide: 0,
        cells: deform.tessellate.map(|cells| cells as usize),
        at: None,
        moved: moves.map(|m| (m.index, m.to)).collect(),
        outputs: deform.outputs.clone(),
        seed: session.seed,
    }
}
