//! Where on a surface paths should run.

use msplines_common::mesh::TriangleMesh;
use msplines_common::operators::mesh_operators;
use nalgebra::Vector3;

/// How often curvature is averaged over neighbours.
const SMOOTHINGS: usize = 4;

/// Returns how much longer ground counts at every vertex: 1 on ridges, `1 + penalty` in valleys.
///
/// An edge of the cube laid through a valley has to be bent the wrong way.
pub(super) fn concavity(surface: &TriangleMesh, penalty: f64) -> Vec<f64> {
    if penalty == 0.0 {
        return vec![1.0; surface.vertex_count()];
    }
    let mut curvature = mean_curvature(surface);
    for _ in 0..SMOOTHINGS {
        curvature = (0..surface.vertex_count() as u32)
            .map(|vertex| {
                let around = surface.topology().neighbours(vertex);
                let (sum, count) = around.fold((0.0, 0.0), |(sum, count), other| {
                    (sum + curvature[other as usize], count + 1.0)
                });
                0.5 * curvature[vertex as usize] + 0.5 * sum / count
            })
            .collect();
    }
    curvature
        .iter()
        .map(|h| 1.0 + penalty / (1.0 + h.exp()))
        .collect()
}

/// Returns the mean curvature times the radius of the sphere of the same area; convex is positive.
fn mean_curvature(surface: &TriangleMesh) -> Vec<f64> {
    let operators = mesh_operators(surface);
    let faces = 0..surface.face_count() as u32;
    let area: f64 = faces
        .map(|face| 0.5 * surface.face_normal(face).norm())
        .sum();
    let radius = (area / (4.0 * std::f64::consts::PI)).sqrt();
    (0..surface.vertex_count())
        .map(|vertex| {
            let column = operators.laplacian.column(vertex);
            let flow: Vector3<f64> = column
                .map(|(other, entry)| surface.positions()[other].coords * entry)
                .sum();
            let half_edges = surface.topology().outgoing(vertex as u32);
            let normal: Vector3<f64> = half_edges.map(|h| surface.face_normal(h / 3)).sum();
            let normal = normal.try_normalize(0.0).unwrap_or_default();
            let curvature = 0.5 * flow.dot(&normal) / operators.mass[vertex];
            if curvature.is_finite() {
                radius * curvature
            } else {
                0.0
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use msplines_common::mesh::shapes;

    use super::*;

    #[test]
    fn a_sphere_has_curvature_one() {
        let sphere = shapes::sphere(2000);
        for h in mean_curvature(&sphere) {
            assert!((h - 1.0).abs() < 0.1, "{h}");
        }
        let ground = concavity(&sphere, 4.0);
        let expected = 1.0 + 4.0 / (1.0 + 1f64.exp());
        assert!(ground.iter().all(|g| (g - expected).abs() < 0.1));
    }
}
