//! Points of a surface that a T-spline is fitted to.
//!
//! Vertices alone leave a spline free between them: on large facets of a coarse mesh, and wherever a
//! T-mesh becomes finer than the mesh. Faces that are large for the number of control points are
//! sampled inside too.
//!
//! # Notation
//! `A` the area of the surface, `n` the number of samples it should have, `h = √(A / n)` their spacing. A
//! face whose longest side is `e` gets `m²` points, the centres of equal parts, `m = ⌊e / (1.5 h)⌋`. In a
//! regular mesh of `n` vertices `e = 1.07 h`, so that none is added to it.

use msplines_common::Point3;
use msplines_common::mesh::{SurfacePoint, TriangleMesh};
use msplines_common::metrics::SurfaceTree;
use rayon::prelude::*;

use crate::domain::Domain;
use crate::fit::Sample;
use crate::surface::TSplineSurface;

/// Weight of what lies between vertices, beside theirs.
const IN_FACES: f64 = 0.25;

/// Sides longer than this many spacings have points between their ends.
const LONG: f64 = 1.5;

/// Most points along the side of a face.
const MOST: f64 = 32.0;

impl TSplineSurface {
    /// Returns points inside of faces of [`Domain::mesh`] that are too large for `wanted` samples to be as
    /// dense everywhere, put onto `surface`, of which edges may have been flipped. They weigh as much as
    /// the vertices of a part as large, and errors are not measured at them; there are none in closed holes.
    /// O(n log n).
    #[must_use]
    pub fn face_samples(domain: &Domain, surface: &TriangleMesh, wanted: usize) -> Vec<Sample> {
        let mesh = domain.mesh();
        let areas: Vec<f64> = (0..mesh.face_count() as u32)
            .map(|face| area_of(mesh, face))
            .collect();
        let area: f64 = areas.iter().sum();
        let vertices = mesh.vertex_count();
        let spacing = (area / wanted.max(vertices) as f64).sqrt();
        let per_vertex = area / vertices as f64;
        let parts = |face: u32| {
            if domain.outside().binary_search(&face).is_ok() {
                return 0;
            }
            let corners = mesh.triangle(face);
            let side = |i: usize| (corners[(i + 1) % 3] - corners[i]).norm();
            let longest = side(0).max(side(1)).max(side(2));
            (longest / (LONG * spacing)).floor().min(MOST) as u32
        };
        let tree = SurfaceTree::build(surface);
        let sampled: Vec<Vec<Sample>> = (0..mesh.face_count() as u32)
            .into_par_iter()
            .map(|face| {
                let parts = parts(face);
                let weight =
                    IN_FACES * areas[face as usize] / (f64::from(parts * parts) * per_vertex);
                let points = centres(parts).map(|at| SurfacePoint { face, at });
                let sample = |point: SurfacePoint| Sample {
                    weight,
                    measured: false,
                    ..Sample::vertex(
                        domain.place(&point),
                        onto(surface, &tree, mesh.position(point)),
                    )
                };
                points.map(sample).collect()
            })
            .collect();
        sampled.into_iter().flatten().collect()
    }
}

fn area_of(mesh: &TriangleMesh, face: u32) -> f64 {
    let [a, b, c] = mesh.triangle(face);
    0.5 * (b - a).cross(&(c - a)).norm()
}

fn onto(surface: &TriangleMesh, tree: &SurfaceTree, point: Point3<f64>) -> Point3<f64> {
    tree.closest(&point)
        .map_or(point, |found| surface.position(found.point))
}

/// Returns the barycentric coordinates of the centres of `n²` equal parts of a triangle.
fn centres(n: u32) -> impl Iterator<Item = [f64; 3]> {
    let third = 1.0 / 3.0;
    let at = move |i: u32, j: u32, offset: f64| {
        let [b, c] = [i, j].map(|k| (f64::from(k) + offset) / f64::from(n));
        [1.0 - b - c, b, c]
    };
    (0..n).flat_map(move |j| {
        let upright = (0..n - j).map(move |i| at(i, j, third));
        let turned = (0..(n - j).saturating_sub(1)).map(move |i| at(i, j, 2.0 * third));
        upright.chain(turned)
    })
}

#[cfg(test)]
mod tests {
    use msplines_common::mesh::shapes;
    use msplines_common::progress::unobserved;

    use super::*;
    use crate::domain::DomainOptions;

    #[test]
    fn centres_are_those_of_equal_parts() {
        for n in 1..6 {
            let found: Vec<[f64; 3]> = centres(n).collect();
            assert_eq!(found.len(), (n * n) as usize);
            for k in 0..3 {
                let mean = found.iter().map(|at| at[k]).sum::<f64>() / found.len() as f64;
                assert!((mean - 1.0 / 3.0).abs() < 1e-15, "{n}: {mean}");
            }
            let inside = |at: &[f64; 3]| at.iter().all(|b| *b > 0.2 / f64::from(n));
            assert!(found.iter().all(inside));
        }
        assert_eq!(centres(0).count(), 0);
    }

    #[test]
    fn faces_are_sampled_where_they_are_large_and_in_proportion() {
        let mesh = shapes::torus(1.0, 0.4, 800);
        let domain = Domain::of_surface(&mesh, &DomainOptions::default(), &mut unobserved());
        let domain = domain.expect("a domain");
        for wanted in [3_000, 10_000] {
            let found = TSplineSurface::face_samples(&domain, &mesh, wanted);
            let all = (found.len() + mesh.vertex_count()) as f64;
            assert!(
                (0.4..=2.5).contains(&(all / wanted as f64)),
                "{all} of {wanted}"
            );
            let weight: f64 = found.iter().map(|s| s.weight).sum();
            let vertices = mesh.vertex_count() as f64;
            assert!(weight <= vertices * (1.0 + 1e-12), "{weight}");
            assert!(found.iter().all(|s| !s.measured && s.movable));
            // The chords of the torus leave it by no more than this.
            for sample in &found {
                let p = sample.position;
                let miss = (p.x.hypot(p.y) - 1.0).hypot(p.z) - 0.4;
                assert!(miss.abs() < 0.02, "{miss}");
            }
        }
        assert!(TSplineSurface::face_samples(&domain, &mesh, 0).len() < mesh.face_count() / 2);
    }
}
