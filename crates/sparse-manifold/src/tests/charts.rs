//! Charts, transitions, weights, and the derivatives of what they blend.

use msplines_common::evaluate::{EvaluateError, Order, Samples, SurfaceSpline};
use msplines_common::mesh::SurfacePoint;
use proptest::prelude::*;

use super::{box_24, creased, fitted, meshes, smooth};
use crate::domain::{Star, corner_coordinates, face_coordinates};
use crate::weight::weight;
use crate::{Options, SparseManifold, Tessellator};

proptest! {
    #[test]
    fn weights_of_the_four_corners_sum_to_one(s in 0.0f64..=1.0, t in 0.0f64..=1.0) {
        let sum: f64 = (0..4)
            .map(|corner| {
                let [u, v] = corner_coordinates(corner, [s, t]);
                weight(u)[0] * weight(v)[0]
            })
            .sum();
        prop_assert!((sum - 1.0).abs() <= 1e-15, "{sum}");
    }

    #[test]
    fn corner_coordinates_are_undone(corner in 0u32..4, s in 0.0f64..=1.0, t in 0.0f64..=1.0) {
        let back = face_coordinates(corner, corner_coordinates(corner, [s, t]));
        prop_assert!((back[0] - s).abs() < 1e-15 && (back[1] - t).abs() < 1e-15);
    }

    #[test]
    fn a_position_in_a_chart_is_found_again(
        valence in 3u32..13,
        place in 0u32..13,
        u in 0.0f64..=1.0,
        v in 0.0f64..1.0,
    ) {
        let star = Star { sectors: valence, valence };
        let sector = place % valence;
        let (found, at) = star.locate(star.position(sector, [u, v]));
        // Points on the last edge of a sector are points on the first one of the next.
        let expected = if u == 0.0 { ((sector + 1) % valence, [v, 0.0]) } else { (sector, [u, v]) };
        prop_assert_eq!(found, expected.0);
        prop_assert!((at[0] - expected.1[0]).abs() < 1e-9 && (at[1] - expected.1[1]).abs() < 1e-9);
    }
}

/// A transition is holomorphic if its mean over a circle is its value in the middle, and if the
/// Laurent coefficients of negative order vanish, also where the circle crosses an edge.
#[test]
fn transitions_are_holomorphic_across_edges() {
    const SAMPLES: usize = 64;
    /// The neighbour's centre, where its chart is singular, is 0.24 away at the least.
    const RADIUS: f64 = 0.1;
    for (k, l) in [(3, 4), (4, 5), (5, 3), (6, 4), (10, 3)] {
        let (here, there) = (
            Star {
                sectors: k,
                valence: k,
            },
            Star {
                sectors: l,
                valence: l,
            },
        );
        // Sectors 0 and k - 1 here meet along the edge to the neighbour; there they are sectors 1 and
        // 0, say: the face on the left is sector 0 of the neighbour's edge back.
        let transition = |z: [f64; 2]| {
            let (sector, uv) = here.locate(z);
            let (corner, other) = if sector == 0 { (1, l - 1) } else { (3, 0) };
            let at = corner_coordinates(corner, uv);
            there.position(other, at)
        };
        let middle = here.position(0, [0.5, 0.0]);
        let mut coefficients = vec![[0.0; 2]; 4];
        for i in 0..SAMPLES {
            let angle = std::f64::consts::TAU * (i as f64 + 0.5) / SAMPLES as f64;
            let z = [
                middle[0] + RADIUS * angle.cos(),
                middle[1] + RADIUS * angle.sin(),
            ];
            let value = transition(z);
            for (order, sum) in coefficients.iter_mut().enumerate() {
                let (sin, cos) = (angle * (order + 1) as f64).sin_cos();
                sum[0] += (value[0] * cos - value[1] * sin) / SAMPLES as f64;
                sum[1] += (value[0] * sin + value[1] * cos) / SAMPLES as f64;
            }
        }
        for [re, im] in coefficients {
            assert!(re.hypot(im) < 1e-13, "valence {k} to {l}: {re} {im}");
        }
    }
}

fn sample(spline: &SparseManifold, points: &[SurfacePoint], order: Order) -> Samples {
    let mut samples = Samples::default();
    spline
        .prepare(points, order)
        .expect("points inside")
        .evaluate(&mut samples);
    samples
}

#[test]
fn derivatives_are_differences_inside_of_faces() {
    const STEP: f64 = 1e-5;
    for mesh in meshes() {
        let spline = fitted(&mesh, &smooth(&mesh), &Options::default()).spline;
        let mut points = Vec::new();
        for face in 0..mesh.face_count() as u32 {
            for at in [[0.3, 0.61], [0.11, 0.07], [0.5, 0.93], [0.86, 0.2]] {
                points.push(SurfacePoint {
                    face,
                    at: [at[0], at[1], 0.0],
                });
            }
        }
        let here = sample(&spline, &points, Order::Second);
        let moved = |i: usize, step: f64| {
            let mut points = points.clone();
            points.iter_mut().for_each(|p| p.at[i] += step);
            sample(&spline, &points, Order::First)
        };
        for i in 0..2 {
            let (low, high) = (moved(i, -STEP), moved(i, STEP));
            for p in 0..points.len() {
                for c in 0..3 {
                    let first = (high.values[3 * p + c] - low.values[3 * p + c]) / (2.0 * STEP);
                    assert!((first - here.first[6 * p + 3 * i + c]).abs() < 1e-6);
                    for j in 0..2 {
                        let slot = 6 * p + 3 * j + c;
                        let second = (high.first[slot] - low.first[slot]) / (2.0 * STEP);
                        let found = here.second[9 * p + 3 * (i + j) + c];
                        assert!(
                            (second - found).abs() < 1e-4 * (1.0 + found.abs()),
                            "{second} {found}"
                        );
                    }
                }
            }
        }
    }
}

/// Normals and curvatures do not depend on the chart, so that those of the two sides of an edge, and
/// of all faces around a vertex of any valence, are the same.
#[test]
fn normals_and_curvatures_agree_across_edges_and_at_extraordinary_vertices() {
    /// At a pole of valence 10 rounding of `along` counts a thousand times.
    const ROUNDING: f64 = 1e-11;
    for mesh in meshes() {
        let spline = fitted(&mesh, &smooth(&mesh), &Options::default()).spline;
        let topology = mesh.topology();
        for h in 0..topology.half_edge_count() as u32 {
            let twin = topology.twin(h);
            if twin == u32::MAX {
                continue;
            }
            for along in [0.0, 1e-6, 0.05, 0.1249, 0.1251, 0.31, 0.5, 0.77] {
                let place = |h: u32, along: f64| {
                    let [s, t] = face_coordinates(h % 4, [along, 0.0]);
                    SurfacePoint {
                        face: h / 4,
                        at: [s, t, 0.0],
                    }
                };
                let points = [place(h, along), place(twin, 1.0 - along)];
                let [one, two] = spline.geometry(&points).expect("points inside")[..] else {
                    panic!("two points")
                };
                assert!((one.position - two.position).norm() < ROUNDING);
                assert!((one.normal - two.normal).norm() < 1e-8, "{along}");
                let scale = 1.0 + one.mean_curvature.abs() + one.gaussian_curvature.abs();
                assert!(
                    (one.mean_curvature - two.mean_curvature).abs() < 1e-5 * scale,
                    "{along}"
                );
                assert!((one.gaussian_curvature - two.gaussian_curvature).abs() < 1e-5 * scale);
            }
        }
    }
}

#[test]
fn grids_have_the_points_of_the_surface_and_close() {
    let mesh = box_24();
    let spline = fitted(&mesh, &creased(&mesh), &Options::default()).spline;
    let tessellator = Tessellator::build(&spline, 6);
    let surface = tessellator.surface(&spline);
    let expected = sample(&spline, &surface.places, Order::Value);
    for (point, expected) in surface.positions.iter().zip(expected.values.chunks(3)) {
        assert!((0..3).all(|c| (point[c] - expected[c]).abs() < 1e-12));
    }
    let built = msplines_common::mesh::TriangleMesh::build(surface.positions, surface.triangles);
    let built = built.expect("a manifold");
    assert!(built.topology().boundary_loops().is_empty());
    assert_eq!(built.topology().euler_characteristic(), 2);
}

#[test]
fn points_and_orders_that_make_no_sense_are_refused() {
    let mesh = box_24();
    let spline = fitted(&mesh, &smooth(&mesh), &Options::default()).spline;
    let prepared = |face, at: [f64; 2], order| {
        let point = SurfacePoint {
            face,
            at: [at[0], at[1], 0.0],
        };
        spline.prepare(&[point], order).err()
    };
    assert!(matches!(
        prepared(99, [0.5; 2], Order::Value),
        Some(EvaluateError::NoSuchFace { .. })
    ));
    assert!(matches!(
        prepared(0, [1.5, 0.5], Order::Value),
        Some(EvaluateError::OutsideFace { .. })
    ));
    assert!(matches!(
        prepared(0, [f64::NAN, 0.5], Order::Value),
        Some(EvaluateError::OutsideFace { .. })
    ));
    let corner = (0..24)
        .find(|&v| mesh.topology().valence(v) == 3)
        .expect("a corner of the box");
    let h = mesh.topology().vertex_half_edge(corner);
    let at = face_coordinates(h % 4, [0.0, 0.0]);
    assert!(prepared(h / 4, at, Order::Value).is_none());
    let error = prepared(h / 4, at, Order::First).expect("no derivative");
    assert!(
        error.to_string().contains("extraordinary vertex"),
        "{error}"
    );
}
