//! Fits of known maps.

use msplines_common::Point3;
use msplines_common::progress::{Outcome, unobserved};

use super::maps::{ball, samples};
use crate::fit::{certified, least_squares, multilevel};
use crate::{FitError, VolumeSamples};

#[test]
fn one_sample_follows_the_closed_formula() {
    let (at, z) = ([0.37, 0.81, 0.5], Point3::new(2.0, -1.0, 0.5));
    let samples = VolumeSamples::build(vec![at], vec![z]).expect("a sample");
    let options = multilevel::Options {
        coarsest: 2,
        finest: 2,
        stop_rms: 0.0,
    };
    let fit = multilevel::fit(&samples, &options, &mut unobserved()).expect("a fit");
    let rows = at
        .map(|t| msplines_common::bspline::locate(2, t))
        .map(|(span, x)| (span, msplines_common::bspline::weights(x)));
    let mut squares = 0.0;
    let weight = |p: usize| rows[0].1[p % 4] * rows[1].1[p / 4 % 4] * rows[2].1[p / 16];
    for p in 0..64 {
        squares += weight(p) * weight(p);
    }
    for p in 0..64 {
        let index = [rows[0].0 + p % 4, rows[1].0 + p / 4 % 4, rows[2].0 + p / 16];
        let expected = z.coords * (weight(p) / squares);
        let found = fit.spline.point(index).expect("in the lattice").coords;
        assert!((found - expected).norm() < 1e-14, "{index:?}");
    }
    assert!((fit.spline.position(at) - z).norm() < 1e-14);
    assert!(fit.levels[0].rms < 1e-14);
}

#[test]
fn levels_lower_the_residual_and_add_up() {
    let samples = samples(ball, 4000, 1);
    let options = multilevel::Options {
        coarsest: 2,
        finest: 16,
        stop_rms: 0.0,
    };
    let fit = multilevel::fit(&samples, &options, &mut unobserved()).expect("a fit");
    assert!(
        fit.levels
            .windows(2)
            .all(|pair| pair[1].rms < 0.7 * pair[0].rms)
    );
    assert_eq!(fit.at_level(4), fit.spline);
    let coarse = fit.at_level(2);
    assert_eq!(coarse.spans(), 4);
    let squares = samples.parameters().iter().zip(samples.points());
    let squares: f64 = squares
        .map(|(&t, p)| (coarse.position(t) - p).norm_squared())
        .sum();
    assert!(((squares / 4000.0).sqrt() - fit.levels[1].rms).abs() < 1e-13);
}

#[test]
fn levels_stop_at_the_residual_asked_for() {
    let samples = samples(ball, 2000, 2);
    let mut options = multilevel::Options {
        stop_rms: 0.05,
        ..multilevel::Options::PAPER
    };
    let fit = multilevel::fit(&samples, &options, &mut unobserved()).expect("a fit");
    assert_eq!(fit.outcome, Outcome::Converged);
    assert!(fit.levels.len() < 6 && fit.levels[fit.levels.len() - 1].rms <= 0.05);
    options.finest = 4;
    let fit = multilevel::fit(&samples, &options, &mut unobserved()).expect("a fit");
    assert_eq!(fit.outcome, Outcome::MaxIterations);
    options.finest = 6;
    let error = multilevel::fit(&samples, &options, &mut unobserved());
    assert_eq!(
        error,
        Err(FitError::Levels {
            coarsest: 2,
            finest: 6
        })
    );
}

#[test]
fn bad_samples_are_refused() {
    let (at, z) = (vec![[0.5; 3]; 2], vec![Point3::origin(); 2]);
    let error = VolumeSamples::build(at.clone(), z[..1].to_vec());
    assert!(matches!(error, Err(FitError::Lengths { points: 1, .. })));
    let error = VolumeSamples::build(vec![[0.5; 3], [0.5, -0.1, 0.0]], z.clone());
    assert_eq!(error, Err(FitError::Parameter { sample: 1 }));
    let error = VolumeSamples::weighted(at.clone(), z.clone(), vec![1.0, -1.0]);
    assert_eq!(
        error,
        Err(FitError::Weight {
            sample: 1,
            weight: -1.0
        })
    );
    assert_eq!(
        VolumeSamples::weighted(at, z, vec![0.0; 2]),
        Err(FitError::NoSamples)
    );
    assert_eq!(
        VolumeSamples::build(vec![], vec![]),
        Err(FitError::NoSamples)
    );
}

fn least(finest: usize, smoothing: f64) -> least_squares::Options {
    least_squares::Options {
        finest,
        smoothing,
        tolerance: 1e-6,
        ..Default::default()
    }
}

#[test]
fn equations_are_sums_over_samples() {
    let samples = samples(ball, 300, 3);
    let spans = 3;
    let lattice = 216;
    let equations = least_squares::assemble(&samples, spans, [0.1, 0.2, 0.3]);
    let mut dense = vec![vec![0.0; lattice]; lattice];
    let mut right = vec![0.0; 3 * lattice];
    for (at, z) in samples.parameters().iter().zip(samples.points()) {
        let rows = at.map(|t| msplines_common::bspline::locate(spans, t));
        let basis = rows.map(|(_, x)| msplines_common::bspline::weights(x));
        let entry = |p: usize| {
            let [i, j, k] = [rows[0].0 + p % 4, rows[1].0 + p / 4 % 4, rows[2].0 + p / 16];
            let weight = basis[0][p % 4] * basis[1][p / 4 % 4] * basis[2][p / 16];
            (i + 6 * (j + 6 * k), weight)
        };
        for (a, x) in (0..64).map(entry) {
            for (b, y) in (0..64).map(entry) {
                dense[a][b] += x * y;
            }
            for (d, shift) in [0.1, 0.2, 0.3].into_iter().enumerate() {
                right[d * lattice + a] += x * (z[d] - shift);
            }
        }
    }
    for (found, expected) in equations.right.iter().zip(&right) {
        assert!((found - expected).abs() < 1e-12);
    }
    for b in 0..lattice {
        let mut unit = vec![0.0; lattice];
        unit[b] = 1.0;
        let column = equations.matrix.apply(&unit);
        for a in 0..lattice {
            assert!((column[a] - dense[a][b]).abs() < 1e-12, "{a} {b}");
        }
    }
}

#[test]
fn the_approximate_inverse_is_exact_where_one_block_holds_all() {
    let samples = samples(ball, 2000, 6);
    let mut matrix = least_squares::assemble(&samples, 2, [0.0; 3]).matrix;
    matrix.add_second_derivatives(1.0);
    let inverse = least_squares::BlockInverse::build(&matrix);
    let x: Vec<f64> = (0..250).map(|at| f64::from(at).sin()).collect();
    for (found, expected) in inverse.apply(&matrix.apply(&x)).iter().zip(&x) {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
}

#[test]
fn some_blocks_are_solved_as_among_all() {
    let samples = samples(ball, 2000, 7);
    let mut matrix = least_squares::assemble(&samples, 8, [0.0; 3]).matrix;
    matrix.add_second_derivatives(1.0);
    let inverse = least_squares::BlockInverse::build(&matrix);
    let lattice = 11_usize.pow(3);
    let x: Vec<f64> = (0..2 * lattice).map(|at| (at as f64).cos()).collect();
    let mut marked = vec![false; lattice];
    (marked[0], marked[lattice - 1]) = (true, true);
    let blocks = inverse.touching(&marked);
    assert_eq!(blocks.len(), 2);
    let places: Vec<usize> = inverse.places(&blocks).map(|at| at as usize).collect();
    let pick = |x: &[f64]| -> Vec<f64> {
        let columns = x.chunks_exact(lattice);
        columns
            .flat_map(|c| places.iter().map(|&at| c[at]))
            .collect()
    };
    assert_eq!(
        inverse.apply_within(&blocks, &pick(&x)),
        pick(&inverse.apply(&x))
    );
}

#[test]
fn second_derivatives_are_integrated_over_the_cube() {
    let mut matrix = least_squares::Stencil::zero(7);
    matrix.add_second_derivatives(0.5);
    let lattice = |f: fn(f64, f64, f64) -> f64| -> Vec<f64> {
        let [i, j, k] = [|at| at % 7, |at| at / 7 % 7, |at| at / 49];
        (0..343_usize)
            .map(|at| f(i(at) as f64, j(at) as f64, k(at) as f64))
            .collect()
    };
    let energy = |x: &[f64]| -> f64 { matrix.apply(x).iter().zip(x).map(|(a, b)| a * b).sum() };
    assert!(energy(&lattice(|i, j, k| 1.0 + i - j * k + i * j * k)).abs() < 1e-9);
    // The second derivative of a lattice of i² is 2, over 4³ spans.
    assert!((energy(&lattice(|i, _, _| i * i)) - 0.5 * 4.0 * 64.0).abs() < 1e-9);
    assert!((energy(&lattice(|_, j, k| j * j + k * k)) - 0.5 * 8.0 * 64.0).abs() < 1e-9);
}

#[test]
fn cubics_are_reproduced() {
    let cubic = |[u, v, w]: [f64; 3]| {
        Point3::new(
            u * u * u - v * w,
            1000.0 + v * v * w * w * w,
            u * v * w - 2.0 * w * w,
        )
    };
    let samples = samples(cubic, 4000, 4);
    let fit = least_squares::fit(&samples, &least(8, 1e-13), &mut unobserved()).expect("a fit");
    assert!(fit.levels[1].max < 1e-8, "{:?}", fit.levels);
}

#[test]
fn least_squares_come_closer_with_more_spans_than_multilevel() {
    let samples = samples(ball, 20_000, 5);
    let fit = least_squares::Options::default();
    let fit = least_squares::fit(&samples, &fit, &mut unobserved()).expect("a fit");
    assert_eq!(fit.outcome, Outcome::Converged);
    assert!(
        fit.levels
            .windows(2)
            .all(|pair| pair[1].rms < 0.5 * pair[0].rms)
    );
    let options = multilevel::Options {
        coarsest: 2,
        finest: 16,
        stop_rms: 0.0,
    };
    let multilevel = multilevel::fit(&samples, &options, &mut unobserved()).expect("a fit");
    assert!(fit.levels[2].rms < 0.5 * multilevel.levels[3].rms);
}

#[test]
fn samples_of_a_plane_determine_nothing() {
    let mut parameters = super::maps::parameters(500, 0.0, 6);
    for at in &mut parameters {
        at[2] = 0.5;
    }
    let points = parameters.iter().map(|&at| ball(at)).collect();
    let samples = VolumeSamples::build(parameters, points).expect("samples");
    let error = least_squares::fit(&samples, &least(4, 1e-5), &mut unobserved());
    assert_eq!(error, Err(FitError::Undetermined));
}

#[test]
fn options_out_of_range_are_refused() {
    let samples = samples(ball, 100, 7);
    let fit = |options| least_squares::fit(&samples, &options, &mut unobserved());
    assert!(matches!(
        fit(least(8, 0.0)),
        Err(FitError::Number {
            name: "smoothing",
            ..
        })
    ));
    assert!(matches!(
        fit(least(128, 1e-5)),
        Err(FitError::TooFine { spans: 128, .. })
    ));
    assert!(matches!(fit(least(12, 1e-5)), Err(FitError::Levels { .. })));
}

#[test]
fn a_ball_is_certified_with_tiny_creases() {
    let samples = samples(ball, 20_000, 8);
    let options = certified::Options {
        least_squares: least_squares::Options {
            finest: 8,
            ..Default::default()
        },
        samplings: vec![10, 15],
        ..Default::default()
    };
    let fit = certified::fit(&samples, &options, &mut unobserved()).expect("a fit");
    assert_eq!(fit.report.outcome, Outcome::Converged);
    assert!(fit.certificate.holds() && fit.certificate.bound > 0.0);
    assert_eq!(fit.report.degenerate, [0, 0]);
    assert!(fit.report.rms < 1e-3, "{:?}", fit.report);
    // No spikes: at no sample is the solid much farther than least squares leave it.
    let start = least_squares::residuals(&samples, &fit.start).1;
    assert!(fit.report.max < 1.1 * start, "{} {start}", fit.report.max);
    let [least, greatest] = [fit.report.creases.least, fit.report.creases.greatest];
    assert!(
        least > 2.9 && greatest < std::f64::consts::PI,
        "{least} {greatest}"
    );
}

#[test]
fn solids_inside_out_are_refused() {
    let mirrored = samples(|[u, v, w]| Point3::new(v, u, w), 2000, 9);
    let error = certified::fit(&mirrored, &Default::default(), &mut unobserved());
    assert!(matches!(error, Err(FitError::InsideOut { volume }) if (volume + 1.0).abs() < 1e-6));
    let options = certified::Options {
        margin: 0.0,
        ..Default::default()
    };
    let error = certified::fit(&mirrored, &options, &mut unobserved());
    assert!(matches!(
        error,
        Err(FitError::Number { name: "margin", .. })
    ));
}
