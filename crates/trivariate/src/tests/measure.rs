//! Measures of known maps.

use msplines_common::Point3;

use super::maps::{ball, folded, shear};
use crate::TrivariateSpline;
use crate::measure::{hexahedra, is_degenerate, measure};

#[test]
fn the_identity_has_no_distortion() {
    let spline = TrivariateSpline::from_map(4, |[u, v, w]| Point3::new(3.0 * u, 3.0 * v, 3.0 * w));
    let spline = spline.expect("a spline");
    let measures = measure(&spline, 5);
    assert_eq!((measures.elements, measures.degenerate), (3000, 0));
    assert!(measures.distortion_sum < 1e-9);
    assert!((measures.stretch - 1.0).abs() < 1e-12);
    assert!((measures.volume - 27.0).abs() < 1e-10);
    let mesh = hexahedra(&spline, 3);
    assert_eq!((mesh.points.len(), mesh.cells.len()), (64, 27));
    assert_eq!(mesh.cells[0], [0, 1, 5, 4, 16, 17, 21, 20]);
    assert!(
        mesh.scaled_jacobians
            .iter()
            .all(|j| (j - 1.0).abs() < 1e-12)
    );
}

#[test]
fn a_stretched_box_has_its_stretch() {
    let spline = TrivariateSpline::from_map(2, |[u, v, w]| Point3::new(8.0 * u, v, w));
    let measures = measure(&spline.expect("a spline"), 4);
    assert!(measures.distortion_mean < 1e-12);
    assert!((measures.stretch - 4.0).abs() < 1e-12);
}

#[test]
fn two_halves_of_different_size_have_a_known_distortion() {
    // Volumes grow as 2 u: the mean of |ln 2u| over the unit interval is ln 2.
    let spline = TrivariateSpline::from_map(64, |[u, v, w]| {
        Point3::new(u * u - 1.0 / 3.0 / 4096.0, v, w)
    });
    let measures = measure(&spline.expect("a spline"), 40);
    assert!(
        (measures.distortion_mean - 2.0_f64.ln()).abs() < 0.02,
        "{measures:?}"
    );
    assert_eq!(measures.degenerate, 0);
}

#[test]
fn folds_are_counted() {
    let spline = TrivariateSpline::from_map(8, folded).expect("a spline");
    let measures = measure(&spline, 10);
    assert_eq!(measures.degenerate, 12_000);
    let mesh = hexahedra(&spline, 10);
    assert_eq!(
        mesh.scaled_jacobians.iter().filter(|&&j| j <= 0.0).count(),
        500
    );
    let flat = TrivariateSpline::from_map(2, |[u, v, _]| Point3::new(u, v, 0.0));
    let measures = measure(&flat.expect("a spline"), 2);
    assert_eq!(measures.degenerate, 192);
}

#[test]
fn volumes_that_round_to_zero_are_decided_exactly() {
    let tiny = f64::EPSILON;
    let up = [
        [0.0; 3],
        [0.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
        [1.0, 1.0 + tiny, 1.0],
    ];
    assert!(!is_degenerate(&up));
    let down = [up[0], up[1], up[3], up[2]];
    assert!(is_degenerate(&down));
    assert!(is_degenerate(&[[0.0; 3], up[1], up[2], up[2]]));
    assert!(is_degenerate(&[[f64::NAN; 3]; 4]));
}

#[test]
fn measures_of_smooth_maps_are_moderate() {
    for map in [shear, ball] {
        let spline = TrivariateSpline::from_map(8, map).expect("a spline");
        let measures = measure(&spline, 20);
        assert!(
            measures.distortion_mean < 0.6 && measures.stretch < 4.0,
            "{measures:?}"
        );
    }
}
