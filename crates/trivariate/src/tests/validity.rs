//! Certificates against dense samples, and gradients against differences.

use msplines_common::Point3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::maps::{ball, bent_bar, folded, parameters, shear};
use crate::TrivariateSpline;
use crate::validity::{
    BoundaryOptions, BoundaryVerdict, COEFFICIENTS, Determinants, LANES, Options, boundary, certify,
};

/// The identity with control points moved at random.
fn shaken(spans: usize, by: f64, seed: u64) -> TrivariateSpline {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let map = |at: [f64; 3]| {
        let shake = |t: f64, r: f64| t + by * (r - 0.5) / spans as f64;
        Point3::from(at.map(|t| shake(t, random.random())))
    };
    TrivariateSpline::from_map(spans, map).expect("a spline")
}

#[test]
fn the_identity_is_certified_with_bound_one() {
    let identity = TrivariateSpline::from_map(3, Point3::from).expect("a spline");
    let certificate = certify(&identity, &Options::default());
    assert!(certificate.holds());
    assert!(
        (certificate.bound - 1.0).abs() < 1e-11,
        "{}",
        certificate.bound
    );
    assert!((certificate.volume - 1.0).abs() < 1e-12);
    let mirrored = TrivariateSpline::from_map(3, |[u, v, w]| Point3::new(v, u, w));
    let certificate = certify(&mirrored.expect("a spline"), &Options::default());
    assert_eq!((certificate.certified, certificate.refuted.len()), (0, 27));
    let flat = TrivariateSpline::from_map(2, |[u, v, _]| Point3::new(u, v, 0.0));
    let certificate = certify(&flat.expect("a spline"), &Options::default());
    assert_eq!(certificate.refuted.len(), 8);
    assert_eq!(certificate.bound, f64::NEG_INFINITY);
}

#[test]
fn coefficients_are_the_determinant() {
    let spline = shaken(1, 1.0, 1);
    let determinants = Determinants::build(&[spline.block([0; 3]); LANES]);
    for at in parameters(50, 0.3, 2) {
        let mut rows = [[0.0; 9]; 3];
        for (row, x) in rows.iter_mut().zip(at) {
            msplines_common::bspline::bernstein::values(x, row);
        }
        let term = |at: usize| rows[0][at % 9] * rows[1][at / 9 % 9] * rows[2][at / 81];
        let value: f64 = (0..COEFFICIENTS)
            .map(|at| term(at) * determinants.coefficients[at][2])
            .sum();
        assert!((value - spline.jet(at).determinant()).abs() < 1e-12);
    }
}

#[test]
fn gradients_are_differences() {
    let mut random = Pcg64Mcg::seed_from_u64(3);
    let spline = shaken(1, 1.0, 4);
    let weights: Vec<f64> = (0..COEFFICIENTS)
        .map(|_| random.random::<f64>() - 0.5)
        .collect();
    let energy = |spline: &TrivariateSpline| -> f64 {
        let determinants = Determinants::build(&[spline.block([0; 3]); LANES]);
        let terms = determinants.coefficients.iter().zip(&weights);
        terms.map(|(c, w)| c[0] * w).sum()
    };
    let determinants = Determinants::build(&[spline.block([0; 3]); LANES]);
    let lanes: Vec<[f64; LANES]> = weights.iter().map(|&w| [w; LANES]).collect();
    let gradient = determinants.gradient(&lanes);
    let h = 1e-5;
    for p in (0..64).step_by(5) {
        for d in 0..3 {
            let moved = |by: f64| {
                let index = [p % 4, p / 4 % 4, p / 16];
                let mut to = spline.point(index).expect("a point");
                to[d] += by;
                energy(&spline.with_moved(&[(index, to)]).expect("a spline"))
            };
            let slope = (moved(h) - moved(-h)) / (2.0 * h);
            assert!(
                (slope - gradient[p / 4][p % 4][d][1]).abs() < 1e-8,
                "{p} {d}"
            );
        }
    }
}

#[test]
fn certificates_agree_with_dense_samples() {
    let (mut held, mut refuted) = (0, 0);
    for seed in 0..12 {
        let spline = shaken(2, 1.0 + 0.5 * seed as f64, seed);
        let certificate = certify(&spline, &Options::default());
        let samples = parameters(3000, 0.5, seed);
        let least = samples.iter().map(|&at| spline.jet(at).determinant());
        let least = least.fold(f64::INFINITY, f64::min) / certificate.volume;
        if certificate.holds() {
            held += 1;
            assert!(certificate.bound > 0.0 && certificate.bound <= least);
        }
        for spot in &certificate.refuted {
            refuted += 1;
            let value = spline.jet(spot.parameter).determinant() / certificate.volume;
            assert!(value <= 1e-14, "{value} at {spot:?}");
        }
    }
    assert!(
        held > 2 && refuted > 2,
        "{held} held, {refuted} spots refuted"
    );
}

#[test]
fn folds_and_smooth_edges_are_refuted() {
    for map in [folded, ball] {
        let spline = TrivariateSpline::from_map(4, map).expect("a spline");
        assert!(!certify(&spline, &Options::default()).refuted.is_empty());
    }
    for map in [shear, bent_bar] {
        let spline = TrivariateSpline::from_map(4, map).expect("a spline");
        assert!(certify(&spline, &Options::default()).holds());
    }
}

#[test]
fn boundaries_that_do_not_meet_are_proved_so() {
    for map in [Point3::from, shear, bent_bar] {
        let spline = TrivariateSpline::from_map(4, map).expect("a spline");
        let report = boundary(&spline, &BoundaryOptions::default());
        assert_eq!(report.verdict, BoundaryVerdict::Injective, "{report:?}");
    }
}

#[test]
fn a_thin_oblique_plate_is_proved_to_be_free_of_contacts() {
    // Derivatives differ from a plane by 1e-9 only, as along creases that are nearly smooth.
    let plate = |[u, v, w]: [f64; 3]| Point3::new(u, v + u, 1e-9 * w + 0.3 * u);
    let spline = TrivariateSpline::from_map(4, plate).expect("a spline");
    let report = boundary(&spline, &BoundaryOptions::default());
    assert_eq!(report.verdict, BoundaryVerdict::Injective, "{report:?}");
    assert!(report.pairs < 2000, "{}", report.pairs);
}

#[test]
fn an_immersion_that_meets_itself_is_found() {
    // A bar bent by more than a whole turn: the determinant is positive, the ends overlap.
    let bar = |[u, v, w]: [f64; 3]| {
        let (sin, cos) = (1.1 * std::f64::consts::TAU * w).sin_cos();
        let radius = 1.5 + u - 0.5;
        Point3::new(radius * cos, v + 0.5 * w, radius * sin)
    };
    let spline = TrivariateSpline::from_map(12, bar).expect("a spline");
    assert!(certify(&spline, &Options::default()).holds());
    let options = BoundaryOptions {
        contact_depth: 2,
        ..BoundaryOptions::default()
    };
    let report = boundary(&spline, &options);
    assert_eq!(report.verdict, BoundaryVerdict::Contact);
    assert!(report.contacts.iter().all(|c| c.distance < 0.3));
}
