//! Shapes of the gallery, made from formulas.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point3, Vector3};

/// A triangle mesh.
pub(crate) struct Shape {
    pub(crate) positions: Vec<Point3<f64>>,
    pub(crate) faces: Vec<[u32; 3]>,
}

fn bumpy(latitude: f64, longitude: f64) -> Point3<f64> {
    let direction = Vector3::new(
        latitude.cos() * longitude.sin(),
        latitude.sin(),
        latitude.cos() * longitude.cos(),
    );
    let bump = (3.0 * direction.x).sin() * (4.0 * direction.y).cos() + (5.0 * direction.z).sin();
    Point3::from(direction * (1.0 + 0.11 * bump))
}

/// Returns a closed surface of `n` rings and `2 n` columns.
fn ball(n: u32, place: impl Fn(f64, f64) -> Point3<f64>) -> Shape {
    let columns = 2 * n;
    let mut positions = Vec::new();
    for ring in 0..=n {
        for column in 0..columns {
            let latitude = PI * (f64::from(ring) / f64::from(n) - 0.5);
            positions.push(place(
                latitude,
                TAU * f64::from(column) / f64::from(columns),
            ));
        }
    }
    let mut faces = Vec::new();
    for ring in 0..n {
        for column in 0..columns {
            let next = (column + 1) % columns;
            let [a, b] = [ring * columns + column, ring * columns + next];
            let [c, d] = [a + columns, b + columns];
            faces.extend([[a, b, d], [a, d, c]]);
        }
    }
    Shape { positions, faces }
}

/// Returns a sphere with bumps.
pub(crate) fn bumpy_sphere(n: u32) -> Shape {
    ball(n, bumpy)
}

/// Returns the unit sphere.
pub(crate) fn sphere(n: u32) -> Shape {
    ball(n, |latitude, longitude| {
        let (sin, cos) = latitude.sin_cos();
        Point3::new(cos * longitude.sin(), sin, cos * longitude.cos())
    })
}

impl Shape {
    /// Returns texture coordinates of a ball of `n` rings: longitude and Mercator's latitude, so
    /// that squares stay squares.
    pub(crate) fn texture(&self, n: u32) -> Vec<[[f64; 2]; 3]> {
        let columns = 2 * n;
        let mercator = |vertex: u32| {
            let latitude = PI * (f64::from(vertex / columns) / f64::from(n) - 0.5);
            let height = (PI / 4.0 + latitude.clamp(-1.5, 1.5) / 2.0).tan().ln();
            [
                f64::from(vertex % columns) / f64::from(columns),
                height / TAU,
            ]
        };
        let across = |face: &[u32; 3]| {
            let mut corners = face.map(mercator);
            let largest = corners.iter().map(|c| c[0]).fold(0.0, f64::max);
            // A face over the seam goes on past the right edge of the texture.
            corners
                .iter_mut()
                .filter(|c| largest - c[0] > 0.5)
                .for_each(|c| c[0] += 1.0);
            corners
        };
        self.faces.iter().map(across).collect()
    }
}

/// Returns a closed curve on the bumpy sphere.
pub(crate) fn loop_on_bumpy_sphere(count: u32) -> Vec<Point3<f64>> {
    let at = |i: u32| {
        let t = TAU * f64::from(i) / f64::from(count);
        bumpy(0.5 * (3.0 * t).sin(), t)
    };
    (0..count).map(at).collect()
}

/// Returns a tube along a trefoil knot.
pub(crate) fn torus_knot(length: u32, around: u32) -> Shape {
    let centre = |t: f64| {
        let ring = 2.0 + (3.0 * t).cos();
        Vector3::new(
            ring * (2.0 * t).cos(),
            (3.0 * t).sin(),
            -ring * (2.0 * t).sin(),
        )
    };
    let mut positions = Vec::new();
    for i in 0..length {
        let t = TAU * f64::from(i) / f64::from(length);
        let along = (centre(t + 1e-4) - centre(t - 1e-4)).normalize();
        let out = centre(t).cross(&along).normalize();
        let side = along.cross(&out);
        for j in 0..around {
            let (sin, cos) = (TAU * f64::from(j) / f64::from(around)).sin_cos();
            positions.push(Point3::from(centre(t) + (out * cos + side * sin) * 0.42));
        }
    }
    let mut faces = Vec::new();
    for i in 0..length {
        for j in 0..around {
            let at = |i: u32, j: u32| i % length * around + j % around;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            faces.extend([[a, c, b], [a, d, c]]);
        }
    }
    Shape { positions, faces }
}

/// Returns the corners and hexahedra of a cube of `n` cells a side, twisted about its height.
pub(crate) fn twisted_block(n: u32) -> (Vec<Point3<f64>>, Vec<[u32; 8]>) {
    let m = n + 1;
    let grid = |n: u32| (0..n * n * n).map(move |i| [i % n, i / n % n, i / n / n]);
    let place = |p: [u32; 3]| {
        let [x, z, y] = p.map(|c| 2.0 * f64::from(c) / f64::from(n) - 1.0);
        let (sin, cos) = (0.5 * y).sin_cos();
        let waist = 0.75 + 0.25 * y * y;
        Point3::new(waist * (cos * x + sin * z), y, waist * (sin * x - cos * z))
    };
    let at = |x: u32, y: u32, z: u32| x + m * (y + m * z);
    let ring = [[0, 0], [1, 0], [1, 1], [0, 1]];
    let cells = grid(n).map(|[x, y, z]| {
        std::array::from_fn(|i| at(x + ring[i % 4][0], y + ring[i % 4][1], z + i as u32 / 4))
    });
    (grid(m).map(place).collect(), cells.collect())
}
