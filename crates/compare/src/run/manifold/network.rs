//! Runs of surfaces over curve networks.

use std::collections::BTreeMap;

use msplines_io::{read_curves, sha256_file};
use msplines_sparse_manifold::Tessellator;
use msplines_sparse_manifold::network::{NetworkFit, surface_network};
use serde_json::{Value, json};

use super::{check, facts, triangles};
use crate::case::{Case, CurveNetworkMethod, Input};
use crate::clock::{PhaseClock, process_usage};
use crate::error::RunError;
use crate::fit::following;
use crate::input::{file_name, unreadable};
use crate::output::write_outputs;
use crate::record::{InputFacts, InputKind, RUN_SCHEMA, Record, Seconds, Tool};
use crate::run::{RunOutput, check_finite, enter};
use crate::spline_file::{SplineFile, StoredDomain, StoredManifold, StoredPolygons, StoredSpline};
use msplines_common::progress::Observer;

/// Runs a case whose method is a surface over a curve network.
pub(in crate::run) fn run(
    case: &Case,
    method: &CurveNetworkMethod,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    check(case)?;
    clock.enter("read");
    let Input::File { path, .. } = &case.input else {
        return Err(RunError::Task {
            task: "fit of a generated surface",
            method: case.method.name(),
        });
    };
    let file = file_name(path);
    let refused = |reason: String| RunError::Input {
        file: file.clone(),
        reason,
    };
    let sha256 = sha256_file(path).map_err(|e| refused(unreadable(&e)))?;
    let network = read_curves(path).map_err(|e| refused(e.to_string()))?;
    enter("domain", clock, observer);
    let fit = {
        let mut timed = following(&["fit"], clock, observer);
        surface_network(&network, &method.options, &mut timed)?
    };
    let mesh = fit.spline.mesh();
    let mut options = json!(method.options);
    options["cells"] = json!(method.cells);
    let domain = StoredDomain::Polygons {
        polygons: StoredPolygons::of(mesh),
    };
    let stored = StoredSpline::SparseManifold(StoredManifold::of(&fit.spline));
    let spline = SplineFile::new(domain, options, stored);
    let restored = spline.spline.manifold("evaluation")?.restore(mesh)?;
    enter("evaluate", clock, observer);
    let surface = Tessellator::build(&restored, method.cells.max(1)).surface(&restored);
    let values: Vec<f64> = surface
        .positions
        .iter()
        .flat_map(|p| [p.x, p.y, p.z])
        .collect();
    check_finite(&values, 3)?;
    let tessellated = triangles(&surface)?;
    enter("write", clock, observer);
    let names = ["x", "y", "z"].map(str::to_owned).to_vec();
    write_outputs(&case.outputs, &spline, &tessellated, &values, &names, &[])?;
    clock.leave();
    let mut record = record(case, &fit, &spline, facts(mesh, file, sha256));
    record.seconds = clock.read();
    record.peak_rss_bytes = process_usage().peak_rss_bytes;
    Ok(RunOutput {
        record,
        companions: Vec::new(),
        spline,
        mesh: tessellated,
        values,
        names,
        fields: Vec::new(),
        knots: Vec::new(),
        frames: Vec::new(),
    })
}

fn record(case: &Case, fit: &NetworkFit, spline: &SplineFile, facts: InputFacts) -> Record {
    let mesh = fit.spline.mesh();
    let mut warnings = fit.cycles.report.warnings.clone();
    warnings.extend(fit.report.warnings.iter().cloned());
    Record {
        schema: RUN_SCHEMA.to_owned(),
        tool: Tool::this(),
        method: case.method.name().to_owned(),
        input: InputFacts {
            kind: InputKind::Curves,
            ..facts
        },
        options: spline.options.clone(),
        outcome: fit.report.outcome,
        dofs: fit.spline.coefficient_count() as u64,
        domain_bytes: (24 * mesh.vertex_count() + 4 * mesh.topology().half_edge_count()) as u64,
        error: None,
        error_unit_cube: None,
        distance: None,
        checks: checks(fit),
        seconds: Seconds::default(),
        peak_rss_bytes: 0,
        threads: rayon::current_num_threads(),
        seed: case.seed,
        warnings,
    }
}

/// Distances in mean arc lengths, angles in degrees.
fn checks(fit: &NetworkFit) -> BTreeMap<String, Value> {
    let (report, cycles) = (&fit.report, &fit.cycles.report);
    let checks = [
        ("charts", json!(report.charts)),
        ("patches", json!(cycles.patches)),
        ("openings", json!(cycles.holes)),
        (
            "euler_characteristic",
            json!(cycles.euler.iter().sum::<i64>()),
        ),
        ("curve_rms", json!(report.curve_rms)),
        ("curve_max", json!(report.curve_max)),
        ("kink_mean_degrees", json!(report.kink_mean_degrees)),
        ("kink_max_degrees", json!(report.kink_max_degrees)),
        ("turn_mean_degrees", json!(report.turn_mean_degrees)),
        ("turn_max_degrees", json!(report.turn_max_degrees)),
        ("c0_atoms_crease", json!(report.c0_atoms_crease)),
        ("c0_atoms_smooth", json!(report.c0_atoms_smooth)),
        ("fill_rounds", json!(report.fill_rounds)),
    ];
    let named = checks.map(|(name, value)| (name.to_owned(), value));
    named.into_iter().collect()
}
