//! Where the axis begins and ends.

use msplines_common::mesh::TriangleMesh;
use nalgebra::{Point3, Vector3};

use super::error::CylinderError;
use super::options::Poles;
use crate::domain::boundary::principal_axes;

/// Returns the two poles.
pub(super) fn find(surface: &TriangleMesh, poles: Poles) -> Result<[u32; 2], CylinderError> {
    let poles = match poles {
        Poles::Extreme => extreme(surface),
        Poles::Pierced => pierced(surface).unwrap_or_else(|| extreme(surface)),
        Poles::Given(poles) => poles,
    };
    let vertices = surface.vertex_count();
    for (pole, &vertex) in poles.iter().enumerate() {
        if vertex as usize >= vertices {
            return Err(CylinderError::NoVertex {
                pole,
                vertex,
                vertices,
            });
        }
    }
    let [a, b] = poles.map(|v| surface.positions()[v as usize]);
    if a == b {
        return Err(CylinderError::SamePole { vertices: poles });
    }
    Ok(poles)
}

/// The extreme vertices along the longest principal axis, the first of several.
fn extreme(surface: &TriangleMesh) -> [u32; 2] {
    let axis = principal_axes(surface)[0];
    let along = |v: u32| axis.dot(&surface.positions()[v as usize].coords);
    let vertices = 0..surface.vertex_count() as u32;
    vertices.fold([0, 0], |[low, high], v| {
        let lower = if along(v) < along(low) { v } else { low };
        let higher = if along(v) > along(high) { v } else { high };
        [lower, higher]
    })
}

/// The vertices nearest to where the longest principal axis enters the surface first and leaves it
/// last; absent if it misses the surface.
fn pierced(surface: &TriangleMesh) -> Option<[u32; 2]> {
    let (axes, centre) = (principal_axes(surface), centre(surface));
    let mut ends: Option<[(f64, u32); 2]> = None;
    for face in 0..surface.face_count() as u32 {
        let corners = surface.triangle(face).map(|p| p - centre);
        let [along, x, y] = axes.map(|axis| corners.map(|p| axis.dot(&p)));
        // Twice the areas that the axis spans with the sides, seen along it.
        let parts = [0, 1, 2].map(|i: usize| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            x[j] * y[k] - x[k] * y[j]
        });
        let whole: f64 = parts.iter().sum();
        if whole == 0.0 || !parts.iter().all(|part| part / whole >= 0.0) {
            continue;
        }
        let at: f64 = (0..3).map(|i| along[i] * parts[i] / whole).sum();
        let nearest = (1..3).fold(0, |best, i| {
            if parts[i] / whole > parts[best] / whole {
                i
            } else {
                best
            }
        });
        let here = (at, surface.faces()[face as usize][nearest]);
        let [first, last] = ends.unwrap_or([here; 2]);
        ends = Some([
            if at < first.0 { here } else { first },
            if at > last.0 { here } else { last },
        ]);
    }
    let ends = ends?.map(|(_, vertex)| vertex);
    (ends[0] != ends[1]).then_some(ends)
}

/// The centre of the area of the surface.
fn centre(surface: &TriangleMesh) -> Point3<f64> {
    let (mut sum, mut total) = (Vector3::zeros(), 0.0);
    for face in 0..surface.face_count() as u32 {
        let area = surface.face_normal(face).norm();
        let corners = surface.triangle(face).map(|p| p.coords);
        sum += corners.iter().sum::<Vector3<f64>>() * (area / 3.0);
        total += area;
    }
    Point3::from(sum / total)
}
