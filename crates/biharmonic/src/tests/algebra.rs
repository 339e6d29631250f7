//! Splines added up, and knots put in and taken out.

use std::sync::Arc;

use msplines_common::evaluate::VertexData;
use msplines_common::mesh::{TriangleMesh, shapes, zoo};
use msplines_common::progress::unobserved;

use super::{farthest_knots, largest_difference, space, spline_on, spread_knots};
use crate::{
    BasisKind, BiharmonicSpline, CombineError, Creases, ExplicitBasis, Form, KnotChoice, KnotError,
    Laplacian, Options, Space, combine, fit_in,
};

/// Differences that rounding explains, against values of size 1.
const EXACT: f64 = 1e-12;

fn creased(mesh: &TriangleMesh) -> Arc<Space> {
    let creases = Creases::sharper_than(mesh, 0.6);
    let mesh = Arc::new(mesh.clone());
    Arc::new(Space::with_creases(mesh, Laplacian::Cotangent, creases).unwrap())
}

fn spaces() -> [Arc<Space>; 3] {
    [
        Arc::new(space(&zoo::closed())),
        Arc::new(space(&zoo::with_boundary())),
        creased(&shapes::cube(6)),
    ]
}

fn values(spline: &BiharmonicSpline) -> Vec<f64> {
    spline.vertex_values().unwrap()
}

#[test]
fn a_combination_has_combined_values_and_all_knots() {
    for space in spaces() {
        let one = spline_on(&space, farthest_knots(space.mesh(), 40));
        let other = spline_on(&space, spread_knots(space.mesh().vertex_count(), 30));
        let sum = combine(&[(&one, 2.0), (&other, -0.5), (&one, 0.25)]).unwrap();
        let expected: Vec<f64> = values(&one)
            .iter()
            .zip(values(&other))
            .map(|(a, b)| 2.25 * a - 0.5 * b)
            .collect();
        assert!(largest_difference(&values(&sum), &expected) < EXACT);
        let mut knots = [one.knots(), other.knots()].concat();
        knots.sort_unstable();
        knots.dedup();
        assert_eq!(sum.knots(), knots);
        let nothing = combine(&[(&one, 1.0), (&one, -1.0)]).unwrap();
        assert!(values(&nothing).iter().all(|v| v.abs() < 1e-14));
    }
}

#[test]
fn combining_is_linear() {
    let space = Arc::new(space(&zoo::genus(2)));
    let splines = [20, 35, 50].map(|count| spline_on(&space, farthest_knots(space.mesh(), count)));
    let [f, g, h] = &splines;
    let inner = combine(&[(f, 3.0), (g, -1.0)]).unwrap();
    let nested = combine(&[(&inner, 0.5), (h, 2.0)]).unwrap();
    let flat = combine(&[(f, 1.5), (g, -0.5), (h, 2.0)]).unwrap();
    assert_eq!(nested.knots(), flat.knots());
    assert!(largest_difference(&values(&nested), &values(&flat)) < EXACT);
}

#[test]
fn inserted_knots_change_nothing_and_can_be_taken_out_again() {
    const BACK: f64 = 1e-10;
    for space in spaces() {
        let spline = spline_on(&space, farthest_knots(space.mesh(), 40));
        let new: Vec<u32> = spread_knots(space.mesh().vertex_count(), 25)
            .into_iter()
            .filter(|v| spline.knots().binary_search(v).is_err())
            .rev()
            .collect();
        let finer = spline.insert_knots(&new).unwrap();
        assert_eq!(finer.knots().len(), 40 + new.len());
        assert!(largest_difference(&values(&finer), &values(&spline)) < EXACT);
        let removal = finer.remove_knots(&new).unwrap();
        assert!(removal.largest < BACK && removal.root_mean_square <= removal.largest);
        assert_eq!(removal.spline.knots(), spline.knots());
        assert!(largest_difference(&values(&removal.spline), &values(&spline)) < BACK);
        assert!(
            largest_difference(
                &values(&spline.insert_knots(&[]).unwrap()),
                &values(&spline)
            ) == 0.0
        );
    }
}

#[test]
fn control_points_before_and_after_insertion_make_one_function() {
    let space = Arc::new(space(&zoo::closed()));
    let spline = spline_on(&space, farthest_knots(space.mesh(), 40));
    let finer = spline.insert_knots(&[5, 77, 300]);
    let through_basis = |spline: &BiharmonicSpline| {
        let kind = BasisKind::JointQp;
        let basis = ExplicitBasis::build(&space, spline.knots(), kind, &mut unobserved()).unwrap();
        let points = basis.control_points(spline).unwrap();
        assert_eq!(points.len(), 3 * spline.knots().len());
        values(&basis.spline(&points, 3).unwrap())
    };
    let finer = finer.unwrap_or(spline_on(&space, farthest_knots(space.mesh(), 43)));
    let (before, after) = (through_basis(&spline), through_basis(&finer));
    assert!(largest_difference(&before, &after) < EXACT);
}

/// Removing knots is fitting the rest to the values of the spline.
#[test]
fn a_removal_is_the_nearest_spline_and_says_how_far_it_is() {
    const TOLERANCE: f64 = 1e-5; // of the distance: both are stopped iterations
    let space = Arc::new(space(&zoo::closed()));
    let spline = spline_on(&space, farthest_knots(space.mesh(), 60));
    let removed = spline.knots()[10..20].to_vec();
    let removal = spline.remove_knots(&removed).unwrap();
    let before = values(&spline);
    let left: Vec<u32> = [&spline.knots()[..10], &spline.knots()[20..]].concat();
    let data = VertexData {
        dimension: 3,
        values: &before,
    };
    let options = Options {
        knots: KnotChoice::Given(left.clone()),
        ..Options::default()
    };
    let fitted = fit_in(&space, data, &options, &mut unobserved())
        .unwrap()
        .spline;
    assert_eq!(removal.spline.knots(), left);
    let after = values(&removal.spline);
    let squares: f64 = before
        .iter()
        .zip(&after)
        .map(|(a, b)| (a - b).powi(2))
        .sum();
    let mean = (squares / space.mesh().vertex_count() as f64).sqrt();
    assert!((mean - removal.root_mean_square).abs() < TOLERANCE * mean);
    assert!(removal.largest > mean && removal.largest < 100.0 * mean);
    assert!(largest_difference(&after, &values(&fitted)) < 1e-2 * mean);
}

#[test]
fn what_cannot_be_combined_is_named() {
    let [closed, open, _] = spaces();
    let spline = spline_on(&closed, spread_knots(600, 20));
    let check = |other: &BiharmonicSpline| combine(&[(&spline, 1.0), (other, 1.0)]).unwrap_err();
    assert_eq!(combine(&[]).unwrap_err(), CombineError::Nothing);
    let elsewhere = spline_on(&open, spread_knots(400, 20));
    assert_eq!(check(&elsewhere), CombineError::Mesh { index: 1 });
    assert_eq!(
        check(&elsewhere).to_string(),
        "spline 1 lies on another mesh than the first; fit both to the same mesh"
    );
    let mesh = Arc::new(zoo::closed());
    let intrinsic = Space::build(Arc::clone(&mesh), Laplacian::IntrinsicDelaunay).unwrap();
    let other = spline_on(&Arc::new(intrinsic), spread_knots(600, 20));
    assert_eq!(check(&other), CombineError::Laplacian { index: 1 });
    let edge = mesh.faces()[0];
    let creases = Creases::along(&mesh, &[[edge[0], edge[1]]]).unwrap();
    let sharp = Space::with_creases(Arc::clone(&mesh), Laplacian::Cotangent, creases).unwrap();
    let other = spline_on(&Arc::new(sharp), spread_knots(600, 20));
    assert_eq!(check(&other), CombineError::Creases { index: 1 });
    let flat = BiharmonicSpline::from_parts(
        &closed,
        1,
        vec![3],
        Form::Implicit {
            coefficients: vec![0.0],
            constant: vec![1.0],
        },
    );
    let (index, found, expected) = (1, 1, 3);
    assert_eq!(
        check(&flat.unwrap()),
        CombineError::Dimension {
            index,
            found,
            expected
        }
    );
    let factor = f64::NAN;
    assert!(matches!(
        combine(&[(&spline, factor)]),
        Err(CombineError::Factor { index: 0, .. })
    ));
    let same_content = spline_on(&spaces()[0], spread_knots(600, 25));
    assert!(combine(&[(&spline, 1.0), (&same_content, 1.0)]).is_ok());
}

#[test]
fn knots_that_cannot_come_or_go_are_named() {
    let space = Arc::new(space(&zoo::closed()));
    let spline = spline_on(&space, vec![3, 50, 200, 400]);
    let text = |error: KnotError| error.to_string();
    assert_eq!(
        text(spline.insert_knots(&[7, 50]).unwrap_err()),
        "vertex 50 is a knot already; insert other vertices"
    );
    assert_eq!(
        text(spline.insert_knots(&[7, 9999]).unwrap_err()),
        "knot 1 is vertex 9999, but the mesh has 642 vertices"
    );
    assert_eq!(
        text(spline.insert_knots(&[7, 8, 7]).unwrap_err()),
        "vertex 7 is given as a knot more than once; give each knot once"
    );
    assert_eq!(
        text(spline.remove_knots(&[50, 60]).unwrap_err()),
        "vertex 60 is no knot of the spline; remove some of its knots"
    );
    assert_eq!(
        text(spline.remove_knots(&[400, 200, 50, 3]).unwrap_err()),
        "all 4 knots were to be removed; leave at least one"
    );
    let all = spline.remove_knots(&[50, 200, 400]).unwrap();
    assert_eq!(all.spline.knots(), [3]);
}
