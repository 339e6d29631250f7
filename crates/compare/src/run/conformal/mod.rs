//! Runs of conformal atlases: from a surface to its flat charts, and what is known about them.

mod texture;
mod write;

use msplines_common::Point3;
use msplines_common::progress::Observer;
use msplines_conformal::measure::Stretch;
use msplines_conformal::{Atlas, AtlasOptions, AtlasReport, SurfaceAtlas};
use serde_json::{Value, json};

use super::{RunOutput, enter, prepared, steps};
use crate::atlas_file::AtlasFile;
use crate::case::{Case, ConformalMethod, Data, Form, Task};
use crate::clock::PhaseClock;
use crate::error::{AtlasError, RunError};
use crate::input::{LoadedInput, load};
use crate::record::{Checks, Record, named};

pub(crate) use texture::CHECKERS;

/// Faces with a larger ratio of singular values count as stretched: needles where there were triangles.
const STRETCHED: f64 = 10.0;

/// Runs a case whose method is a conformal atlas.
pub(super) fn run(
    case: &Case,
    method: &ConformalMethod,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    check(case)?;
    let input = prepared(load(&case.input, clock)?, case)?;
    enter("domain", clock, observer);
    let choice = (method.form.as_ref(), &method.puncture[..]);
    let found = atlas(&input, choice, case.seed, observer)?;
    let atlas = &found.atlas;
    enter("evaluate", clock, observer);
    let stretches = texture::stretches(atlas);
    let texture = texture::texture(atlas, &stretches);
    let options = options(case, method);
    let digest = input.facts.sha256.clone();
    let file = AtlasFile::new(digest, options.clone(), &found);
    enter("write", clock, observer);
    write::write(&case.outputs, &file, atlas.mesh(), &texture)?;
    let mesh = atlas.mesh().clone();
    let mut warnings = input.warnings.clone();
    let added = found.report.added_vertices;
    if added > 0 {
        let count = found.report.rounds;
        warnings.push(format!(
            "the mesh was too coarse: {added} vertices were added in {count} rounds of local refinement"
        ));
    }
    let mut record = Record {
        domain_bytes: steps::triangle_bytes(&mesh),
        checks: checks(&found.report, &stretches),
        warnings,
        ..Record::start("conformal", input.facts.clone(), options, case.seed)
    };
    steps::finish(&mut record, clock);
    Ok(RunOutput {
        knots: zeros(atlas),
        texture: Some(texture),
        ..RunOutput::of_surface(record, None, mesh)
    })
}

/// Returns the atlas of an input.
///
/// # Errors
/// A form of a surface that leaves no choice, what the surface has no atlas for, or a time limit that
/// is over.
pub(super) fn atlas(
    input: &LoadedInput,
    (form, puncture): (Option<&Form>, &[u32]),
    seed: u64,
    observer: &mut Observer<'_>,
) -> Result<SurfaceAtlas, AtlasError> {
    if let (Some(form), Some(0)) = (form, input.facts.genus) {
        let form = form.to_string();
        return Err(AtlasError::NoChoice { form });
    }
    let form = form.unwrap_or(&Form::Optimal).choice(seed);
    let puncture = puncture.to_vec();
    Ok(Atlas::of_surface(
        &input.mesh,
        &AtlasOptions { form, puncture },
        observer,
    )?)
}

/// Tasks, data and options that mean nothing here are refused, and outputs before any work.
fn check(case: &Case) -> Result<(), RunError> {
    let refused = |what, remedy| Err(RunError::without("a conformal atlas", what, remedy));
    if case.task != Task::Fit {
        return refused("task of a spline", "leave it out");
    }
    if case.data != Data::Positions {
        return refused("data at its vertices", "leave them out");
    }
    if case.subdivide > 0 || case.measure_distance || case.reference.is_some() {
        return refused("surface of its own", "leave out subdivision and distances");
    }
    write::check(&case.outputs)
}

fn options(case: &Case, method: &ConformalMethod) -> Value {
    let form = method.form.clone().unwrap_or_default();
    json!({
        "form": form,
        "puncture": method.puncture,
        "seed": case.seed,
        "refine": case.refine,
        "double_cover": case.double_cover,
        "repair": case.input.is_mended(),
    })
}

fn checks(report: &AtlasReport, stretches: &[(Stretch, f64)]) -> Checks {
    let distortion = &report.distortion;
    let stretched = stretches.iter().filter(|(s, _)| s.anisotropy > STRETCHED);
    named([
        ("genus", json!(report.genus)),
        ("zeros", json!(report.zeros)),
        ("flips", json!(report.flips)),
        ("conformal_k_mean", json!(distortion.angle_mean)),
        ("conformal_k_p50", json!(distortion.angle_p50)),
        ("conformal_k_p99", json!(distortion.angle_p99)),
        ("stretched_faces", json!(stretched.count())),
        ("scale_spread", json!(distortion.scale_spread)),
        ("closedness", json!(report.closedness)),
        ("co_closedness", json!(report.co_closedness)),
        ("conjugation_defect", json!(report.conjugation_defect)),
        ("log_variance", json!(report.log_variance)),
        ("added_vertices", json!(report.added_vertices)),
        ("rounds", json!(report.rounds)),
    ])
}

/// Returns the places of the zeros, each the mean of the vertices that it lies between.
pub(super) fn zeros(atlas: &Atlas) -> Vec<Point3<f64>> {
    let positions = atlas.mesh().positions();
    let zeros = atlas.zeros().iter().filter(|zero| zero.order > 0);
    let mean = |vertices: &[u32]| {
        let sum = vertices.iter().map(|&v| positions[v as usize].coords);
        Point3::from(sum.sum::<msplines_common::Vector3<f64>>() / vertices.len() as f64)
    };
    zeros.map(|zero| mean(&zero.vertices)).collect()
}
