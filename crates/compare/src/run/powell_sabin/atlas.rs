//! Fits over a conformal atlas.

use msplines_common::progress::{Observer, Outcome};
use msplines_common::{Point3, Vector3};
use msplines_conformal::{AtlasReport, SurfaceAtlas};
use msplines_powell_sabin::surface::{Filled, SurfaceReport};
use msplines_powell_sabin::{Report, VertexCondition, fit_surface};
use serde_json::json;

use super::Produced;
use crate::case::{Case, PowellSabinMethod};
use crate::clock::PhaseClock;
use crate::error::RunError;
use crate::fit::following;
use crate::input::{LoadedInput, vertex_normals};
use crate::record::{Checks, named};
use crate::run::{conformal, enter};

/// Fits a surface through the vertices of the input and their normals.
pub(super) fn fitted(
    input: &LoadedInput,
    case: &Case,
    method: &PowellSabinMethod,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<Produced, RunError> {
    let normals = vertex_normals(input)?;
    let choice = (method.form.as_ref(), &method.puncture[..]);
    let found = conformal::atlas(input, choice, case.seed, observer)?;
    let conditions = conditions(input, &found, &normals.normals);
    enter("fit", clock, observer);
    let fit = {
        let mut timed = following(&["fit"], clock, observer);
        fit_surface(&found.atlas, &conditions, &method.surface, &mut timed)?
    };
    let mut warnings = normals.warnings;
    warnings.extend(about(&found.report, &fit.report));
    Ok(Produced {
        surface: fit.spline,
        conditions,
        marks: conformal::zeros(&found.atlas),
        molecule: Vec::new(),
        outcome: fit.report.regular.outcome,
        checks: checks(&found.report, &fit.report),
        warnings,
        origins: found.origins,
    })
}

/// What the surface does at each vertex of the atlas: it interpolates those of the input.
fn conditions(
    input: &LoadedInput,
    found: &SurfaceAtlas,
    normals: &[Vector3<f64>],
) -> Vec<VertexCondition> {
    let origins = found.origins.iter().copied();
    let added = found.atlas.mesh().positions().iter().copied();
    let condition = |place: (Option<u32>, Point3<f64>)| match place {
        (Some(vertex), _) => VertexCondition::Interpolate {
            position: input.mesh.positions()[vertex as usize],
            normal: normals[vertex as usize],
        },
        // Added vertices lie on the facets; what is free at them is the normal.
        (None, position) => VertexCondition::Position { position },
    };
    origins.zip(added).map(condition).collect()
}

/// Returns what the result should be read with.
fn about(atlas: &AtlasReport, report: &SurfaceReport) -> Vec<String> {
    let mut warnings = Vec::new();
    let added = atlas.added_vertices;
    if added > 0 {
        warnings.push(format!(
            "the mesh was too coarse for its atlas: {added} vertices were added on its faces, whose normals are free"
        ));
    }
    warnings.extend(report.warnings.iter().map(ToString::to_string));
    if report.regular.outcome != Outcome::Converged {
        let left = report.regular.violations_after;
        warnings.push(format!(
            "the repair of orientations ended with {left} vertices inside out"
        ));
    }
    warnings
}

fn checks(atlas: &AtlasReport, report: &SurfaceReport) -> Checks {
    let filled = |which: fn(&Filled) -> bool| {
        json!(
            report
                .holes
                .iter()
                .filter(|hole| which(&hole.filled))
                .count()
        )
    };
    let mut checks = named([
        ("genus", json!(atlas.genus)),
        ("zeros", json!(atlas.zeros)),
        ("flips", json!(atlas.flips)),
        ("conformal_k_mean", json!(atlas.distortion.angle_mean)),
        ("conformal_k_p50", json!(atlas.distortion.angle_p50)),
        ("added_vertices", json!(atlas.added_vertices)),
        ("holes", json!(report.holes.len())),
        (
            "smooth_caps",
            filled(|f| matches!(f, Filled::Smooth { .. })),
        ),
        (
            "minimal_caps",
            filled(|f| matches!(f, Filled::Minimal { .. })),
        ),
    ]);
    checks.extend(of_fit(&report.regular));
    checks
}

/// Returns what a fit says of itself.
pub(super) fn of_fit(report: &Report) -> Checks {
    named([
        ("violations_before", json!(report.violations_before)),
        ("repair_rounds", json!(report.repair_rounds)),
        ("residual", json!(report.residual)),
        ("unknowns", json!(report.unknowns)),
    ])
}
