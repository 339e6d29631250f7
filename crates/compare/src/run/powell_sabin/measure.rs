//! What is measured of a Powell-Sabin spline.

use msplines_common::mesh::{NONE, SurfacePoint, Topology, TriangleMesh};
use msplines_common::metrics::Distance;
use msplines_powell_sabin::PowellSabinSurface;
use msplines_powell_sabin::surface::SurfaceChecks;
use serde_json::json;

use super::triangles;
use crate::error::RunError;
use crate::measure::{Tessellated, settled_distance};
use crate::record::{Checks, named};

/// The distance is measured to a tessellation of at most so many triangles.
const MOST_TRIANGLES: usize = 2_000_000;

/// Returns the checks of a surface by name.
pub(super) fn surface(checks: &SurfaceChecks) -> Checks {
    named([
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
    ])
}

/// Points along an edge of a rim at which normals are compared.
const ALONG_RIM: u32 = 8;

/// Returns the largest angle in degrees between the normals on both sides of the rims of filled holes;
/// nothing without such holes.
pub(super) fn rim_angle(spline: &PowellSabinSurface) -> Option<f64> {
    let topology = spline.mesh().topology();
    let mut largest: Option<f64> = None;
    for hole in spline.caps() {
        let inside = |half_edge: u32| hole.faces().binary_search(&(half_edge / 3)).is_ok();
        let half_edges = hole.faces().iter().flat_map(|face| 3 * face..3 * face + 3);
        for half_edge in half_edges {
            let twin = topology.twin(half_edge);
            if twin == NONE || inside(twin) {
                continue;
            }
            let points = |h: u32, share: &dyn Fn(u32) -> f64| -> Vec<SurfacePoint> {
                let place = |i: u32| {
                    let mut at = [0.0; 3];
                    at[(h % 3) as usize] = 1.0 - share(i);
                    at[(Topology::next(h) % 3) as usize] = share(i);
                    SurfacePoint { face: h / 3, at }
                };
                (0..=ALONG_RIM).map(place).collect()
            };
            let along = |i: u32| f64::from(i) / f64::from(ALONG_RIM);
            let inner = spline.normals(&points(half_edge, &along));
            let outer = spline.normals(&points(twin, &|i| 1.0 - along(i)));
            // Open holes have none inside.
            let (Ok(inner), Ok(outer)) = (inner, outer) else {
                continue;
            };
            for (a, b) in inner.iter().zip(&outer) {
                let angle = a.cross(b).norm().atan2(a.dot(b)).to_degrees();
                largest = Some(largest.map_or(angle, |before| before.max(angle)));
            }
        }
    }
    largest
}

/// Returns the two-sided distance between the surface and a mesh.
pub(super) fn distance_to(
    spline: &PowellSabinSurface,
    mesh: &TriangleMesh,
    seed: u64,
) -> Result<Distance, RunError> {
    settled_distance(mesh, seed, |rounds| {
        let finer = spline.mesh().face_count() << (2 * rounds + 2);
        Ok(Tessellated {
            mesh: triangles(&spline.tessellate(1 << rounds)),
            is_finest: finer > MOST_TRIANGLES,
        })
    })
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use msplines_common::progress::unobserved;
    use msplines_powell_sabin::{Fill, SurfaceOptions};

    use crate::case::{Case, Input, Method, PowellSabinMethod};
    use crate::generated::GeneratedSurface;
    use crate::run::run;

    #[test]
    fn minimal_surfaces_meet_the_spline_in_an_edge_and_smooth_caps_do_not() {
        let angle = |fill| {
            let method = PowellSabinMethod {
                surface: SurfaceOptions {
                    fill,
                    ..SurfaceOptions::default()
                },
                ..PowellSabinMethod::default()
            };
            let input = Input::Surface(GeneratedSurface::Genus2Small);
            let case = Case::new(input, Method::PowellSabin(Box::new(method)));
            let output = run(&case, Instant::now(), &mut unobserved()).expect("a surface");
            output
                .record
                .checks
                .get("rim_angle")
                .and_then(|angle| angle.as_f64())
        };
        assert_eq!(angle(Fill::Open), None);
        let (minimal, smooth) = (angle(Fill::Minimal), angle(Fill::Smooth));
        let (minimal, smooth) = (minimal.expect("holes"), smooth.expect("holes"));
        // Degrees: rounding of normals against the bending of a face.
        assert!(smooth < 1e-6 && minimal > 0.5, "{smooth} {minimal}");
    }
}
