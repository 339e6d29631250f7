//! Evaluation, refinement, changes of basis, faces, inversion.

use msplines_common::bspline::BezierCells;
use msplines_common::evaluate::{EvaluateError, Order, Samples, VolumePoint, VolumeSpline};
use msplines_common::{Point3, Vector3};

use super::maps::{ball, bent_bar, folded, parameters, shear};
use crate::TrivariateSpline;
use crate::spline::{Face, Inverter, SplineError};

/// Rounding of sums of a few hundred numbers around 1.
const ROUNDING: f64 = 1e-13;

fn spline(spans: usize) -> TrivariateSpline {
    TrivariateSpline::from_map(spans, shear).expect("a spline")
}

#[test]
fn greville_points_of_the_identity_give_the_identity() {
    let identity = TrivariateSpline::from_map(5, Point3::from).expect("a spline");
    for at in parameters(50, 0.3, 1) {
        let jet = identity.jet(at);
        assert!((jet.value - Point3::from(at)).norm() < ROUNDING);
        assert!((jet.determinant() - 1.0).abs() < ROUNDING);
        assert!(jet.second.iter().all(|d| d.norm() < 1e-11));
    }
}

#[test]
fn derivatives_are_differences() {
    let spline = spline(4);
    let h = 1e-5;
    for at in parameters(20, 0.0, 2) {
        let at = at.map(|t| 0.01 + 0.98 * t);
        let jet = spline.jet(at);
        let moved = |axis: usize, by: f64| {
            let mut to = at;
            to[axis] += by;
            spline.jet(to)
        };
        let mut pair = 0;
        for a in 0..3 {
            let (back, ahead) = (moved(a, -h), moved(a, h));
            let slope = (ahead.value - back.value) / (2.0 * h);
            assert!((slope - jet.first[a]).norm() < 1e-7);
            for b in a..3 {
                let curvature = (ahead.first[b] - back.first[b]) / (2.0 * h);
                assert!((curvature - jet.second[pair]).norm() < 1e-5, "{a} {b}");
                pair += 1;
            }
        }
    }
}

#[test]
fn a_batch_is_the_jets_of_its_points() {
    let spline = spline(3);
    let points: Vec<VolumePoint> = parameters(40, 0.5, 3)
        .into_iter()
        .map(|at| VolumePoint { at })
        .collect();
    let mut out = Samples::default();
    let prepared = spline.prepare(&points, Order::Second).expect("prepared");
    prepared.evaluate(&mut out);
    for (i, point) in points.iter().enumerate() {
        let jet = spline.jet(point.at);
        let vectors = |from: &[f64], n: usize| -> Vec<Vector3<f64>> {
            let own = &from[3 * n * i..3 * n * (i + 1)];
            own.chunks_exact(3)
                .map(Vector3::from_column_slice)
                .collect()
        };
        assert_eq!(vectors(&out.values, 1), [jet.value.coords]);
        assert_eq!(vectors(&out.first, 3), jet.first);
        assert_eq!(vectors(&out.second, 6), jet.second);
    }
    for at in [[0.5, 1.1, 0.5], [0.5, f64::NAN, 0.0]] {
        let points = [VolumePoint { at: [0.0; 3] }, VolumePoint { at }];
        let error = spline.prepare(&points, Order::Value).err();
        assert_eq!(error, Some(EvaluateError::OutsideCube { point: 1 }));
    }
}

#[test]
fn refining_and_bezier_points_keep_the_solid() {
    let spline = spline(3);
    let fine = spline.refined().expect("a refinement");
    assert_eq!(fine.spans(), 6);
    let cells = spline.bezier_cells();
    let back = TrivariateSpline::from_bezier_cells(&cells).expect("a spline");
    let apart = |a: &TrivariateSpline| {
        let pairs = a.points().iter().zip(spline.points());
        pairs.map(|(p, q)| (p - q).norm()).fold(0.0, f64::max)
    };
    assert!(apart(&back) < ROUNDING, "{}", apart(&back));
    for at in parameters(100, 0.3, 4) {
        assert!((fine.position(at) - spline.position(at)).norm() < ROUNDING);
    }
}

#[test]
fn cells_that_do_not_join_are_refused() {
    let cells = spline(2).bezier_cells();
    let mut points = cells.points().to_vec();
    points[70].x += 0.1;
    let torn = BezierCells::build(cells.shape(), [3; 3], points, None).expect("cells");
    let error = TrivariateSpline::from_bezier_cells(&torn).expect_err("torn");
    assert!(error.to_string().contains("does not join"), "{error}");
    let few = BezierCells::build(cells.shape(), [3; 3], cells.points()[..128].to_vec(), None);
    assert!(TrivariateSpline::from_bezier_cells(&few.expect("two cells")).is_err());
}

#[test]
fn faces_are_the_boundary() {
    let spline = spline(4);
    for face in Face::ALL {
        let surface = spline.face(face);
        for at in parameters(10, 0.3, 5) {
            let at = [at[0], at[1]];
            let jet = spline.jet(face.parameter(at));
            assert!((surface.position(at) - jet.value).norm() < ROUNDING);
            let slope = surface.derivative(at, [1, 0]);
            assert!((slope - jet.first[face.free()[0]]).norm() < 1e-12);
        }
        assert_eq!(surface.bezier_cells().len(), 16);
    }
}

#[test]
fn moved_points_change_only_their_surroundings() {
    let spline = spline(8);
    let moved = spline.with_moved(&[([3, 3, 3], Point3::new(9.0, 9.0, 9.0))]);
    let moved = moved.expect("a spline");
    let changes = |at| (moved.position(at) - spline.position(at)).norm();
    // The parameter of the point is (3 - 1) / 8 in each direction, two spans are 0.25.
    assert!(changes([0.25; 3]) > 0.1);
    assert_eq!(changes([0.501, 0.25, 0.25]), 0.0);
    let error = spline.with_moved(&[([0, 11, 0], Point3::origin())]);
    let expected = SplineError::NoSuchPoint {
        index: [0, 11, 0],
        last: 10,
    };
    assert_eq!(error, Err(expected));
}

#[test]
fn grids_are_positions() {
    let spline = spline(3);
    let grid = spline.grid(4);
    for (at, point) in grid.iter().enumerate() {
        let parameter = [at % 5, at / 5 % 5, at / 25].map(|i| i as f64 / 4.0);
        assert!((spline.position(parameter) - point).norm() < ROUNDING);
    }
}

#[test]
fn bad_lattices_are_refused() {
    assert!(TrivariateSpline::build(0, vec![]).is_err());
    assert!(TrivariateSpline::build(usize::MAX, vec![]).is_err());
    assert!(TrivariateSpline::from_map(usize::MAX, Point3::from).is_err());
    let error = TrivariateSpline::build(1, vec![Point3::origin(); 63]).expect_err("too few");
    assert_eq!(
        error.to_string(),
        "63 control points for 1 spans; give (1 + 3)³ = 64"
    );
    let mut points = vec![Point3::origin(); 64];
    points[21].y = f64::NAN;
    let error = TrivariateSpline::build(1, points);
    assert_eq!(error, Err(SplineError::NotFinite { index: [1, 1, 1] }));
}

#[test]
fn positions_lead_back_to_their_parameters() {
    for map in [shear, bent_bar] {
        let spline = TrivariateSpline::from_map(6, map).expect("a spline");
        let inverter = Inverter::build(&spline);
        for at in parameters(200, 0.4, 6) {
            let found = inverter
                .invert(&spline.position(at), 1e-12)
                .expect("inside");
            let apart = Point3::from(found.parameter) - Point3::from(at);
            assert!(apart.norm() < 1e-9, "{at:?} {found:?}");
        }
    }
}

#[test]
fn positions_of_the_singular_edges_of_a_ball_are_found() {
    let spline = TrivariateSpline::from_map(8, ball).expect("a spline");
    let inverter = Inverter::build(&spline);
    for at in [[0.0, 0.0, 0.3], [0.0; 3], [1.0, 0.4, 1.0], [0.5; 3]] {
        let found = inverter.invert(&spline.position(at), 1e-9);
        assert!(found.is_ok(), "{at:?}: {found:?}");
    }
}

#[test]
fn positions_outside_are_missed_by_their_distance() {
    let identity = TrivariateSpline::from_map(4, Point3::from).expect("a spline");
    let inverter = Inverter::build(&identity);
    let miss = inverter
        .invert(&Point3::new(0.3, 1.5, 2.0), 1e-9)
        .expect_err("outside");
    assert!((miss.distance - 1.25_f64.sqrt()).abs() < 1e-9);
    assert!((miss.parameter[0] - 0.3).abs() < 1e-6 && miss.parameter[1] == 1.0);
    let miss = inverter.invert(&Point3::new(f64::NAN, 0.0, 0.0), 1e-9);
    assert!(miss.expect_err("nowhere").distance.is_infinite());
    let fold = TrivariateSpline::from_map(4, folded).expect("a spline");
    let miss = Inverter::build(&fold).invert(&Point3::new(0.9, 0.5, 0.5), 1e-9);
    assert!(miss.expect_err("beyond the fold").distance > 0.5);
}
