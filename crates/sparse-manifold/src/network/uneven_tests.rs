//! Surfaces over networks that evenly spread charts do not suit: with short arcs beside long ones, and
//! with corners.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use msplines_common::mesh::curves::{Curve, CurveNetwork};
use nalgebra::Point3;

use super::NetworkOptions;
use super::surface_tests::{cube, fitted};

/// Returns circles on a torus at these angles about its axis, and about its core.
fn torus_network(about_axis: &[f64], about_core: &[f64]) -> CurveNetwork {
    const STEPS: usize = 4;
    let finer = |angles: &[f64]| -> Vec<f64> {
        let ends = angles[1..].iter().copied().chain([angles[0] + TAU]);
        let pairs: Vec<(f64, f64)> = angles.iter().copied().zip(ends).collect();
        let parts =
            |(a, b): (f64, f64)| (0..STEPS).map(move |i| a + (b - a) * i as f64 / STEPS as f64);
        pairs.into_iter().flat_map(parts).collect()
    };
    let (us, vs) = (finer(about_axis), finer(about_core));
    let place = |u: f64, v: f64| {
        let radius = 3.0 + v.cos();
        Point3::new(radius * u.cos(), radius * u.sin(), v.sin())
    };
    let mut points = Vec::new();
    let mut ids = BTreeMap::new();
    for (i, &u) in us.iter().enumerate() {
        for (j, &v) in vs.iter().enumerate() {
            if i % STEPS == 0 || j % STEPS == 0 {
                ids.insert((i, j), points.len() as u32);
                points.push(place(u, v));
            }
        }
    }
    let closed = |at: &dyn Fn(usize) -> (usize, usize), count: usize| {
        Curve::smooth((0..=count).map(|i| ids[&at(i % count)]).collect())
    };
    let meridians = (0..us.len())
        .step_by(STEPS)
        .map(|i| closed(&|j| (i, j), vs.len()));
    let parallels = (0..vs.len())
        .step_by(STEPS)
        .map(|j| closed(&|i| (i, j), us.len()));
    let curves = meridians.chain(parallels).collect();
    CurveNetwork::build(points, curves).expect("curves")
}

#[test]
fn short_arcs_beside_long_ones_of_the_same_curve_are_followed_without_folds() {
    let axis = [0.0, 0.1, 1.3, 2.5, 2.6, 3.7, 5.0];
    let core = [0.0, 0.1, 1.6, 3.1, 3.2, 4.7];
    let network = torus_network(&axis, &core);
    let fit = fitted(&network, &NetworkOptions::default());
    let report = &fit.report;
    assert_eq!(report.charts, 42);
    // Found: 1.1e-3, 20 degrees. Curves with a speed of their own in every face: 8.5e-3, 653 folds;
    // second differences that all count alike: 244 folds.
    assert!(report.curve_rms < 1.5e-3, "{report:?}");
    assert!(
        report.facet_turn_max_degrees < 30.0 && report.sharp_facets == 0,
        "{report:?}"
    );
    assert!(report.cone_points.is_empty(), "{report:?}");
}

#[test]
fn a_cube_of_smooth_curves_has_points_at_its_corners_and_tells_so() {
    let corners = cube();
    let smooth = corners
        .curves()
        .iter()
        .map(|c| Curve::smooth(c.points.clone()))
        .collect();
    let network = CurveNetwork::build(corners.points().to_vec(), smooth).expect("curves");
    let fit = fitted(&network, &NetworkOptions::default());
    let report = &fit.report;
    // Found: 4.1e-4; without cones 4.9e-3.
    assert!(report.curve_rms < 8e-4, "{report:?}");
    assert!(report.kink_max_degrees < 1e-3, "{report:?}");
    let angle = (1.0 / 3.0_f64.sqrt()).asin().to_degrees();
    assert_eq!(report.cone_points.len(), 8);
    for cone in &report.cone_points {
        assert!((cone.degrees - angle).abs() < 1e-9, "{cone:?}");
    }
    let told = "at 8 points, by up to 35 degrees, where the surface is a cone";
    assert!(
        report.warnings.iter().any(|w| w.contains(told)),
        "{:?}",
        report.warnings
    );
}
