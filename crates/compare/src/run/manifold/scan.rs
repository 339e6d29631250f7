//! Scans: a control mesh from their decimation, and their closest points as observations.

use msplines_common::Point3;
use msplines_common::mesh::polygon::{PolygonMesh, Sharpness};
use msplines_common::mesh::{TriangleMesh, decimate};
use msplines_common::metrics::SurfaceTree;
use msplines_sparse_manifold::LimitGrid;
use rayon::prelude::*;

use super::Problem;
use super::control::Control;
use crate::case::{Case, Polygons, SparseManifoldMethod};
use crate::clock::PhaseClock;
use crate::error::RunError;
use crate::input;

/// Rounds in which control vertices follow the points that they should lead to.
const FOLLOWS: u32 = 8;

/// Reads a scan and makes its problem: triangles of the decimated scan become quads in one
/// Catmull-Clark step, whose vertices are then moved until their limits lie on the scan; the
/// observations are the points of the scan closest to the limits of the grids.
pub(super) fn load(
    case: &Case,
    method: &SparseManifoldMethod,
    vertices: usize,
    clock: &mut PhaseClock,
) -> Result<Problem, RunError> {
    let loaded = input::load(&case.input, clock)?;
    clock.enter("domain");
    let scan = loaded.mesh;
    let refused = |reason: String| RunError::Input {
        file: loaded.facts.file.clone(),
        reason,
    };
    let light = decimate(&scan, vertices)
        .map_err(|e| refused(e.to_string()))?
        .mesh;
    let offsets = (0..=light.face_count() as u32).map(|f| 3 * f).collect();
    let corners = light.faces().as_flattened().to_vec();
    let polygons = PolygonMesh::build(light.positions().to_vec(), corners, offsets);
    let polygons = polygons.map_err(|e| refused(e.to_string()))?;
    let sharpness = Sharpness::smooth(polygons.topology(), method.rules);
    let quads = SparseManifoldMethod {
        polygons: Polygons::Refine,
        ..method.clone()
    };
    let control = Control::build(polygons, sharpness, &quads).map_err(refused)?;
    let tree = SurfaceTree::build(&scan);
    let mesh = followed(&control, method, &scan, &tree);
    let levels = method.options.levels.min(6);
    let grid = LimitGrid::build(&mesh, &control.sharpness, method.rules, levels);
    let mut observations = grid.observations(mesh.positions());
    observations.points = closest(&scan, &tree, &observations.points);
    let quads_only =
        Control::build(mesh, control.sharpness, method).map_err(|reason| RunError::Input {
            file: loaded.facts.file.clone(),
            reason,
        })?;
    clock.leave();
    Ok(Problem {
        control: quads_only,
        observations,
        scan: Some(scan),
        facts: loaded.facts,
        warnings: loaded.warnings,
    })
}

/// Returns the control mesh after its vertices have moved by what their limits lack to the scan, again
/// and again: the limit of a vertex follows it by about half of its way.
fn followed(
    control: &Control,
    method: &SparseManifoldMethod,
    scan: &TriangleMesh,
    tree: &SurfaceTree,
) -> PolygonMesh {
    let own = LimitGrid::build(&control.mesh, &control.sharpness, method.rules, 0);
    let mut positions = control.mesh.positions().to_vec();
    for _ in 0..FOLLOWS {
        let limits = own.observations(&positions).points;
        let targets = closest(scan, tree, &limits);
        for ((position, limit), target) in positions.iter_mut().zip(&limits).zip(&targets) {
            *position += target - limit;
        }
    }
    control.mesh.with_positions(positions)
}

/// Returns the points of the scan closest to these.
pub(super) fn closest(
    scan: &TriangleMesh,
    tree: &SurfaceTree,
    points: &[Point3<f64>],
) -> Vec<Point3<f64>> {
    let on_scan = |p: &Point3<f64>| {
        tree.closest(p)
            .map_or(*p, |found| scan.position(found.point))
    };
    points.par_iter().map(on_scan).collect()
}
