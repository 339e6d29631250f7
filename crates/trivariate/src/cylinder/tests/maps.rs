//! Axes, loops and latitudes.

use std::f64::consts::PI;

use msplines_common::mesh::shapes;
use nalgebra::Point3;

use super::*;

#[test]
fn latitudes_of_a_ball_are_heights() {
    let ball = shapes::sphere(2500);
    let ends = [-1.0, 1.0].map(|z| nearest(&ball, Point3::new(0.0, 0.0, z)));
    let pole = ball.positions()[ends[1] as usize].coords;
    let options = Options {
        poles: Poles::Given(ends),
        ..small()
    };
    let map = mapped(&ball, &options);
    assert_eq!(map.axis.len(), 62);
    let height = |row: usize| {
        let heights = map.loops[64 * row..64 * (row + 1)].iter();
        heights.map(|p| p.coords.dot(&pole)).sum::<f64>() / 64.0
    };
    for (row, latitude) in map.latitudes.iter().enumerate() {
        assert!((0.5 + 0.5 * height(row) - latitude).abs() < MESHED, "{row}");
        for point in &map.loops[64 * row..64 * (row + 1)] {
            assert!(
                (point.coords.dot(&pole) - height(row)).abs() < 2.0 * MESHED,
                "{row}"
            );
        }
    }
    // A harmonic function of the height has the slope of its inverse hyperbolic tangent.
    let slope = (map.levels[45] - map.levels[16]) / (height(45).atanh() - height(16).atanh());
    for row in 8..54 {
        let expected = 0.5 + slope * height(row).atanh();
        assert!(
            (map.levels[row] - expected).abs() < MESHED * slope,
            "{row} {} {expected} {slope}",
            map.levels[row]
        );
    }
    assert!((volume(&map) / (4.0 / 3.0 * PI) - 1.0).abs() < MESHED);
}

#[test]
fn poles_of_an_ellipsoid_are_its_ends() {
    let body = ellipsoid(2.0);
    for poles in [Poles::Pierced, Poles::Extreme] {
        let map = mapped(&body, &Options { poles, ..small() });
        for (pole, latitude) in map.poles.into_iter().zip([0.0, 1.0]) {
            let end = body.positions()[pole as usize];
            assert!(end.z.abs() > 1.95, "{poles:?}: {end}");
            assert!((map.axis[if latitude > 0.0 { 61 } else { 0 }] - end).norm() < 1e-12);
        }
        let up = body.positions()[map.poles[1] as usize].z.signum();
        for (axis, latitude) in map.axis.iter().zip(&map.latitudes) {
            assert!((0.5 + 0.25 * up * axis.z - latitude).abs() < MESHED);
            assert!(axis.x.hypot(axis.y) < 0.1);
        }
        assert!((volume(&map) / (8.0 / 3.0 * PI) - 1.0).abs() < MESHED);
    }
}

#[test]
fn a_bent_tube_has_a_bent_axis() {
    let tube = bent_tube();
    let last = tube.vertex_count() as u32 - 1;
    let options = Options {
        poles: Poles::Given([0, last]),
        axis_smoothing: 0.01,
        ..small()
    };
    let map = mapped(&tube, &options);
    // Round ends are as long as the radius.
    let length = 4.0 + 0.8;
    for (axis, latitude) in map.axis.iter().zip(&map.latitudes) {
        let angle = (latitude * length - 0.4) / 2.0;
        if (0.1..1.9).contains(&angle) {
            let expected = Point3::new(2.0 * angle.cos(), 0.0, 2.0 * angle.sin());
            assert!((axis - expected).norm() < 0.1, "{latitude}: {axis}");
        }
    }
    let solid = PI * 0.16 * 4.0 + 4.0 / 3.0 * PI * 0.064;
    assert!(
        (volume(&map) / solid - 1.0).abs() < 0.03,
        "{}",
        volume(&map)
    );
    let fit = fitted(&map, &options);
    assert!(mean_determinant(&fit.spline) > 0.0);
    assert!(fit.surface.rms < 0.01, "{:?}", fit.surface);
}

#[test]
fn stretched_ends_leave_caps_out() {
    let body = ellipsoid(2.0);
    let options = Options {
        ends: Ends::Stretched,
        ..small()
    };
    let [whole, cut] = [small(), options].map(|options| mapped(&body, &options));
    assert_eq!((whole.axis.len(), cut.axis.len()), (62, 60));
    let width = |map: &CylinderMap| (map.loops[0] - map.loops[32]).norm();
    assert!(width(&whole) == 0.0 && width(&cut) > 0.1);
    assert!(volume(&cut).abs() < volume(&whole));
}

#[test]
fn samples_join_the_axis_to_the_loops() {
    let map = mapped(&ellipsoid(1.5), &small());
    let samples = map.samples(3).expect("samples");
    assert_eq!(samples.len(), 3 * 62 * 64);
    let at = 62 * 64 + 64 * 20 + 5;
    assert_eq!(
        samples.parameters()[at],
        [5.0 / 64.0, map.latitudes[20], 0.5]
    );
    let middle = nalgebra::center(&map.axis[20], &map.loops[64 * 20 + 5]);
    assert!((samples.points()[at] - middle).norm() < 1e-14);
    assert!(map.samples(1).is_err());
}
