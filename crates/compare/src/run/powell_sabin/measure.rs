//! What is measured of a Powell-Sabin spline.

use std::collections::BTreeMap;

use msplines_common::mesh::TriangleMesh;
use msplines_common::metrics::{Distance, distance};
use msplines_powell_sabin::PowellSabinSurface;
use msplines_powell_sabin::surface::SurfaceChecks;
use serde_json::{Value, json};

use super::tessellation;
use crate::error::RunError;

/// Points drawn from each surface.
const SAMPLES: usize = 100_000;
/// The tessellation is fine enough once halving it changes the root mean square by less than this.
const SETTLED: f64 = 0.01;
/// Nor does halving go beyond so many triangles.
const MOST_TRIANGLES: usize = 2_000_000;

/// Returns the checks of a surface by name.
pub(super) fn surface(checks: &SurfaceChecks) -> BTreeMap<String, Value> {
    let named = [
        ("position_max", json!(checks.position_max)),
        ("normal_max", json!(checks.normal_max)),
        ("c1_jump_max", json!(checks.c1_jump_max)),
        ("c1_jump_max_all", json!(checks.c1_jump_max_all)),
        ("seam_max", json!(checks.seam_max)),
        ("unity_max", json!(checks.unity_max)),
        ("basis_min", json!(checks.basis_min)),
        (
            "orientation_violations",
            json!(checks.orientation_violations),
        ),
        ("folded_samples", json!(checks.folded_samples)),
        ("samples", json!(checks.samples)),
    ];
    named.map(|(name, value)| (name.to_owned(), value)).into()
}

/// Returns the two-sided distance between the surface, halved until that changes little, and a mesh.
pub(super) fn distance_to(
    spline: &PowellSabinSurface,
    mesh: &TriangleMesh,
    seed: u64,
) -> Result<Distance, RunError> {
    let mut segments = 1;
    let mut coarser: Option<Distance> = None;
    loop {
        let found = distance(mesh, &tessellation(spline, segments), SAMPLES, seed)?;
        let settled =
            coarser.is_some_and(|before| (found.rms - before.rms).abs() <= SETTLED * before.rms);
        let finer = 4 * (segments * segments) as usize * spline.mesh().face_count();
        if settled || finer > MOST_TRIANGLES {
            return Ok(found);
        }
        coarser = Some(found);
        segments *= 2;
    }
}
