//! Surfaces with sharp edges and corners.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point3, Vector3};

use super::build;
use super::grid::periodic_grid;
use crate::mesh::triangle::TriangleMesh;

/// Returns the surface of the unit cube, with `steps` squares along each edge, each cut in two.
///
/// # Panics
/// If `steps` is zero.
#[must_use]
pub fn cube(steps: u32) -> TriangleMesh {
    assert!(steps > 0, "a cube has at least one square on each side");
    let mut positions: Vec<Point3<f64>> = Vec::new();
    let mut ids = std::collections::BTreeMap::new();
    let mut faces = Vec::new();
    let mut id = |place: [u32; 3]| {
        *ids.entry(place).or_insert_with(|| {
            positions.push(Point3::from(place.map(|i| f64::from(i) / f64::from(steps))));
            positions.len() as u32 - 1
        })
    };
    for axis in 0..3 {
        for level in [0, steps] {
            for i in 0..steps {
                for j in 0..steps {
                    let mut at = |i: u32, j: u32| {
                        let mut place = [0; 3];
                        place[axis] = level;
                        place[(axis + 1) % 3] = i;
                        place[(axis + 2) % 3] = j;
                        id(place)
                    };
                    let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    faces.extend(if level == 0 {
                        [[a, c, b], [a, d, c]]
                    } else {
                        [[a, b, c], [a, c, d]]
                    });
                }
            }
        }
    }
    build(positions, faces)
}

/// Returns a hexagonal nut with a collar, of about `vertices` vertices around the z axis: a mechanical
/// part of genus 1 with straight and round sharp edges and twelve corners.
#[must_use]
pub fn nut(vertices: usize) -> TriangleMesh {
    // Corners of the cross-section, counter-clockwise with the axis on the left: radius, height, and
    // whether the radius is that of the corners of a hexagon.
    const SECTION: [(f64, f64, bool); 6] = [
        (0.5, 0.6, false),
        (0.5, -0.6, false),
        (1.0, -0.6, true),
        (1.0, 0.35, true),
        (0.75, 0.35, false),
        (0.75, 0.6, false),
    ];
    const MEAN_TURN: f64 = 0.75 * TAU;
    let length = |k: usize| {
        let ((r, z, _), (s, t, _)) = (SECTION[k], SECTION[(k + 1) % 6]);
        (r - s).hypot(z - t)
    };
    let around: f64 = (0..6).map(length).sum();
    let step = (MEAN_TURN * around / vertices as f64).sqrt();
    let columns = 6 * ((MEAN_TURN / step / 6.0).round() as u32).max(2);
    let strips = [0, 1, 2, 3, 4, 5].map(|k| ((length(k) / step).round() as u32).max(1));
    let rows: u32 = strips.iter().sum();
    let place = |u: f64, v: f64| {
        let mut row = (v * f64::from(rows)).round() as u32;
        let mut strip = 0;
        while row >= strips[strip] {
            row -= strips[strip];
            strip += 1;
        }
        let along = f64::from(row) / f64::from(strips[strip]);
        let angle = TAU * u;
        let at = |(radius, height, hexagonal): (f64, f64, bool)| {
            let from_middle = (angle + PI / 6.0).rem_euclid(PI / 3.0) - PI / 6.0;
            let corner = PI / 6.0 - from_middle.abs();
            // The side of a hexagon seen from its middle, with corners where `from_middle` is zero.
            let shrink = if hexagonal {
                (PI / 6.0).cos() / corner.cos()
            } else {
                1.0
            };
            let reach = radius * shrink;
            Vector3::new(reach * angle.cos(), reach * angle.sin(), height)
        };
        Point3::from(at(SECTION[strip]).lerp(&at(SECTION[(strip + 1) % 6]), along))
    };
    periodic_grid([columns, rows], place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Facts;

    #[test]
    fn a_cube_has_its_area_and_volume() {
        let mesh = cube(5);
        assert_eq!(mesh.vertex_count(), 6 * 25 + 2);
        let facts = Facts::measure(&mesh);
        assert_eq!((facts.genus, facts.boundary_loops), (Some(0), 0));
        assert!((facts.area - 6.0).abs() < 1e-12);
        assert!((volume(&mesh) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_nut_has_one_hole_and_its_volume() {
        let mesh = nut(6000);
        assert!((mesh.vertex_count() as f64 / 6000.0 - 1.0).abs() < 0.1);
        assert_eq!(Facts::measure(&mesh).genus, Some(1));
        let hexagon = 1.5 * 3.0f64.sqrt();
        let exact = 0.95 * hexagon + 0.25 * PI * 0.75 * 0.75 - 1.2 * PI * 0.25;
        assert!(
            (volume(&mesh) / exact - 1.0).abs() < 2e-3,
            "{} {exact}",
            volume(&mesh)
        );
    }

    fn volume(mesh: &TriangleMesh) -> f64 {
        (0..mesh.face_count() as u32)
            .map(|face| {
                let [a, b, c] = mesh.triangle(face);
                a.coords.dot(&b.coords.cross(&c.coords)) / 6.0
            })
            .sum()
    }
}
