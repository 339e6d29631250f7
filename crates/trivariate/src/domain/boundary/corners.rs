//! Eight corners found on a surface: its extreme points in the directions of a turned box.

use msplines_common::mesh::TriangleMesh;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// How a box is laid around a surface, whose corners attract those of the cube.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Frame {
    /// By how much it is turned about the main axis of the surface, in degrees.
    pub turn: f64,
    /// How much a corner should be extreme along all three axes alike, rather than along one.
    pub evenness: f64,
}

/// Corners nearer to each other than this fraction of the diagonal are avoided.
const APART: f64 = 0.05;

/// Returns the vertices of a surface that lie farthest towards the corners of a box.
///
/// Coordinates are measured from the centre of the box in half its sides. The same surface moved
/// gives the same vertices, up to ties. Cost: O(vertices).
///
/// # Panics
/// If the surface has less than eight vertices.
#[must_use]
pub fn find_corners(surface: &TriangleMesh, frame: Frame) -> [u32; 8] {
    assert!(surface.vertex_count() >= 8, "a vertex for each corner");
    let coordinates = box_coordinates(surface, frame.turn);
    let apart = APART * surface.diagonal();
    let mut corners: Vec<u32> = Vec::with_capacity(8);
    for corner in 0..8usize {
        let score = |coordinates: &[f64; 3]| {
            let along: [f64; 3] = std::array::from_fn(|axis| {
                if corner >> axis & 1 == 1 {
                    coordinates[axis]
                } else {
                    -coordinates[axis]
                }
            });
            let mean = along.iter().sum::<f64>() / 3.0;
            let variance = along.iter().map(|a| (a - mean) * (a - mean)).sum::<f64>() / 3.0;
            3.0 * mean - frame.evenness * variance
        };
        let best = |least: f64| {
            let far_enough = |vertex: &u32| {
                let position = surface.positions()[*vertex as usize];
                let distance =
                    |&other: &u32| (surface.positions()[other as usize] - position).norm();
                !corners.contains(vertex) && corners.iter().all(|other| distance(other) >= least)
            };
            let vertices = (0..surface.vertex_count() as u32).filter(far_enough);
            let scored = vertices.map(|vertex| (score(&coordinates[vertex as usize]), vertex));
            // The first of those of equal score.
            scored
                .reduce(|a, b| if b.0 > a.0 { b } else { a })
                .map(|best| best.1)
        };
        corners.extend(best(apart).or_else(|| best(0.0)));
    }
    std::array::from_fn(|corner| corners[corner])
}

/// Returns the coordinates of every vertex in the turned box, -1 to 1 along each axis.
fn box_coordinates(surface: &TriangleMesh, turn: f64) -> Vec<[f64; 3]> {
    let axes = principal_axes(surface);
    let (sine, cosine) = turn.to_radians().sin_cos();
    let turned = [
        axes[0],
        cosine * axes[1] + sine * axes[2],
        cosine * axes[2] - sine * axes[1],
    ];
    let mut coordinates: Vec<[f64; 3]> = surface
        .positions()
        .iter()
        .map(|p| turned.map(|axis| axis.dot(&p.coords)))
        .collect();
    for axis in 0..3 {
        let values = coordinates.iter().map(|c| c[axis]);
        let low = values.clone().fold(f64::INFINITY, f64::min);
        let high = values.fold(f64::NEG_INFINITY, f64::max);
        let half = (0.5 * (high - low)).max(f64::MIN_POSITIVE);
        coordinates
            .iter_mut()
            .for_each(|c| c[axis] = (c[axis] - 0.5 * (low + high)) / half);
    }
    coordinates
}

/// Returns the principal axes of the area, the longest first, right-handed.
pub(crate) fn principal_axes(surface: &TriangleMesh) -> [Vector3<f64>; 3] {
    let faces = || {
        (0..surface.face_count() as u32).map(|face| {
            let [a, b, c] = surface.triangle(face).map(|p| p.coords);
            (0.5 * surface.face_normal(face).norm(), [a, b, c])
        })
    };
    let area: f64 = faces().map(|face| face.0).sum();
    let centre: Vector3<f64> = faces()
        .map(|(area, [a, b, c])| (a + b + c) * (area / 3.0))
        .sum();
    let centre = centre / area.max(f64::MIN_POSITIVE);
    let spread: Matrix3<f64> = faces()
        .map(|(area, corners)| {
            let arms = corners.map(|p| p - centre);
            let sum: Vector3<f64> = arms.iter().sum();
            let squares: Matrix3<f64> = arms.iter().map(|arm| arm * arm.transpose()).sum();
            (squares + sum * sum.transpose()) * (area / 12.0)
        })
        .sum();
    let eigen = SymmetricEigen::new(spread);
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| eigen.eigenvalues[j].total_cmp(&eigen.eigenvalues[i]));
    let axes = order.map(|i| eigen.eigenvectors.column(i).into_owned());
    // The sign of an axis is that of the third moment along it.
    let [first, second] = [axes[0], axes[1]].map(|axis| {
        let third: f64 = faces()
            .flat_map(|(area, corners)| corners.map(|p| area * axis.dot(&(p - centre)).powi(3)))
            .sum();
        if third < 0.0 { -axis } else { axis }
    });
    [first, second, first.cross(&second)]
}

#[cfg(test)]
mod tests {
    use msplines_common::mesh::shapes::box_solid;

    use super::*;

    #[test]
    fn the_corners_of_a_box_are_found() {
        let mesh = box_solid([4, 3, 2]).boundary();
        let corners = find_corners(
            &mesh,
            Frame {
                turn: 0.0,
                evenness: 0.15,
            },
        );
        for vertex in corners {
            let p = mesh.positions()[vertex as usize];
            for (x, side) in p.iter().zip([4.0, 3.0, 2.0]) {
                assert!(*x == 0.0 || *x == side, "{p}");
            }
        }
        // Right-handed, along the sides.
        let p = corners.map(|v| mesh.positions()[v as usize]);
        let volume = (p[1] - p[0]).dot(&(p[2] - p[0]).cross(&(p[4] - p[0])));
        assert!((volume - 24.0).abs() < 1e-12, "{volume}");
    }
}
