//! What can be said about a mesh in numbers.

use nalgebra::Point3;
use serde::{Deserialize, Serialize};

use super::topology::NONE;
use super::triangle::TriangleMesh;

/// Smallest, mean and largest of a set of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Range {
    /// Smallest.
    pub min: f64,
    /// Arithmetic mean.
    pub mean: f64,
    /// Largest.
    pub max: f64,
}

impl Range {
    pub(super) fn of(values: impl Iterator<Item = f64>) -> Self {
        let (mut min, mut max, mut sum, mut count) = (f64::INFINITY, f64::NEG_INFINITY, 0.0, 0.0);
        for value in values {
            min = value.min(min);
            max = value.max(max);
            sum += value;
            count += 1.0;
        }
        Self {
            min,
            mean: sum / count,
            max,
        }
    }
}

/// Counts, topology and sizes of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Facts {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of edges.
    pub edges: usize,
    /// Number of faces.
    pub faces: usize,
    /// Number of connected components.
    pub components: u32,
    /// Number of handles; `None` if there are several components.
    pub genus: Option<u32>,
    /// Number of boundary loops.
    pub boundary_loops: usize,
    /// Smallest and largest corner of the axis-parallel bounding box.
    pub bounding_box: [[f64; 3]; 2],
    /// Diagonal of the bounding box.
    pub diagonal: f64,
    /// Area of all faces.
    pub area: f64,
    /// Enclosed volume, positive if normals point outwards; `None` if there is a boundary.
    pub volume: Option<f64>,
    /// Lengths of edges.
    pub edge_length: Range,
    /// Angles of faces at their corners, in radians.
    pub angle: Range,
    /// Numbers of neighbours of vertices.
    pub valence: Range,
}

impl Facts {
    /// Returns the facts of a mesh, in O(n).
    ///
    /// Lengths are those of the file; sums are taken about the centre of the bounding box, so that
    /// a mesh far from the origin loses no digits.
    #[must_use]
    pub fn measure(mesh: &TriangleMesh) -> Self {
        let topology = mesh.topology();
        let (_, components) = topology.components();
        let boundary_loops = topology.boundary_loops().len();
        let handles = 2 - topology.euler_characteristic() - boundary_loops as i64;
        let [low, high] = mesh.bounding_box();
        let length = |edge: u32| {
            let [a, b] = topology
                .edge_vertices(edge)
                .map(|v| mesh.positions()[v as usize]);
            (b - a).norm()
        };
        let faces = 0..mesh.face_count() as u32;
        Self {
            vertices: mesh.vertex_count(),
            edges: topology.edge_count(),
            faces: mesh.face_count(),
            components,
            genus: (components == 1).then_some((handles / 2) as u32),
            boundary_loops,
            bounding_box: [low, high].map(|p| p.coords.data.0[0]),
            diagonal: mesh.diagonal(),
            area: faces
                .clone()
                .map(|f| 0.5 * mesh.face_normal(f).norm())
                .sum(),
            volume: (boundary_loops == 0).then(|| volume(mesh, nalgebra::center(&low, &high))),
            edge_length: Range::of((0..topology.edge_count() as u32).map(length)),
            angle: Range::of(faces.flat_map(|f| angles(&mesh.triangle(f)))),
            valence: Range::of(
                (0..mesh.vertex_count() as u32).map(|v| topology.neighbours(v).count() as f64),
            ),
        }
    }
}

/// Returns the angles of a triangle at its corners, in radians.
pub(super) fn angles(corners: &[Point3<f64>; 3]) -> [f64; 3] {
    std::array::from_fn(|i| {
        let (u, v) = (
            corners[(i + 1) % 3] - corners[i],
            corners[(i + 2) % 3] - corners[i],
        );
        // The arc tangent keeps the digits of small angles, which the arc cosine loses.
        u.cross(&v).norm().atan2(u.dot(&v))
    })
}

fn volume(mesh: &TriangleMesh, centre: Point3<f64>) -> f64 {
    debug_assert!((0..3 * mesh.face_count() as u32).all(|h| mesh.topology().twin(h) != NONE));
    let six_fold: f64 = (0..mesh.face_count() as u32)
        .map(|f| {
            let [a, b, c] = mesh.triangle(f).map(|p| p - centre);
            a.dot(&b.cross(&c))
        })
        .sum();
    six_fold / 6.0
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

    use super::*;
    use crate::mesh::shapes;

    #[test]
    fn facts_of_a_right_triangle_are_exact() {
        let p = [[1e9, 0.0, 0.0], [1e9 + 1.0, 0.0, 0.0], [1e9, 1.0, 0.0]].map(Point3::from);
        let Ok(mesh) = TriangleMesh::build(p.to_vec(), vec![[0, 1, 2]]) else {
            panic!()
        };
        let facts = Facts::measure(&mesh);
        assert_eq!((facts.vertices, facts.edges, facts.faces), (3, 3, 1));
        assert_eq!(
            (facts.genus, facts.boundary_loops, facts.volume),
            (Some(0), 1, None)
        );
        assert_eq!((facts.area, facts.valence.max), (0.5, 2.0));
        assert!((facts.angle.max - FRAC_PI_2).abs() < 1e-15);
        assert!((facts.angle.min - FRAC_PI_4).abs() < 1e-15);
    }

    #[test]
    fn sizes_of_sphere_and_torus_approach_the_closed_forms() {
        /// A mesh of edge length h inscribed in a unit curvature surface falls short by O(h²).
        const FLATTENING: f64 = 5e-3;
        let sphere = Facts::measure(&shapes::sphere(4000));
        assert_eq!(sphere.genus, Some(0));
        assert!((sphere.area / (4.0 * PI) - 1.0).abs() < FLATTENING);
        assert!((sphere.volume.unwrap_or(0.0) / (4.0 / 3.0 * PI) - 1.0).abs() < FLATTENING);
        let torus = Facts::measure(&shapes::torus(2.0, 1.0, 4000));
        assert_eq!(torus.genus, Some(1));
        assert!((torus.area / (8.0 * PI * PI) - 1.0).abs() < FLATTENING);
        assert!((torus.volume.unwrap_or(0.0) / (4.0 * PI * PI) - 1.0).abs() < FLATTENING);
    }
}
