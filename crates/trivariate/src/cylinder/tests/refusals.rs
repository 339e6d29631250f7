//! What is refused, and what can be stopped.

use std::ops::ControlFlow;

use msplines_common::mesh::{TriangleMesh, shapes, zoo};
use msplines_common::progress::{Outcome, unobserved};

use super::*;
use crate::domain::boundary::BoundaryError;

#[test]
fn surfaces_that_are_no_spheres_are_refused() {
    let refused = |surface: &TriangleMesh| map(surface, &small(), &mut unobserved()).err();
    let open = refused(&zoo::with_boundary());
    assert!(matches!(
        open,
        Some(CylinderError::Surface(BoundaryError::Open { .. }))
    ));
    let knotted = refused(&zoo::knotted());
    let genus = Some(CylinderError::Surface(BoundaryError::Genus { genus: 1 }));
    assert_eq!(knotted, genus);
    let ball = shapes::sphere(100);
    let mut points = ball.positions().to_vec();
    points[3].x = f64::NAN;
    let broken = refused(&ball.with_positions(points.clone()));
    assert!(matches!(
        broken,
        Some(CylinderError::Surface(BoundaryError::NotFinite {
            vertex: 3
        }))
    ));
    let [a, b, _] = ball.faces()[7];
    points = ball.positions().to_vec();
    points[a as usize] = points[b as usize];
    let flat = refused(&ball.with_positions(points));
    assert!(matches!(
        flat,
        Some(CylinderError::Surface(BoundaryError::FlatFace { .. }))
    ));
}

#[test]
fn poles_and_options_that_mean_nothing_are_refused() {
    let ball = shapes::sphere(200);
    let refused = |options: Options| {
        let error = map(&ball, &options, &mut unobserved()).expect_err("an error");
        error.to_string()
    };
    let given = |poles| Options {
        poles: Poles::Given(poles),
        ..small()
    };
    assert!(refused(given([4, 4])).contains("at vertices 4 and 4; choose two points"));
    assert!(refused(given([0, 9999])).contains("pole 1 is vertex 9999"));
    assert!(
        refused(Options {
            loops: 1,
            ..small()
        })
        .contains("`loops` is 1; give a number from 2")
    );
    let many = Options {
        radii: 1_000_000,
        ..small()
    };
    assert!(refused(many).contains("ask for fewer"));
    for axis_smoothing in [-0.1, f64::NAN] {
        let options = Options {
            axis_smoothing,
            ..small()
        };
        assert!(refused(options).contains("`axis_smoothing`"));
    }
    let map = mapped(&ball, &small());
    for (options, text) in [
        (multilevel(2, 12), "from 2 to 12 spans"),
        (multilevel(0, 4), "from 0 to 4 spans"),
    ] {
        let error = fit(&map, &options, &mut unobserved()).expect_err("an error");
        assert!(error.to_string().contains(text), "{error}");
    }
}

#[test]
fn a_level_of_two_loops_is_told() {
    let ball = shapes::sphere(500);
    let values: Vec<f64> = ball.positions().iter().map(|p| p.z * p.z).collect();
    let error = loops::trace(&ball, &values, &[0.01, 0.5]).err();
    let Some(CylinderError::NotOneLoop {
        level,
        crossed,
        traced,
        ..
    }) = error
    else {
        panic!("{error:?}");
    };
    assert!(level == 0.01 && traced < crossed);
}

#[test]
fn the_observer_stops_the_map_and_the_fit() {
    let ball = shapes::sphere(300);
    let mut stop = |_: &Progress| ControlFlow::Break(());
    assert_eq!(map(&ball, &small(), &mut stop), Err(CylinderError::Stopped));
    let map = mapped(&ball, &small());
    let fit = fit(&map, &multilevel(2, 8), &mut stop).expect("a fit");
    assert_eq!((fit.outcome, fit.levels.len()), (Outcome::Stopped, 1));
    assert_eq!(fit.spline.spans(), 2);
}
