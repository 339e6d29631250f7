//! Surfaces over a rectangular grid of parameters, closed or open in each direction.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};

use super::build;
use crate::mesh::triangle::TriangleMesh;

/// Returns a torus of about `vertices` vertices around the z axis; `ring` is the radius of its
/// centre line and `tube` that of its cross-section.
#[must_use]
pub fn torus(ring: f64, tube: f64, vertices: usize) -> TriangleMesh {
    let [columns, rows] = counts(vertices, ring / tube, [3, 3]);
    periodic_grid([columns, rows], |u, v| {
        let (across, up) = (ring + tube * (TAU * v).cos(), tube * (TAU * v).sin());
        Point3::new(across * (TAU * u).cos(), across * (TAU * u).sin(), up)
    })
}

/// Returns a closed tube of about `vertices` vertices along the (p, q) torus knot, which winds `p`
/// times around the axis and `q` times through the hole.
///
/// # Panics
/// If `p` or `q` is zero.
#[must_use]
pub fn torus_knot(p: u32, q: u32, vertices: usize) -> TriangleMesh {
    assert!(p > 0 && q > 0, "a torus knot winds at least once each way");
    const RING: f64 = 2.0;
    const INNER: f64 = 0.9;
    let (p, q) = (f64::from(p), f64::from(q));
    // Strands that cross a section of the torus are 2 INNER sin(π / p) apart, less their slant.
    let tube = 0.35 * INNER * (std::f64::consts::PI / p.max(2.0)).sin();
    let length = TAU * (p * RING).hypot(q * INNER);
    let counts = counts(vertices, length / (TAU * tube), [3, 3]);
    periodic_grid(counts, |u, v| {
        let (around, through) = (TAU * p * u, TAU * q * u);
        let (outward, up) = (Vector3::new(around.cos(), around.sin(), 0.0), Vector3::z());
        // The normal of the torus is normal to the knot on it and closes up after one turn.
        let normal = outward * through.cos() + up * through.sin();
        let turn = Vector3::new(-around.sin(), around.cos(), 0.0);
        let bend = up * through.cos() - outward * through.sin();
        let tangent = turn * (p * (RING + INNER * through.cos())) + bend * (q * INNER);
        let side = normal.cross(&tangent).normalize();
        let centre = outward * RING + normal * INNER;
        Point3::from(centre + (normal * (TAU * v).cos() + side * (TAU * v).sin()) * tube)
    })
}

/// Returns an open cylinder of about `vertices` vertices around the z axis, of radius 1 and height
/// 2: two boundary loops.
#[must_use]
pub fn cylinder(vertices: usize) -> TriangleMesh {
    let [columns, rows] = counts(vertices, TAU / 2.0, [3, 2]);
    let place = |u: f64, v: f64| {
        let angle = TAU * u;
        Point3::new(angle.cos(), angle.sin(), 2.0 * v - 1.0)
    };
    grid([columns, rows], [true, false], place)
}

/// Returns an open vase of about `vertices` vertices around the z axis, fluted and of varying width:
/// two boundary loops.
#[must_use]
pub fn vase(vertices: usize) -> TriangleMesh {
    grid(
        counts(vertices, TAU / 3.0, [3, 2]),
        [true, false],
        |u, v| {
            let (angle, height) = (TAU * u, 3.0 * v - 1.5);
            let width = 0.9 + 0.3 * (2.2 * height).sin();
            let radius = width * (1.0 + 0.08 * (7.0 * angle + 2.0 * height).cos());
            Point3::new(radius * angle.cos(), radius * angle.sin(), height)
        },
    )
}

/// Returns a wavy square patch of about `vertices` vertices over [-1, 1]²: one boundary loop.
#[must_use]
pub fn height_field(vertices: usize) -> TriangleMesh {
    grid(counts(vertices, 1.0, [2, 2]), [false, false], |u, v| {
        let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
        let hill = 0.4 * (-4.0 * (x * x + y * y)).exp();
        Point3::new(x, y, hill + 0.1 * (3.0 * x + 1.0).sin() * (4.0 * y).cos())
    })
}

/// Returns numbers of columns and rows whose product is about `vertices` and ratio about `aspect`.
fn counts(vertices: usize, aspect: f64, least: [u32; 2]) -> [u32; 2] {
    let rows = ((vertices as f64 / aspect).sqrt().round() as u32).max(least[1]);
    let columns = (vertices as f64 / f64::from(rows)).round() as u32;
    [columns.max(least[0]), rows]
}

pub(super) fn periodic_grid(
    counts: [u32; 2],
    place: impl Fn(f64, f64) -> Point3<f64>,
) -> TriangleMesh {
    grid(counts, [true, true], place)
}

/// Returns the mesh of points at `counts` parameters in [0, 1]², in rows; a periodic direction
/// leaves out the parameter 1.
pub(super) fn grid(
    counts: [u32; 2],
    periodic: [bool; 2],
    place: impl Fn(f64, f64) -> Point3<f64>,
) -> TriangleMesh {
    let [columns, rows] = counts;
    let steps = [0, 1].map(|i| {
        if periodic[i] {
            counts[i]
        } else {
            counts[i] - 1
        }
    });
    let parameter = |i: u32, axis: usize| f64::from(i) / f64::from(steps[axis]);
    let mut positions = Vec::with_capacity((columns * rows) as usize);
    for row in 0..rows {
        positions.extend((0..columns).map(|i| place(parameter(i, 0), parameter(row, 1))));
    }
    let id = |column: u32, row: u32| (row % rows) * columns + column % columns;
    let mut faces = Vec::with_capacity(2 * positions.len());
    for row in 0..steps[1] {
        for column in 0..steps[0] {
            let (a, b) = (id(column, row), id(column + 1, row));
            let (c, d) = (id(column + 1, row + 1), id(column, row + 1));
            // The shorter diagonal: on a slanted grid the other one makes slivers.
            let length = |i: u32, j: u32| (positions[i as usize] - positions[j as usize]).norm();
            if length(b, d) < length(a, c) {
                faces.extend([[a, b, d], [b, c, d]]);
            } else {
                faces.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    build(positions, faces)
}
