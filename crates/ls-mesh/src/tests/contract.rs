//! Stored parts, equal bits, and what is refused.

use msplines_common::evaluate::{EvaluateError, Order, Samples, SurfaceSpline, VertexData};
use msplines_common::mesh::SurfacePoint;
use msplines_common::progress::unobserved;

use super::{SOFT, coordinates, fitted, given, positions, selected, square, torus};
use crate::space::Space;
use crate::{Constraints, FitError, LsMesh, Options, Selection, fit, fit_in};

#[test]
fn stored_controls_give_the_same_bits() {
    let mesh = torus(20, 12);
    for constraints in [SOFT, Constraints::Hard] {
        let spline = fitted(
            &mesh,
            &selected(31, Selection::Combined { solves: 4 }, constraints),
        );
        let (controls, values) = (spline.controls().to_vec(), spline.control_values().to_vec());
        let stored = LsMesh::from_parts(&mesh, constraints, 3, controls, values).unwrap();
        assert_eq!(stored.vertex_values(), spline.vertex_values());
    }
}

#[test]
fn a_shared_space_gives_the_same_bits_fit_after_fit() {
    let mesh = torus(20, 12);
    let space = Space::assemble(&mesh).unwrap();
    let options = selected(31, Selection::Combined { solves: 4 }, SOFT);
    let first = coordinates(&mesh);
    let second: Vec<f64> = first.iter().map(|x| x.sin()).collect();
    for data in [&first, &second, &first] {
        let alone = fit(&mesh, positions(data), &options, &mut unobserved()).unwrap();
        let shared = fit_in(&space, positions(data), &options, &mut unobserved()).unwrap();
        let (alone, shared) = (alone.spline, shared.spline);
        assert_eq!(alone.controls(), shared.controls());
        assert_eq!(alone.vertex_values(), shared.vertex_values());
        let (controls, values) = (shared.controls().to_vec(), shared.control_values().to_vec());
        let stored = LsMesh::from_parts_in(&space, SOFT, 3, controls, values).unwrap();
        assert_eq!(stored.vertex_values(), shared.vertex_values());
    }
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    let mesh = torus(90, 60);
    let options = selected(150, Selection::Combined { solves: 8 }, SOFT);
    let [one, two] = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| fitted(&mesh, &options))
    });
    assert_eq!(one.controls(), two.controls());
    assert_eq!(one.vertex_values(), two.vertex_values());
}

#[test]
fn what_does_not_fit_the_mesh_is_refused_with_a_remedy() {
    let mesh = torus(8, 6);
    let values = coordinates(&mesh);
    let refused = |options: &Options, values: &[f64]| {
        fit(&mesh, positions(values), options, &mut unobserved())
            .unwrap_err()
            .to_string()
    };
    let select = |count| selected(count, Selection::Combined { solves: 4 }, SOFT);
    let text = "no control is asked for; a surface needs at least one per component of the mesh";
    assert_eq!(refused(&select(0), &values), text);
    assert_eq!(refused(&given(&[], SOFT), &values), text);
    assert_eq!(
        refused(&select(49), &values),
        "49 controls are more than the mesh has vertices; ask for at most 48"
    );
    assert_eq!(
        refused(&given(&[1, 48], SOFT), &values),
        "control 1 is vertex 48, but the mesh has 48 vertices, numbered from 0"
    );
    assert_eq!(
        refused(&given(&[7, 7], SOFT), &values),
        "vertex 7 is given as a control twice; give it once"
    );
    assert_eq!(
        refused(&select(9), &values[1..]),
        "143 values are not 48 vertices times 3 components; give one row per vertex, and at least \
         one component"
    );
    let mut broken = values.clone();
    broken[3 * 5 + 2] = f64::NAN;
    assert_eq!(
        refused(&select(9), &broken),
        "component 2 at vertex 5 is NaN; give finite values of at most 1e150"
    );
    assert_eq!(
        refused(&given(&[7], Constraints::Soft { weight: -1.0 }), &values),
        "a control weight of -1.0 is not positive with a finite square; use 1, or hard constraints"
    );
    assert_eq!(
        refused(
            &selected(9, Selection::Combined { solves: 0 }, SOFT),
            &values
        ),
        "a combined selection of 0 solves selects nothing; give at least 1"
    );
    let none = VertexData {
        dimension: 0,
        values: &[],
    };
    let error = fit(&mesh, none, &select(9), &mut unobserved()).unwrap_err();
    assert!(matches!(error, FitError::WrongLength { dimension: 0, .. }));
}

#[test]
fn faces_are_linear_and_points_outside_are_refused() {
    let mesh = square(5, 5);
    let spline = fitted(&mesh, &given(&[0, 12, 24], Constraints::Hard));
    let points = [[1.0, 0.0, 0.0], [0.25, 0.25, 0.5]].map(|at| SurfacePoint { face: 3, at });
    let mut samples = Samples::default();
    spline
        .prepare(&points, Order::Value)
        .unwrap()
        .evaluate(&mut samples);
    let corner = |i: usize| &spline.vertex_values()[3 * mesh.faces()[3][i] as usize..][..3];
    assert_eq!((samples.dimension, &samples.values[..3]), (3, corner(0)));
    for side in 0..3 {
        let expected = 0.25 * corner(0)[side] + 0.25 * corner(1)[side] + 0.5 * corner(2)[side];
        assert!((samples.values[3 + side] - expected).abs() < 1e-14);
    }
    let refused = |point, order| spline.prepare(&[point], order).err().unwrap();
    let derivative = refused(points[0], Order::First);
    assert!(matches!(derivative, EvaluateError::OrderUnavailable { .. }));
    let outside = SurfacePoint {
        face: 3,
        at: [1.2, -0.2, 0.0],
    };
    assert_eq!(
        refused(outside, Order::Value),
        EvaluateError::OutsideFace { point: 0, face: 3 }
    );
    let nowhere = SurfacePoint {
        face: 32,
        at: points[0].at,
    };
    assert!(matches!(
        refused(nowhere, Order::Value),
        EvaluateError::NoSuchFace { .. }
    ));
}

#[test]
fn options_keep_the_paper_and_refuse_unknown_names() {
    assert_eq!(Options::default().constraints, Options::PAPER.constraints);
    assert_eq!(Options::default().selection, Options::PAPER.selection);
}
