//! Surfaces whose conformal structure is known in closed form.

use std::f64::consts::TAU;

use msplines_common::mesh::{TriangleMesh, shapes};
use nalgebra::{Point3, Vector3};

/// A torus of `m × n` vertices over a periodic grid.
pub(super) fn periodic(m: u32, n: u32, at: impl Fn(f64, f64) -> Point3<f64>) -> TriangleMesh {
    let vertex = |i: u32, j: u32| (i % m) * n + j % n;
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for i in 0..m {
        for j in 0..n {
            positions.push(at(f64::from(i) / f64::from(m), f64::from(j) / f64::from(n)));
            faces.push([vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)]);
            faces.push([vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
        }
    }
    TriangleMesh::build(positions, faces).unwrap()
}

/// The torus of revolution with these radii.
pub(super) fn revolution(m: u32, n: u32, ring: f64, tube: f64) -> TriangleMesh {
    periodic(m, n, |u, v| {
        let (u, v) = (TAU * u, TAU * v);
        let radius = ring + tube * v.cos();
        Point3::new(radius * u.cos(), radius * u.sin(), tube * v.sin())
    })
}

/// The preimage in R³ of the curve `colatitude(longitude)` of the sphere under the Hopf map.
///
/// It is conformal to the plane over the lattice of `2π` and `A/2 + i L/2`, where `L` is the length
/// of the curve and `A` the area that it encloses [Pinkall1985].
pub(super) fn hopf(m: u32, n: u32, colatitude: impl Fn(f64) -> f64) -> TriangleMesh {
    periodic(m, n, |u, v| {
        let (longitude, fibre) = (TAU * u, TAU * v);
        let (sin, cos) = (0.5 * colatitude(longitude)).sin_cos();
        let [a, b] = [
            cos * (fibre + longitude).cos(),
            cos * (fibre + longitude).sin(),
        ];
        let [c, d] = [sin * fibre.cos(), sin * fibre.sin()];
        // The centre of projection lies over the south pole, which the curve keeps away from.
        Point3::new(a, b, c) / (1.0 - d)
    })
}

/// Length of the curve and area around the north pole, by the trapezoidal rule, which is exact to
/// rounding for smooth periodic integrands.
pub(super) fn length_and_area(
    colatitude: impl Fn(f64) -> f64,
    slope: impl Fn(f64) -> f64,
) -> [f64; 2] {
    const STEPS: u32 = 4000;
    let step = TAU / f64::from(STEPS);
    (0..STEPS).fold([0.0; 2], |[length, area], i| {
        let t = f64::from(i) * step;
        let (theta, rate) = (colatitude(t), slope(t));
        [
            length + step * rate.hypot(theta.sin()),
            area + step * (1.0 - theta.cos()),
        ]
    })
}

/// A torus with a finger: the star of a vertex is pulled out into a tube of `rings` rings.
pub(crate) fn with_finger(rings: u32) -> TriangleMesh {
    let torus = shapes::torus(2.0, 0.8, 600);
    let topology = torus.topology();
    let root = 100;
    let mut rim: Vec<u32> = topology.neighbours(root).collect();
    let mut positions = torus.positions().to_vec();
    let normal = topology
        .outgoing(root)
        .fold(Vector3::zeros(), |sum, h| sum + torus.face_normal(h / 3));
    let radius = (positions[rim[0] as usize] - positions[root as usize]).norm();
    let step = normal.normalize() * radius;
    let mut faces: Vec<[u32; 3]> = torus
        .faces()
        .iter()
        .copied()
        .filter(|f| !f.contains(&root))
        .collect();
    for _ in 0..rings {
        let next: Vec<u32> = (0..rim.len() as u32)
            .map(|i| positions.len() as u32 + i)
            .collect();
        let moved: Vec<Point3<f64>> = rim.iter().map(|&v| positions[v as usize] + step).collect();
        positions.extend(moved);
        for i in 0..rim.len() {
            let j = (i + 1) % rim.len();
            faces.push([rim[i], rim[j], next[j]]);
            faces.push([rim[i], next[j], next[i]]);
        }
        rim = next;
    }
    // The root becomes the tip.
    let sum = rim.iter().fold(Vector3::zeros(), |sum, &v| {
        sum + positions[v as usize].coords
    });
    positions[root as usize] = Point3::from(sum / rim.len() as f64 + step);
    for i in 0..rim.len() {
        faces.push([rim[i], rim[(i + 1) % rim.len()], root]);
    }
    TriangleMesh::build(positions, faces).unwrap()
}

/// A torus with a spike: a face is pulled out into a tube of `rings` rings of three vertices, each ring so
/// much smaller than the one before.
pub(crate) fn with_spike(rings: u32, taper: f64) -> TriangleMesh {
    let torus = shapes::torus(2.0, 0.8, 600);
    let root = 100;
    let mut positions = torus.positions().to_vec();
    let mut faces = torus.faces().to_vec();
    let mut rim = faces.swap_remove(root as usize);
    let normal = torus.face_normal(root).normalize();
    let mut size = (positions[rim[1] as usize] - positions[rim[0] as usize]).norm();
    for _ in 0..rings {
        let next = [0, 1, 2].map(|i| positions.len() as u32 + i);
        let sum = rim.iter().fold(Vector3::zeros(), |sum, &v| {
            sum + positions[v as usize].coords
        });
        let middle = Point3::from(sum / 3.0);
        for v in rim {
            let out = positions[v as usize] - middle;
            positions.push(middle + out * taper + normal * size);
        }
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            faces.push([rim[i], rim[j], next[j]]);
            faces.push([rim[i], next[j], next[i]]);
        }
        size *= taper;
        rim = next;
    }
    faces.push(rim);
    TriangleMesh::build(positions, faces).unwrap()
}

/// A disk of six triangles around vertex 0 and so many rings.
pub(super) fn hexagon(rings: u32) -> (TriangleMesh, Vec<[f64; 2]>) {
    let mut points = vec![[0.0, 0.0]];
    let mut start = vec![0u32];
    for ring in 1..=rings {
        start.push(points.len() as u32);
        for i in 0..6 * ring {
            let turn = TAU * (f64::from(i) + 0.1) / f64::from(6 * ring);
            points.push([f64::from(ring) * turn.cos(), f64::from(ring) * turn.sin()]);
        }
    }
    let at = |ring: u32, i: u32| {
        if ring == 0 {
            0
        } else {
            start[ring as usize] + i % (6 * ring)
        }
    };
    let mut faces = Vec::new();
    for ring in 0..rings {
        for side in 0..6 {
            for i in 0..=ring {
                let (inner, outer) = (side * ring + i, side * (ring + 1) + i);
                faces.push([
                    at(ring, inner),
                    at(ring + 1, outer),
                    at(ring + 1, outer + 1),
                ]);
                if i < ring {
                    faces.push([
                        at(ring, inner),
                        at(ring + 1, outer + 1),
                        at(ring, inner + 1),
                    ]);
                }
            }
        }
    }
    let positions = points
        .iter()
        .map(|p| Point3::new(p[0], p[1], 0.0))
        .collect();
    (TriangleMesh::build(positions, faces).unwrap(), points)
}
