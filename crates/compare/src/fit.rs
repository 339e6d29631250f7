//! From a case to a fitted spline in its stored form, whatever the method.

use std::ops::ControlFlow;
use std::sync::Arc;

use msplines_biharmonic as biharmonic;
use msplines_common::evaluate::VertexData;
use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::{Observer, Outcome, Progress};
use msplines_ls_mesh as ls_mesh;
use serde_json::{Value, json};

use crate::arrays;
use crate::case::{Amount, BiharmonicMethod, Case, CaseCreases, Knots, Method};
use crate::clock::PhaseClock;
use crate::error::RunError;
use crate::input::{FitData, LoadedInput, nearest_points, nearest_vertices};
use crate::record::{Checks, named};
use crate::spline_file::{StoredBiharmonic, StoredSpline};

/// Phases of a fit that a record tells apart.
pub(crate) const PHASES: [&str; 3] = ["domain", "select", "fit"];

/// What a method gave, before it is measured.
pub(crate) struct Fitted {
    /// The spline.
    pub(crate) stored: StoredSpline,
    /// What a biharmonic spline was fitted in: nothing in it needs to be computed again.
    pub(crate) space: Option<Arc<biharmonic::Space>>,
    /// All options of the method.
    pub(crate) options: Value,
    /// How the fit ended.
    pub(crate) outcome: Outcome,
    /// Flat values of the method.
    pub(crate) checks: Checks,
    /// What the user should know.
    pub(crate) warnings: Vec<String>,
}

/// Fits `data` on the mesh of `input`; the clock follows the phases that the method reports.
pub(crate) fn fit(
    case: &Case,
    input: &LoadedInput,
    data: &FitData,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<Fitted, RunError> {
    let values = VertexData {
        dimension: data.dimension,
        values: &data.values,
    };
    let mut timed = following(&PHASES, clock, observer);
    match &case.method {
        Method::Biharmonic(method) => {
            let (options, weights) = biharmonic_options(method, case.seed, &input.mesh)?;
            let target = biharmonic::Target {
                data: values,
                weights: weights.as_deref(),
            };
            let fit = biharmonic::fit(&input.mesh, target, &options, &mut timed)?;
            Ok(Fitted::of_biharmonic(fit, &options))
        }
        Method::LsMesh {
            controls,
            selection,
            constraints,
        } => {
            let options = ls_mesh_options(*controls, *selection, *constraints, &input.mesh)?;
            let fit = ls_mesh::fit(&input.mesh, values, &options, &mut timed)?;
            Ok(Fitted::of_ls_mesh(fit, &options))
        }
        Method::SparseManifold(_)
        | Method::CurveNetwork(_)
        | Method::Chart(_)
        | Method::Trivariate(_)
        | Method::Conformal(_)
        | Method::PowellSabin(_)
        | Method::TSpline(_) => Err(RunError::Task {
            task: "spline over triangles",
            method: case.method.name(),
        }),
    }
}

/// Returns an observer that lets the clock follow some phases of a method.
pub(crate) fn following<'a>(
    phases: &'a [&str],
    clock: &'a mut PhaseClock,
    observer: &'a mut Observer<'_>,
) -> impl FnMut(&Progress) -> ControlFlow<()> + 'a {
    move |progress| {
        if phases.contains(&progress.phase) {
            clock.enter(progress.phase);
        }
        observer(progress)
    }
}

pub(crate) fn count(
    amount: Amount,
    option: &'static str,
    mesh: &TriangleMesh,
) -> Result<usize, RunError> {
    amount
        .of(mesh.vertex_count())
        .map_err(|source| RunError::Amount { option, source })
}

/// Returns the biharmonic method of a case.
///
/// # Errors
/// Another method, which does not have this task.
pub(crate) fn biharmonic_method<'a>(
    case: &'a Case,
    task: &'static str,
) -> Result<&'a BiharmonicMethod, RunError> {
    match &case.method {
        Method::Biharmonic(method) => Ok(method),
        other => Err(RunError::Task {
            task,
            method: other.name(),
        }),
    }
}

/// Returns the options of a fit, and the weights of the vertices where they are given.
pub(crate) fn biharmonic_options(
    method: &BiharmonicMethod,
    seed: u64,
    mesh: &TriangleMesh,
) -> Result<(biharmonic::Options, Option<Vec<f64>>), RunError> {
    let options = biharmonic::Options {
        knots: match &method.knots {
            Knots::Optimised(amount) => biharmonic::KnotChoice::Optimised {
                count: count(*amount, "--knots", mesh)?,
            },
            Knots::All => biharmonic::KnotChoice::All,
            Knots::Auto => biharmonic::KnotChoice::CrossValidated,
            Knots::Near(points) => biharmonic::KnotChoice::Given(nearest_vertices(mesh, points)?),
            Knots::At(points) => biharmonic::KnotChoice::At(nearest_points(mesh, points)?),
        },
        selection: method.selection,
        effort: method.effort,
        polish: method.polish,
        laplacian: method.laplacian,
        creases: match &method.creases {
            CaseCreases::None => biharmonic::CreaseChoice::None,
            CaseCreases::SharperThan(degrees) => {
                biharmonic::CreaseChoice::SharperThan { degrees: *degrees }
            }
            CaseCreases::Along(path) => biharmonic::CreaseChoice::Edges(arrays::edges(path)?),
        },
        seed,
    };
    let weights = match &method.weights {
        Some(weights) => Some(arrays::weights(weights, mesh)?),
        None => None,
    };
    Ok((options, weights))
}

/// Returns the options of a least-squares mesh.
pub(crate) fn ls_mesh_options(
    controls: Amount,
    selection: ls_mesh::Selection,
    constraints: ls_mesh::Constraints,
    mesh: &TriangleMesh,
) -> Result<ls_mesh::Options, RunError> {
    let count = count(controls, "--controls", mesh)?;
    Ok(ls_mesh::Options {
        controls: ls_mesh::ControlChoice::Selected { count },
        selection,
        constraints,
    })
}

impl Fitted {
    pub(crate) fn of_biharmonic(fit: biharmonic::Fit, options: &biharmonic::Options) -> Self {
        let report = fit.report;
        let stored = StoredSpline::Biharmonic(StoredBiharmonic::of(&fit.spline));
        let creases = fit.spline.space().creases().edges();
        let checks = [
            ("knots", json!(stored.knots().len())),
            ("iterations", json!(report.iterations)),
            ("residual", json!(report.residual)),
            ("eliminations", json!(report.eliminations)),
            ("exchanges", json!(report.exchanges[0])),
            ("exchanges_kept", json!(report.exchanges[1])),
            ("polish_rounds", json!(report.polish_rounds[0])),
            ("polish_rounds_kept", json!(report.polish_rounds[1])),
            ("l1_rounds", json!(report.l1_rounds)),
            ("crease_edges", json!(creases.len())),
        ];
        Self {
            stored,
            space: Some(Arc::clone(fit.spline.space())),
            options: json!(options),
            outcome: report.outcome,
            checks: named(checks),
            warnings: report.warnings,
        }
    }

    pub(crate) fn of_ls_mesh(fit: ls_mesh::Fit, options: &ls_mesh::Options) -> Self {
        let report = fit.report;
        let stored = StoredSpline::of_ls_mesh(&fit.spline, options.constraints);
        let checks = [
            ("controls", json!(stored.knots().len())),
            ("iterations", json!(report.iterations)),
            ("residual", json!(report.residual)),
        ];
        Self {
            stored,
            space: None,
            options: json!(options),
            outcome: report.outcome,
            checks: named(checks),
            warnings: report.warnings,
        }
    }
}
