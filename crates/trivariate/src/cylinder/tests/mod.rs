//! Cylindrical parameters of known solids.

mod fits;
mod maps;
mod refusals;

use std::f64::consts::PI;

use msplines_common::mesh::{TriangleMesh, shapes};
use msplines_common::progress::unobserved;
use nalgebra::{Point3, Vector3};

use super::*;
use crate::fit::multilevel;

/// Loops of a triangulation against those of the smooth surface, whose edges are about 0.07 long.
const MESHED: f64 = 0.01;

fn small() -> Options {
    Options {
        loops: 60,
        meridians: 64,
        radii: 17,
        approximation: Approximation::LeastSquares {
            spans: 8,
            smoothing: 1e-5,
        },
        ..Options::default()
    }
}

fn multilevel(coarsest: usize, finest: usize) -> Options {
    let levels = multilevel::Options {
        coarsest,
        finest,
        stop_rms: 0.0,
    };
    Options {
        approximation: Approximation::Multilevel(levels),
        ..small()
    }
}

fn mapped(surface: &TriangleMesh, options: &Options) -> CylinderMap {
    map(surface, options, &mut unobserved()).expect("a map")
}

fn fitted(map: &CylinderMap, options: &Options) -> CylinderFit {
    fit(map, options, &mut unobserved()).expect("a fit")
}

/// The ball stretched along z.
fn ellipsoid(half: f64) -> TriangleMesh {
    let ball = shapes::sphere(2500);
    let stretch = |p: &Point3<f64>| Point3::new(p.x, p.y, half * p.z);
    ball.with_positions(ball.positions().iter().map(stretch).collect())
}

fn nearest(surface: &TriangleMesh, point: Point3<f64>) -> u32 {
    let distance = |v: &u32| (surface.positions()[*v as usize] - point).norm();
    let vertices = 0..surface.vertex_count() as u32;
    vertices
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .expect("a vertex")
}

/// An arc of 2 rad about the y axis at a distance of 2, thickened to a tube of radius 0.4 with round
/// ends. The first and the last vertex are its ends.
fn bent_tube() -> TriangleMesh {
    let (around, caps, along) = (24, 8_u32, 40);
    let mut profile = Vec::new();
    for step in 1..=caps {
        let angle = 0.5 * PI * f64::from(step) / f64::from(caps);
        profile.push((0.0, -0.4 * angle.cos(), 0.4 * angle.sin()));
    }
    profile.extend((1..along).map(|step| (2.0 * f64::from(step) / f64::from(along), 0.0, 0.4)));
    let mirrored: Vec<_> = profile[..caps as usize].iter().rev().collect();
    let end: Vec<_> = mirrored
        .iter()
        .map(|(_, offset, radius)| (2.0, -offset, *radius))
        .collect();
    profile.extend(end);
    let place = |(angle, offset, radius): (f64, f64, f64), turn: f64| {
        let outward = Vector3::new(angle.cos(), 0.0, angle.sin());
        let tangent = Vector3::new(-angle.sin(), 0.0, angle.cos());
        let arm = outward * turn.cos() + tangent.cross(&outward) * turn.sin();
        Point3::from(2.0 * outward + tangent * offset + arm * radius)
    };
    let mut points = vec![place((0.0, -0.4, 0.0), 0.0)];
    for ring in &profile {
        points
            .extend((0..around).map(|j| place(*ring, 2.0 * PI * f64::from(j) / f64::from(around))));
    }
    points.push(place((2.0, 0.4, 0.0), 0.0));
    let (around, last) = (around as u32, points.len() as u32 - 1);
    let at = |ring: u32, j: u32| 1 + ring * around + j % around;
    let mut faces = Vec::new();
    for j in 0..around {
        faces.push([0, at(0, j + 1), at(0, j)]);
        for ring in 0..profile.len() as u32 - 1 {
            let [a, b] = [at(ring, j), at(ring, j + 1)];
            let [c, d] = [at(ring + 1, j), at(ring + 1, j + 1)];
            faces.extend([[a, b, d], [a, d, c]]);
        }
        faces.push([
            last,
            at(profile.len() as u32 - 1, j),
            at(profile.len() as u32 - 1, j + 1),
        ]);
    }
    TriangleMesh::build(points, faces).expect("a closed tube")
}

/// Signed volume between the axis and the loops.
fn volume(map: &CylinderMap) -> f64 {
    let (count, mut six_fold) = (map.meridians, 0.0);
    for row in 0..map.axis.len() - 1 {
        for j in 0..count {
            let at = |row: usize, j: usize| map.loops[row * count + j % count].coords;
            let [a, b, c, d] = [
                at(row, j),
                at(row, j + 1),
                at(row + 1, j + 1),
                at(row + 1, j),
            ];
            six_fold += a.dot(&b.cross(&c)) + a.dot(&c.cross(&d));
        }
    }
    six_fold / 6.0
}

/// Mean of the determinant at the centres of cells.
fn mean_determinant(spline: &TrivariateSpline) -> f64 {
    let centre = |i: usize| (i as f64 + 0.5) / 8.0;
    let at = |i: usize| [centre(i % 8), centre(i / 8 % 8), centre(i / 64)];
    (0..512)
        .map(|i| spline.jet(at(i)).determinant())
        .sum::<f64>()
        / 512.0
}
