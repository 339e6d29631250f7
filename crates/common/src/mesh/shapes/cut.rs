//! Surfaces with curved boundaries: parts of a rectangle of parameters, laid out in space.

use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};

use nalgebra::{Point2, Point3, Vector2};

use super::build;
use super::grid::grid;
use crate::mesh::NONE;
use crate::mesh::triangle::TriangleMesh;

/// Steps of Newton's method that lay a vertex on the boundary: quadratic, from one edge away.
const NEWTON: usize = 8;

/// Returns the lower half of a unit sphere, of about `vertices` vertices: one boundary loop, the equator.
#[must_use]
pub fn bowl(vertices: usize) -> TriangleMesh {
    let cells = vertices as f64 / (PI / 4.0);
    let place = |p: Point2<f64>| {
        let square = p.coords.norm_squared();
        Point3::new(2.0 * p.x, 2.0 * p.y, square - 1.0) / (1.0 + square)
    };
    cut(cells, [2.0, 2.0], false, |p| p.coords.norm() - 1.0, place)
}

/// Returns a saddle over an ellipse without two disks, of about `vertices` vertices: a pair of pants, with three
/// boundary loops.
#[must_use]
pub fn pants(vertices: usize) -> TriangleMesh {
    let holes = [Point2::new(-0.65, 0.0), Point2::new(0.65, 0.1)];
    let distance = |p: Point2<f64>| {
        let within = Vector2::new(p.x / 1.5, p.y).norm() - 1.0;
        let [left, right] = holes.map(|hole| 0.3 - (p - hole).norm());
        within.max(left).max(right)
    };
    let area = 1.5 * PI - 0.18 * PI;
    let place = |p: Point2<f64>| Point3::new(p.x, p.y, 0.25 * (p.x * p.x - p.y * p.y));
    cut(
        vertices as f64 * 6.0 / area,
        [3.0, 2.0],
        false,
        distance,
        place,
    )
}

/// Returns a torus of radii 1 and 0.4 without a disk of radius 0.5, of about `vertices` vertices: genus 1, with
/// one boundary loop.
#[must_use]
pub fn holed_torus(vertices: usize) -> TriangleMesh {
    let (around, through) = (TAU, 0.4 * TAU);
    let share = 1.0 - 0.25 * PI / (around * through);
    let place = |p: Point2<f64>| {
        let (u, v) = (p.x, p.y / 0.4);
        let across = 1.0 + 0.4 * v.cos();
        Point3::new(across * u.cos(), across * u.sin(), 0.4 * v.sin())
    };
    let distance = |p: Point2<f64>| 0.5 - p.coords.norm();
    cut(
        vertices as f64 / share,
        [around, through],
        true,
        distance,
        place,
    )
}

/// Returns the part of a rectangle around the origin where a function is negative, of as many cells as about
/// `cells`, laid out in space. Its boundary vertices lie where the function is zero.
fn cut(
    cells: f64,
    size: [f64; 2],
    periodic: bool,
    distance: impl Fn(Point2<f64>) -> f64,
    place: impl Fn(Point2<f64>) -> Point3<f64>,
) -> TriangleMesh {
    let step = (size[0] * size[1] / cells).sqrt();
    let counts = size.map(|side| (side / step).round() as u32 + u32::from(!periodic));
    let flat = grid(counts, [periodic; 2], |u, v| {
        Point3::new((u - 0.5) * size[0], (v - 0.5) * size[1], 0.0)
    });
    let at = |v: u32| flat.positions()[v as usize].xy();
    let mut faces = flat.faces().to_vec();
    faces.retain(|corners| corners.iter().all(|&v| distance(at(v)) <= 0.0));
    let on_boundary = loop {
        let (found, before) = (boundary(&faces), faces.len());
        // All corners on the boundary: laid on it, they would leave a sliver.
        faces.retain(|corners| !corners.iter().all(|v| found.contains(v)));
        if faces.len() == before {
            break found;
        }
    };
    let laid = |v: u32| match on_boundary.contains(&v) {
        true => place(snapped(at(v), &distance)),
        false => place(at(v)),
    };
    let mut names = vec![NONE; flat.vertex_count()];
    faces.iter().flatten().for_each(|&v| names[v as usize] = v);
    let mut positions = Vec::new();
    for name in names.iter_mut().filter(|name| **name != NONE) {
        positions.push(laid(*name));
        *name = positions.len() as u32 - 1;
    }
    let faces = faces.iter().map(|c| c.map(|v| names[v as usize]));
    build(positions, faces.collect())
}

/// The vertices of edges that one face only has.
fn boundary(faces: &[[u32; 3]]) -> BTreeSet<u32> {
    let sides = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
    let all: BTreeSet<[u32; 2]> = faces.iter().flat_map(sides).collect();
    let open = all.iter().filter(|[a, b]| !all.contains(&[*b, *a]));
    open.flatten().copied().collect()
}

/// The zero of a function near a point, along its gradient.
fn snapped(from: Point2<f64>, distance: &impl Fn(Point2<f64>) -> f64) -> Point2<f64> {
    const STEP: f64 = 1e-6;
    let mut at = from;
    for _ in 0..NEWTON {
        let slope = |along: Vector2<f64>| {
            (distance(at + along * STEP) - distance(at - along * STEP)) / (2.0 * STEP)
        };
        let gradient = Vector2::new(slope(Vector2::x()), slope(Vector2::y()));
        at -= gradient * (distance(at) / gradient.norm_squared());
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Facts;

    #[test]
    fn surfaces_have_their_loops_and_areas() {
        let expected = [
            (bowl(2000), 0, 1, TAU),
            (holed_torus(2000), 1, 1, 0.0),
            (pants(2000), 0, 3, 0.0),
        ];
        for (mesh, genus, loops, area) in expected {
            let facts = Facts::measure(&mesh);
            assert_eq!((facts.genus, facts.boundary_loops), (Some(genus), loops));
            // A tenth: counts are rounded to whole rows.
            assert!(
                (facts.vertices as f64 / 2000.0 - 1.0).abs() < 0.1,
                "{}",
                facts.vertices
            );
            assert!(
                area == 0.0 || (facts.area / area - 1.0).abs() < 2e-3,
                "{}",
                facts.area
            );
            // Faces laid on the boundary stay faces.
            assert!(facts.angle.min > 0.1, "{}", facts.angle.min);
        }
    }

    #[test]
    fn the_rim_of_a_bowl_is_the_equator() {
        let mesh = bowl(1000);
        let topology = mesh.topology();
        for half_edge in topology.boundary_loops().concat() {
            let z = mesh.positions()[topology.origin(half_edge) as usize].z;
            // Newton's method ends at rounding.
            assert!(z.abs() < 1e-12, "{z}");
        }
    }
}
