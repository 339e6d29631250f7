//! Places of knots from files.

use std::path::Path;

use msplines_common::Point3;
use msplines_common::mesh::{SurfacePoint, TriangleMesh, split_at};
use msplines_common::metrics::SurfaceTree;
use msplines_io::read_points;
use rayon::prelude::*;

use super::file_name;
use crate::error::RunError;

/// Returns the vertices of `mesh` nearest to the vertices of the file `points`, in increasing order
/// and each once. Cost: points times vertices.
///
/// # Errors
/// A file that cannot be read, or whose points are not all finite.
pub fn nearest_vertices(mesh: &TriangleMesh, points: &Path) -> Result<Vec<u32>, RunError> {
    let places = knot_places(points)?;
    let nearest = |point: &Point3<f64>| {
        let mut best = (f64::INFINITY, 0);
        for (vertex, position) in mesh.positions().iter().enumerate() {
            let squared = (position - point).norm_squared();
            if squared < best.0 {
                best = (squared, vertex as u32);
            }
        }
        best.1
    };
    let mut vertices: Vec<u32> = places.par_iter().map(nearest).collect();
    vertices.sort_unstable();
    vertices.dedup();
    Ok(vertices)
}

/// Returns the points in a file that are to be the places of knots.
fn knot_places(points: &Path) -> Result<Vec<Point3<f64>>, RunError> {
    let refused = |reason: String| RunError::KnotPoints {
        file: file_name(points),
        reason,
    };
    let places = read_points(points).map_err(|e| refused(e.to_string()))?;
    let finite = |p: &Point3<f64>| p.iter().all(|x| x.is_finite());
    match places.iter().position(|p| !finite(p)) {
        Some(index) => Err(refused(format!("point {index} is not finite"))),
        None => Ok(places),
    }
}

/// Returns the points of the surface nearest to the vertices of the file `points`, each once.
///
/// # Errors
/// A file that cannot be read, or whose points are not all finite.
pub fn nearest_points(mesh: &TriangleMesh, points: &Path) -> Result<Vec<SurfacePoint>, RunError> {
    let places = knot_places(points)?;
    let tree = SurfaceTree::build(mesh);
    let nearest: Vec<SurfacePoint> = places
        .par_iter()
        .filter_map(|place| tree.closest(place).map(|closest| closest.point))
        .collect();
    let split = split_at(mesh, &nearest).map_err(|e| RunError::KnotPoints {
        file: file_name(points),
        reason: e.to_string(),
    })?;
    // Points on two sides of an edge may be the same vertex.
    let mut seen = vec![false; split.mesh.vertex_count()];
    let first = |vertex: u32| !std::mem::replace(&mut seen[vertex as usize], true);
    let kept: Vec<bool> = split.vertices.iter().copied().map(first).collect();
    let pairs = nearest.into_iter().zip(kept);
    Ok(pairs
        .filter_map(|(point, kept)| kept.then_some(point))
        .collect())
}
