//! From a case to a fitted spline in its stored form, whatever the method.

use std::collections::BTreeMap;

use msplines_biharmonic as biharmonic;
use msplines_common::evaluate::VertexData;
use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::{Observer, Outcome, Progress};
use msplines_ls_mesh as ls_mesh;
use serde_json::{Value, json};

use crate::case::{Amount, Case, Knots, Method};
use crate::clock::PhaseClock;
use crate::error::RunError;
use crate::input::{FitData, LoadedInput, nearest_vertices};
use crate::spline_file::StoredSpline;

/// Phases of a fit that a record tells apart.
const PHASES: [&str; 3] = ["domain", "select", "fit"];

/// What a method gave, before it is measured.
pub(crate) struct Fitted {
    /// The spline.
    pub(crate) stored: StoredSpline,
    /// All options of the method.
    pub(crate) options: Value,
    /// How the fit ended.
    pub(crate) outcome: Outcome,
    /// Flat values of the method.
    pub(crate) checks: BTreeMap<String, Value>,
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
    let mut timed = |progress: &Progress| {
        if PHASES.contains(&progress.phase) {
            clock.enter(progress.phase);
        }
        observer(progress)
    };
    let count = |amount: &Amount, option: &'static str| {
        let vertices = input.mesh.vertex_count();
        amount
            .of(vertices)
            .map_err(|source| RunError::Amount { option, source })
    };
    match &case.method {
        Method::Biharmonic {
            knots,
            effort,
            laplacian,
        } => {
            let options = biharmonic::Options {
                knots: match knots {
                    Knots::Optimised(amount) => biharmonic::KnotChoice::Optimised {
                        count: count(amount, "--knots")?,
                    },
                    Knots::All => biharmonic::KnotChoice::All,
                    Knots::Near(points) => {
                        biharmonic::KnotChoice::Given(nearest_vertices(&input.mesh, points)?)
                    }
                },
                effort: *effort,
                laplacian: *laplacian,
                seed: case.seed,
            };
            fit_biharmonic(&input.mesh, values, &options, &mut timed)
        }
        Method::LsMesh {
            controls,
            selection,
            constraints,
        } => {
            let count = count(controls, "--controls")?;
            let options = ls_mesh::Options {
                controls: ls_mesh::ControlChoice::Selected { count },
                selection: *selection,
                constraints: *constraints,
            };
            fit_ls_mesh(&input.mesh, values, &options, &mut timed)
        }
    }
}

fn fit_biharmonic(
    mesh: &TriangleMesh,
    values: VertexData<'_>,
    options: &biharmonic::Options,
    observer: &mut Observer<'_>,
) -> Result<Fitted, RunError> {
    let fit = biharmonic::fit(mesh, values, options, observer)?;
    let report = fit.report;
    let stored = StoredSpline::of_biharmonic(&fit.spline, options.laplacian);
    let checks = [
        ("knots", json!(stored.knots().len())),
        ("iterations", json!(report.iterations)),
        ("residual", json!(report.residual)),
        ("eliminations", json!(report.eliminations)),
        ("exchanges", json!(report.exchanges[0])),
        ("exchanges_kept", json!(report.exchanges[1])),
    ];
    Ok(Fitted {
        stored,
        options: json!(options),
        outcome: report.outcome,
        checks: named(checks),
        warnings: report.warnings,
    })
}

fn fit_ls_mesh(
    mesh: &TriangleMesh,
    values: VertexData<'_>,
    options: &ls_mesh::Options,
    observer: &mut Observer<'_>,
) -> Result<Fitted, RunError> {
    let fit = ls_mesh::fit(mesh, values, options, observer)?;
    let report = fit.report;
    let stored = StoredSpline::of_ls_mesh(&fit.spline, options.constraints);
    let checks = [
        ("controls", json!(stored.knots().len())),
        ("iterations", json!(report.iterations)),
        ("residual", json!(report.residual)),
    ];
    Ok(Fitted {
        stored,
        options: json!(options),
        outcome: report.outcome,
        checks: named(checks),
        warnings: report.warnings,
    })
}

fn named<const N: usize>(checks: [(&str, Value); N]) -> BTreeMap<String, Value> {
    checks
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}
