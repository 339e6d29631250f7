//! Surfaces over a geodesic sphere.

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};

use super::build;
use crate::mesh::triangle::TriangleMesh;

/// Returns a unit sphere of about `vertices` vertices: an icosahedron whose faces are cut into
/// `f²` triangles and projected, which has `10 f² + 2` vertices.
#[must_use]
pub fn sphere(vertices: usize) -> TriangleMesh {
    let frequency = (vertices.saturating_sub(2) as f64 / 10.0)
        .sqrt()
        .round()
        .max(1.0);
    let (directions, faces) = geodesic(frequency as u32);
    build(directions.into_iter().map(Point3::from).collect(), faces)
}

/// Returns a sphere of about `vertices` vertices with smooth bumps of three sizes, the smallest on
/// one half only: a surface on which evenly spread samples are not the best ones.
#[must_use]
pub fn bumpy_sphere(vertices: usize) -> TriangleMesh {
    let frequency = (vertices.saturating_sub(2) as f64 / 10.0)
        .sqrt()
        .round()
        .max(1.0);
    let (directions, faces) = geodesic(frequency as u32);
    let bumps = bumps();
    let place = |direction: Vector3<f64>| {
        // exp(-k |x - c|² / 2) on the unit sphere.
        let height = |b: &Bump| b.height * (b.sharpness * (b.centre.dot(&direction) - 1.0)).exp();
        Point3::from(direction * (1.0 + bumps.iter().map(height).sum::<f64>()))
    };
    build(directions.into_iter().map(place).collect(), faces)
}

struct Bump {
    centre: Vector3<f64>,
    sharpness: f64,
    height: f64,
}

fn bumps() -> Vec<Bump> {
    let mut bumps = Vec::new();
    for (count, sharpness, height) in [(7, 8.0, 0.22), (41, 70.0, -0.07), (233, 600.0, 0.025)] {
        for i in 0..count {
            let centre = spiral(i, count);
            if count < 100 || centre.dot(&Vector3::new(0.6, 0.64, 0.48)) > 0.0 {
                bumps.push(Bump {
                    centre,
                    sharpness,
                    height,
                });
            }
        }
    }
    bumps
}

/// Returns point `i` of `count` on the golden spiral over the unit sphere.
fn spiral(i: usize, count: usize) -> Vector3<f64> {
    let golden_angle = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let z = 1.0 - (2 * i + 1) as f64 / count as f64;
    let (sine, cosine) = (golden_angle * i as f64).sin_cos();
    let radius = (1.0 - z * z).sqrt();
    Vector3::new(radius * cosine, radius * sine, z)
}

/// Returns the unit vectors and faces of an icosahedron with each face cut into `frequency²`.
fn geodesic(frequency: u32) -> (Vec<Vector3<f64>>, Vec<[u32; 3]>) {
    let corners = icosahedron_corners();
    let mut ids = BTreeMap::new();
    let mut directions = Vec::new();
    let mut faces = Vec::with_capacity(20 * (frequency * frequency) as usize);
    for face in ICOSAHEDRON {
        let mut vertex = |weights: [u32; 3]| {
            // A point on an edge has one zero weight, and the same name from both faces.
            let mut name: [(usize, u32); 3] = std::array::from_fn(|i| (face[i], weights[i]));
            name.iter_mut()
                .filter(|part| part.1 == 0)
                .for_each(|part| part.0 = usize::MAX);
            name.sort_unstable();
            *ids.entry(name).or_insert_with(|| {
                let parts = name.iter().filter(|part| part.1 > 0);
                let sum: Vector3<f64> = parts
                    .map(|&(corner, weight)| corners[corner] * f64::from(weight))
                    .sum();
                directions.push(sum.normalize());
                directions.len() as u32 - 1
            })
        };
        for i in 0..frequency {
            for j in 0..frequency - i {
                let mut at = |i: u32, j: u32| vertex([frequency - i - j, i, j]);
                let (a, b, c) = (at(i, j), at(i + 1, j), at(i, j + 1));
                faces.push([a, b, c]);
                if i + j + 1 < frequency {
                    faces.push([b, at(i + 1, j + 1), c]);
                }
            }
        }
    }
    (directions, faces)
}

const ICOSAHEDRON: [[usize; 3]; 20] = [
    [0, 11, 5],
    [0, 5, 1],
    [0, 1, 7],
    [0, 7, 10],
    [0, 10, 11],
    [1, 5, 9],
    [5, 11, 4],
    [11, 10, 2],
    [10, 7, 6],
    [7, 1, 8],
    [3, 9, 4],
    [3, 4, 2],
    [3, 2, 6],
    [3, 6, 8],
    [3, 8, 9],
    [4, 9, 5],
    [2, 4, 11],
    [6, 2, 10],
    [8, 6, 7],
    [9, 8, 1],
];

fn icosahedron_corners() -> [Vector3<f64>; 12] {
    let t = 0.5 * (1.0 + 5f64.sqrt());
    [
        [-1.0, t, 0.0],
        [1.0, t, 0.0],
        [-1.0, -t, 0.0],
        [1.0, -t, 0.0],
        [0.0, -1.0, t],
        [0.0, 1.0, t],
        [0.0, -1.0, -t],
        [0.0, 1.0, -t],
        [t, 0.0, -1.0],
        [t, 0.0, 1.0],
        [-t, 0.0, -1.0],
        [-t, 0.0, 1.0],
    ]
    .map(Vector3::from)
}
