//! Accuracy on known surfaces, derivatives, and Bézier cells.

use std::collections::{BTreeMap, BTreeSet};

use msplines_common::bspline::BezierCells;
use msplines_common::evaluate::Order;
use msplines_common::mesh::{SurfacePoint, TriangleMesh, shapes};
use msplines_common::progress::unobserved;
use msplines_common::{Point3, Vector3};

use super::{atlas, fitted, options, samples};
use crate::surface::Cap;
use crate::tests::Random;
use crate::{Fill, PowellSabinSurface, VertexCondition, fit_surface};

/// Largest distance and angle from a surface whose closest point and normal are known.
fn errors(
    mesh: &TriangleMesh,
    fill: Fill,
    closest: fn(Point3<f64>) -> [Vector3<f64>; 2],
) -> [f64; 2] {
    let atlas = atlas(mesh);
    let normals: Vec<Vector3<f64>> = atlas
        .mesh()
        .positions()
        .iter()
        .map(|&p| closest(p)[1])
        .collect();
    let conditions = VertexCondition::of_mesh(atlas.mesh(), &normals);
    let options = options(fill);
    let found = fit_surface(&atlas, &conditions, &options, &mut unobserved());
    let tessellation = found.expect("a surface").spline.tessellate(4);
    let mut worst = [0.0_f64; 2];
    for (position, normal) in tessellation.positions.iter().zip(&tessellation.normals) {
        let [foot, due] = closest(*position);
        worst[0] = worst[0].max((position.coords - foot).norm());
        worst[1] = worst[1].max(due.cross(normal).norm());
    }
    worst
}

fn on_sphere(p: Point3<f64>) -> [Vector3<f64>; 2] {
    let normal = p.coords.normalize();
    [normal, normal]
}

fn on_torus(p: Point3<f64>) -> [Vector3<f64>; 2] {
    let ring = Vector3::new(p.x, p.y, 0.0).normalize();
    let normal = (p.coords - ring).normalize();
    [ring + 0.4 * normal, normal]
}

#[test]
fn round_surfaces_are_approached() {
    for (name, make, closest) in [
        (
            "sphere",
            (|n| shapes::sphere(n)) as fn(usize) -> TriangleMesh,
            on_sphere as fn(Point3<f64>) -> [Vector3<f64>; 2],
        ),
        ("torus", |n| shapes::torus(1.0, 0.4, n), on_torus),
    ] {
        let sizes = [800, 12_800];
        let [coarse, fine] = sizes.map(|n| errors(&make(n), Fill::Smooth, closest));
        let [open_coarse, open_fine] = sizes.map(|n| errors(&make(n), Fill::Open, closest));
        for k in 0..2 {
            // Lengths of edges fall by 4; quadratics give the third order in place and the second in
            // direction. At the pole caps of a fixed size on the surface keep that; the map into them
            // is less smooth.
            let rate = (coarse[k] / fine[k]).log2() / 2.0;
            let due = if name == "sphere" {
                [2.8, 1.4]
            } else {
                [2.9, 1.9]
            };
            assert!(rate > due[k], "{name}: {rate} {coarse:?} {fine:?}");
            // Caps are no worse than what is around them.
            assert!(
                coarse[k] <= open_coarse[k] && fine[k] <= open_fine[k],
                "{name}"
            );
        }
    }
}

/// Faces of a kind that derivatives are to be tested on: of the first hole, and around it.
fn near_holes(surface: &PowellSabinSurface) -> Vec<u32> {
    let hole = &surface.caps()[0];
    match hole.cap() {
        Cap::Smooth(cap) => cap.faces().to_vec(),
        _ => hole.faces().to_vec(),
    }
}

#[test]
fn derivatives_near_holes_equal_differences() {
    for (mesh, fill) in [
        (shapes::genus(2, 2500), Fill::Smooth),
        (shapes::sphere(800), Fill::Smooth),
        (shapes::genus(2, 2500), Fill::Minimal),
    ] {
        let (found, _) = fitted(&mesh, fill);
        let surface = &found.spline;
        let mut random = Random::new(11);
        let step = 1e-5;
        let (mut bends, mut good) = (0, 0);
        for face in near_holes(surface) {
            for _ in 0..6 {
                let at = random.barycentric().map(|c| 0.1 / 3.0 + 0.9 * c);
                let point = SurfacePoint { face, at };
                let here = samples(surface, &[point], Order::Second);
                let [along, across] = surface.mesh().face_frame(face);
                for (k, way) in [along, across].into_iter().enumerate() {
                    let [plus, minus] = [step, -step].map(|s| {
                        let at = moved(surface.mesh(), face, at, s * way);
                        samples(surface, &[SurfacePoint { face, at }], Order::First)
                    });
                    let size = Vector3::from_column_slice(&here.first[..3]).norm();
                    for c in 0..3 {
                        let slope = (plus.values[c] - minus.values[c]) / (2.0 * step);
                        let gap = (slope - here.first[3 * k + c]).abs();
                        // A step may lie on both sides of a micro edge, where second derivatives
                        // jump; minimal caps are C0 there.
                        assert!(
                            fill == Fill::Minimal || gap < 1e-3 * size,
                            "face {face} {gap:e} of {size}"
                        );
                        let bend = (plus.first[3 * k + c] - minus.first[3 * k + c]) / (2.0 * step);
                        let due = here.second[6 * k + c];
                        let mixed = (plus.first[3 * (1 - k) + c] - minus.first[3 * (1 - k) + c])
                            / (2.0 * step);
                        let scale = here.second.iter().fold(1.0_f64, |m, s| m.max(s.abs()));
                        bends += 1;
                        let fits = gap < 1e-6 * size
                            && (bend - due).abs() < 1e-4 * scale
                            && (mixed - here.second[3 + c]).abs() < 1e-4 * scale;
                        good += usize::from(fits);
                    }
                }
            }
        }
        // Others are at micro edges and edges of cells, which a step of this size meets at few points.
        assert!(good * 100 > bends * 95, "{good} of {bends}");
    }
}

/// Barycentric coordinates after a step in the plane of a face.
fn moved(mesh: &TriangleMesh, face: u32, at: [f64; 3], way: Vector3<f64>) -> [f64; 3] {
    let [a, b, c] = mesh.triangle(face);
    let normal = mesh.face_normal(face);
    let second = way.cross(&(c - a)).dot(&normal) / normal.norm_squared();
    let third = (b - a).cross(&way).dot(&normal) / normal.norm_squared();
    [at[0] - second - third, at[1] + second, at[2] + third]
}

/// The ends and the middle of a side of a cell, rounded; the same both ways.
type Key = [[i64; 3]; 3];

/// The Bézier points of the sides of all cells.
fn sides(cells: &BezierCells) -> Vec<Vec<Vector3<f64>>> {
    let mut sides = Vec::new();
    let mut rest = cells.points();
    for run in cells.runs() {
        let d = run.degree[0];
        let place = |i: usize, j: usize| i + j * (2 * d + 3 - j) / 2;
        for _ in 0..run.cells {
            let (cell, more) = rest.split_at((d + 1) * (d + 2) / 2);
            rest = more;
            let along = |at: &dyn Fn(usize) -> usize| (0..=d).map(|k| cell[at(k)].coords).collect();
            sides.push(along(&|k| place(k, 0)));
            sides.push(along(&|k| place(d - k, k)));
            sides.push(along(&|k| place(0, d - k)));
        }
    }
    sides
}

/// Returns a point of a Bézier curve.
fn on_curve(points: &[Vector3<f64>], t: f64) -> Vector3<f64> {
    let mut points = points.to_vec();
    while points.len() > 1 {
        points = points.windows(2).map(|p| p[0].lerp(&p[1], t)).collect();
    }
    points[0]
}

/// The key of a piece of a curve.
fn key(curve: &[Vector3<f64>], s: f64, t: f64) -> Key {
    let round = |t: f64| <[f64; 3]>::from(on_curve(curve, t)).map(|c| (c * 1e9).round() as i64);
    let mut ends = [round(s), round(t)];
    ends.sort_unstable();
    [ends[0], ends[1], round(0.5 * (s + t))]
}

/// Takes a piece of a curve out of those that are left, or its halves, or theirs; returns whether it
/// was whole.
fn take(left: &mut BTreeSet<Key>, curve: &[Vector3<f64>], [s, t]: [f64; 2], depth: u32) -> bool {
    let middle = 0.5 * (s + t);
    left.remove(&key(curve, s, t))
        || depth > 0
            && [[s, middle], [middle, t]].map(|half| take(left, curve, half, depth - 1))
                == [true; 2]
}

#[test]
fn cells_are_closed_and_within_their_tolerance() {
    for (fill, tolerance) in [
        (Fill::Smooth, 1e-5),
        (Fill::Smooth, PowellSabinSurface::CELL_TOLERANCE),
        (Fill::Minimal, 1e-5),
    ] {
        let (found, _) = fitted(&shapes::genus(2, 2500), fill);
        let surface = &found.spline;
        let cells = surface.bezier_cells(tolerance);
        assert!(cells.deviation <= tolerance, "{:e}", cells.deviation);
        assert_eq!(cells.exact == cells.cells.len(), fill == Fill::Minimal);
        assert!(cells.cells.len() < 2 * cells.exact, "{}", cells.cells.len());
        let curves = sides(&cells.cells);
        let mut whole: BTreeMap<Key, u32> = BTreeMap::new();
        for curve in &curves {
            *whole.entry(key(curve, 0.0, 1.0)).or_default() += 1;
        }
        // A side that no cell shares is one of several that are halves, or halves of halves, of another.
        let lone: Vec<_> = curves
            .iter()
            .filter(|curve| whole[&key(curve, 0.0, 1.0)] == 1)
            .collect();
        let mut left: BTreeSet<Key> = lone.iter().map(|c| key(c, 0.0, 1.0)).collect();
        let all = whole.len();
        for curve in lone {
            let own = key(curve, 0.0, 1.0);
            if left.remove(&own) {
                let halves = [[0.0, 0.5], [0.5, 1.0]];
                let before = left.clone();
                let covered = halves.map(|half| take(&mut left, curve, half, 5));
                if covered != [true; 2] {
                    left = before;
                    left.insert(own);
                }
            }
        }
        // Numbers that differ by rounding may be rounded apart: one in a thousand, at 1e-9.
        assert!(left.len() * 500 <= all, "{} of {all}", left.len());
    }
}
