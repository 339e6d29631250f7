//! `msplines fit` and `msplines evaluate`: thin callers of the harness.

use msplines_biharmonic::Laplacian;
use msplines_common::{Point3, Vector3};
use msplines_compare::case::{
    BiharmonicMethod, Case, CaseCreases, Data, DomainStorage, Input, Knots, Method, Task, Weights,
};
use msplines_compare::error::exit;
use msplines_compare::input::file_name;
use msplines_compare::run::{self, Evaluation, Shift, TSplineChanges};

use msplines_ls_mesh::Constraints;

use crate::arguments::{
    BiharmonicChoices, Combine, Decompose, Deform, Edit, Effort, Evaluate, Fit, FitFiles, Reshape,
    Selection,
};
use crate::manifold;
use crate::powell_sabin;
use crate::session::{Failure, Session};
use crate::solid;
use crate::t_spline;

/// Attributes that hold the colours of vertices.
const COLOURS: [&str; 3] = ["red", "green", "blue"];

/// Fits a spline.
pub(crate) fn fit(fit: &Fit, session: &Session) -> Result<u8, Failure> {
    let (input, case) = match fit {
        Fit::Biharmonic(arguments) => {
            let files = &arguments.files;
            (&files.input, case(files, biharmonic(arguments)?, session))
        }
        Fit::LsMesh(arguments) => {
            let files = &arguments.files;
            (&files.input, case(files, ls_mesh(arguments), session))
        }
        Fit::SparseManifold(arguments) => (&arguments.input, manifold::case(arguments, session)),
        Fit::CurveNetwork(arguments) => (&arguments.input, manifold::network(arguments, session)),
        Fit::Trivariate(arguments) => (&arguments.input, solid::case(arguments, session)?),
        Fit::PowellSabin(arguments) => (&arguments.input, powell_sabin::case(arguments, session)),
        Fit::TSpline(arguments) => (&arguments.input, t_spline::case(arguments, session)),
    };
    let label = format!("{} {}", case.method.name(), file_name(input));
    session.observe(&label, |observer| {
        run::run(&case, session.process_start, observer)
    })
}

/// Evaluates a spline file.
pub(crate) fn evaluate(evaluate: &Evaluate, session: &Session) -> Result<u8, Failure> {
    run_evaluation("evaluate", &evaluation(evaluate, session), session)
}

/// Moves control points of a spline in a file.
pub(crate) fn edit(edit: &Edit, session: &Session) -> Result<u8, Failure> {
    let shift = |&[x, y, z, dx, dy, dz]: &[f64; 6]| Shift {
        at: Point3::new(x, y, z),
        by: Vector3::new(dx, dy, dz),
        within: edit.within,
    };
    let evaluation = Evaluation {
        shifts: edit.moves.iter().map(shift).collect(),
        ..evaluation(&edit.evaluate, session)
    };
    run_evaluation("edit", &evaluation, session)
}

/// Moves control points of a solid in a file.
pub(crate) fn deform(deform: &Deform, session: &Session) -> Result<u8, Failure> {
    run_evaluation("deform", &solid::deformation(deform, session), session)
}

/// Changes a Powell-Sabin spline or a T-spline in a file.
pub(crate) fn reshape(reshape: &Reshape, session: &Session) -> Result<u8, Failure> {
    let usage = |text: &str| {
        Err(Failure {
            code: exit::USAGE,
            text: text.to_owned(),
        })
    };
    let triangles = powell_sabin::reshaping(reshape, session);
    let evaluation = Evaluation {
        t_spline: t_spline::changes(reshape),
        ..triangles
    };
    let points = &evaluation.t_spline;
    let others = points.moves.len() + points.drags.len() + points.pulls.len();
    if evaluation.changes.is_empty() && others == 0 && points.list.is_none() {
        return usage(
            "give --insert, --turn or --scale for a Powell-Sabin spline, --move, --control, --pull \
             or --list for a T-spline",
        );
    }
    run_evaluation("reshape", &evaluation, session)
}

/// Adds splines in files.
pub(crate) fn combine(combine: &Combine, session: &Session) -> Result<u8, Failure> {
    let term = |text: &String| {
        let split = text.rsplit_once(':');
        let factor = split.and_then(|(path, factor)| Some((path.into(), factor.parse().ok()?)));
        factor.unwrap_or_else(|| (text.into(), 1.0))
    };
    let others = combine.others.iter().map(term).collect();
    let evaluation = Evaluation {
        sum: Some((combine.factor, others)),
        ..evaluation(&combine.evaluate, session)
    };
    run_evaluation("combine", &evaluation, session)
}

fn evaluation(evaluate: &Evaluate, session: &Session) -> Evaluation {
    Evaluation {
        spline: evaluate.spline.clone(),
        mesh: evaluate.mesh.clone(),
        shifts: Vec::new(),
        changes: Vec::new(),
        t_spline: TSplineChanges {
            level: evaluate.level.map(|level| level as usize),
            ..TSplineChanges::default()
        },
        sum: None,
        subdivide: evaluate.subdivide,
        cells: evaluate.tessellate.map(|cells| cells as usize),
        at: evaluate.at.clone(),
        moved: Vec::new(),
        outputs: evaluate.outputs.clone(),
        seed: session.seed,
    }
}

fn run_evaluation(what: &str, evaluation: &Evaluation, session: &Session) -> Result<u8, Failure> {
    let label = format!("{what} {}", file_name(&evaluation.spline));
    session.observe(&label, |observer| {
        run::evaluate(evaluation, session.process_start, observer)
    })
}

fn case(files: &FitFiles, method: Method, session: &Session) -> Case {
    let input = Input::File {
        path: files.input.clone(),
        repair: session.repair,
    };
    let data = match (files.attributes.as_slice(), files.data.as_str()) {
        ([], "positions") => Data::Positions,
        ([], "colors") => Data::Attributes(COLOURS.map(str::to_owned).to_vec()),
        ([], file) => Data::Array(file.into()),
        (names, _) => Data::Attributes(names.to_vec()),
    };
    let domain = if files.domain_by_digest {
        DomainStorage::Digest
    } else {
        DomainStorage::Embedded
    };
    let outputs = files.outputs.clone();
    let measure_distance = files.distance;
    Case {
        data,
        domain,
        outputs,
        measure_distance,
        seed: session.seed,
        ..Case::new(input, method)
    }
}

fn biharmonic(arguments: &crate::arguments::Biharmonic) -> Result<Method, Failure> {
    let knots = match (&arguments.knots_from, &arguments.knots) {
        (Some(points), _) if arguments.inside_faces => Knots::At(points.clone()),
        (Some(points), _) => Knots::Near(points.clone()),
        (None, Some(knots)) => knots.clone(),
        (None, None) => {
            return Err(Failure {
                code: exit::USAGE,
                text: "give --knots or --knots-from".to_owned(),
            });
        }
    };
    Ok(Method::Biharmonic(chosen(&arguments.choices, knots)))
}

fn chosen(choices: &BiharmonicChoices, knots: Knots) -> BiharmonicMethod {
    BiharmonicMethod {
        selection: match choices.selection {
            Selection::Exchange => msplines_biharmonic::Selection::Exchange,
            Selection::L1 => msplines_biharmonic::Selection::L1,
            Selection::L1Exchange => msplines_biharmonic::Selection::L1Exchange,
            Selection::Curvature => msplines_biharmonic::Selection::Curvature,
            Selection::BlueNoise => msplines_biharmonic::Selection::BlueNoise,
        },
        effort: match choices.effort {
            Effort::Fast => msplines_biharmonic::Effort::Fast,
            Effort::Standard => msplines_biharmonic::Effort::Standard,
            Effort::Best => msplines_biharmonic::Effort::Best,
        },
        polish: choices.polish,
        laplacian: if choices.intrinsic_delaunay {
            Laplacian::IntrinsicDelaunay
        } else {
            Laplacian::Cotangent
        },
        creases: match &choices.features {
            None => CaseCreases::None,
            Some(text) => match text.parse() {
                Ok(degrees) => CaseCreases::SharperThan(degrees),
                Err(_) => CaseCreases::Along(text.into()),
            },
        },
        weights: choices.weights.clone().map(Weights::File),
        ..BiharmonicMethod::new(knots)
    }
}

/// Splits a surface into layers.
pub(crate) fn decompose(decompose: &Decompose, session: &Session) -> Result<u8, Failure> {
    let layers = &decompose.layers;
    let factors = match decompose.factors.as_slice() {
        [] => vec![1.0; layers.len() + 1],
        factors => factors.to_vec(),
    };
    // The task names the knots of every layer.
    let method = chosen(&decompose.choices, Knots::Optimised(layers[0]));
    let case = Case {
        task: Task::Decompose {
            layers: layers.clone(),
            factors,
        },
        ..case(&decompose.files, Method::Biharmonic(method), session)
    };
    let label = format!("decompose {}", file_name(&decompose.files.input));
    session.observe(&label, |observer| {
        run::run(&case, session.process_start, observer)
    })
}

fn ls_mesh(arguments: &crate::arguments::LsMesh) -> Method {
    let defaults = msplines_ls_mesh::Options::default();
    Method::LsMesh {
        controls: arguments.controls,
        selection: match (arguments.greedy, arguments.solves) {
            (true, _) => msplines_ls_mesh::Selection::Greedy,
            (false, Some(solves)) => msplines_ls_mesh::Selection::Combined {
                solves: solves as usize,
            },
            (false, None) => defaults.selection,
        },
        constraints: match (arguments.hard, arguments.weight) {
            (true, _) => Constraints::Hard,
            (false, Some(weight)) => Constraints::Soft { weight },
            (false, None) => defaults.constraints,
        },
    }
}
