//! Fits: what they recover, where they stop, what they refuse.

use std::ops::ControlFlow;
use std::sync::Arc;

use msplines_common::Point3;
use msplines_common::evaluate::{Order, Samples, SurfaceSpline};
use msplines_common::mesh::{SurfacePoint, shapes};
use msplines_common::progress::unobserved;

use super::*;
use crate::complex::{Point, UNITS};
use crate::domain::{Domain, DomainOptions};
use crate::surface::TSplineSurface;

fn torus() -> Arc<CylinderComplex> {
    let unit = UNITS as i64;
    let torus = CylinderComplex::torus(2 * unit, unit, unit / 3);
    Arc::new(torus.expect("a torus"))
}

/// Even points of the torus, and where a function places them.
fn samples(n: usize, place: impl Fn(f64, f64) -> [f64; 3]) -> Vec<Sample> {
    let indices = (0..2 * n).flat_map(|i| (0..n).map(move |j| [i, j]));
    indices
        .map(|ij| {
            let [x, y] = ij.map(|k| (k as f64 + 0.37) / n as f64);
            let at = Point {
                cylinder: 0,
                x: x * UNITS,
                y: y * UNITS,
            };
            Sample::vertex(at, Point3::from(place(x, y)))
        })
        .collect()
}

/// A tube bent to a ring whose twist the complex has: once around `y`, `x` goes on by a third.
fn tube(x: f64, y: f64) -> [f64; 3] {
    let (a, b) = (
        std::f64::consts::TAU * y,
        std::f64::consts::PI * (x - y / 3.0),
    );
    let r = 2.0 + (0.7 + 0.1 * (3.0 * a).cos()) * b.cos();
    [r * a.cos(), r * a.sin(), 0.7 * b.sin()]
}

fn budget(most: usize) -> FitOptions {
    FitOptions {
        stop: Stop::ControlPoints(most),
        ..FitOptions::default()
    }
}

fn fitted(samples: &[Sample], options: &FitOptions) -> Fit {
    fit(&torus(), samples, options, &mut unobserved()).expect("a fit")
}

#[test]
fn a_spline_of_the_space_is_recovered() {
    let mut options = budget(60);
    options.refinement.start = 40;
    options.correction = Correction::Off;
    let given = fitted(&samples(24, tube), &options).levels[0]
        .spline
        .clone();
    let mut points = samples(24, tube);
    let places: Vec<Point> = points.iter().map(|s| s.at).collect();
    let values = given.evaluate(&places, Order::Value).positions;
    points
        .iter_mut()
        .zip(values)
        .for_each(|(s, p)| s.position = p);
    options.fairness = 0.0;
    let found = fitted(&points, &options);
    let first = &found.levels[0];
    assert!(first.errors.max < 1e-9, "{:?}", first.errors);
    for (a, b) in given.control().iter().zip(first.spline.control()) {
        assert!((a - b).norm() < 1e-7, "{a} {b}");
    }
}

#[test]
fn budgets_are_used_up_and_never_exceeded() {
    let points = samples(40, tube);
    for most in [120, 200, 333] {
        let found = fitted(&points, &budget(most));
        let used = found.report.unknowns;
        assert!(
            used <= most && used as f64 > 0.95 * most as f64,
            "{used} of {most}"
        );
        assert_eq!(found.report.outcome, Outcome::Converged);
        assert_eq!(found.spline.control().len(), used);
        let counts = found.levels.windows(2);
        let mut counts = counts.map(|l| {
            l.iter()
                .map(|l| l.spline.control().len())
                .collect::<Vec<_>>()
        });
        // A split between two T-junctions adds no corner.
        assert!(counts.all(|l| l[0] <= l[1]));
    }
}

#[test]
fn conjugate_gradients_find_what_a_factorisation_does() {
    let points = samples(30, tube);
    let mut options = budget(200);
    options.correction = Correction::Off;
    let due = fitted(&points, &options);
    options.solver = Solver::ConjugateGradients {
        tolerance: 1e-12,
        steps: 5000,
    };
    let found = fitted(&points, &options);
    assert_eq!(due.report.unknowns, found.report.unknowns);
    for (a, b) in due.spline.control().iter().zip(found.spline.control()) {
        assert!((a - b).norm() < 1e-8, "{a} {b}");
    }
    options.solver = Solver::ConjugateGradients {
        tolerance: 1e-12,
        steps: 3,
    };
    let refused = fit(&torus(), &points, &options, &mut unobserved()).expect_err("too few steps");
    assert!(refused.to_string().contains("after 3 steps"), "{refused}");
}

#[test]
fn tolerances_are_met() {
    let points = samples(40, tube);
    let options = FitOptions {
        stop: Stop::Tolerance(2e-3),
        ..FitOptions::default()
    };
    let found = fitted(&points, &options);
    assert_eq!(found.report.outcome, Outcome::Converged);
    assert!(found.report.errors.max <= 2e-3);
    assert!(
        found
            .levels
            .iter()
            .rev()
            .skip(1)
            .all(|l| l.errors.max > 2e-3)
    );
}

#[test]
fn moved_samples_are_nearer_and_say_how_far_they_moved() {
    let points = samples(40, tube);
    let mut options = budget(150);
    let moved = fitted(&points, &options);
    options.correction = Correction::Off;
    let kept = fitted(&points, &options);
    assert!(moved.report.errors.rms < kept.report.errors.rms);
    assert!(kept.samples.iter().all(|s| s.shift == [0.0; 2]));
    let complex = torus();
    for (before, after) in points.iter().zip(&moved.samples) {
        let (there, _) = complex.walk(before.at, after.shift);
        let miss = (there.x - after.at.x).hypot(there.y - after.at.y);
        // One unit is 6e-14 of the form's 1.
        assert!(!(1.0..=1.9 * UNITS).contains(&miss), "{miss}");
        assert!((before.position - after.position).norm() < 1e-12);
    }
}

#[test]
fn bits_do_not_depend_on_threads() {
    let points = samples(30, tube);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads")
            .install(|| fitted(&points, &budget(180)))
    };
    let (one, three) = (on(1), on(3));
    assert_eq!(one.spline.control(), three.spline.control());
    assert_eq!(one.samples, three.samples);
}

#[test]
fn tasks_that_are_none_are_refused() {
    let points = samples(20, tube);
    let run = |points: &[Sample], options: &FitOptions| {
        fit(&torus(), points, options, &mut unobserved()).expect_err("no task")
    };
    assert_eq!(run(&[], &budget(100)), FitError::NoSamples);
    let mut broken = points.clone();
    broken[7].position.y = f64::NAN;
    assert_eq!(
        run(&broken, &budget(100)),
        FitError::NotFinite { sample: 7 }
    );
    let mut elsewhere = points.clone();
    elsewhere[9].at.cylinder = 1;
    assert_eq!(
        run(&elsewhere, &budget(100)),
        FitError::NoCylinder {
            sample: 9,
            cylinder: 1,
            cylinders: 1
        }
    );
    let FitError::Budget { given: 5, least } = run(&points, &budget(5)) else {
        panic!("a budget");
    };
    let endless = run(&points, &budget(usize::MAX));
    assert!(matches!(endless, FitError::LargeBudget { .. }), "{endless}");
    assert_eq!(fitted(&points, &budget(least)).report.unknowns, least);
    for length in [0.0, -1.0, f64::NAN] {
        let options = FitOptions {
            stop: Stop::Tolerance(length),
            ..FitOptions::default()
        };
        assert!(matches!(run(&points, &options), FitError::Tolerance { .. }));
    }
    let mut options = budget(100);
    options.refinement.share = 0.0;
    assert!(
        run(&points, &options)
            .to_string()
            .contains("share must be in (0, 1]")
    );
}

#[test]
fn a_break_leaves_the_surface_that_was_reached() {
    let points = samples(30, tube);
    let mut rounds = 0;
    let mut observer = |_: &Progress| {
        rounds += 1;
        if rounds == 3 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let found = fit(&torus(), &points, &budget(400), &mut observer).expect("a fit");
    assert_eq!(found.report.outcome, Outcome::Stopped);
    assert_eq!(found.levels.len(), 3);
    assert_eq!(found.levels[2].spline, found.spline);
}

/// Values of a surface at points of its mesh.
fn values(surface: &TSplineSurface, points: &[SurfacePoint], order: Order) -> Samples {
    let mut out = Samples::default();
    let prepared = surface.prepare(points, order).expect("points");
    prepared.evaluate(&mut out);
    out
}

/// How far two points of a surface are apart.
fn gap(surface: &TSplineSurface, points: [SurfacePoint; 2]) -> f64 {
    let both = values(surface, &points, Order::Value).values;
    let apart = (0..3).map(|c| (both[c] - both[3 + c]).abs());
    apart.fold(0.0, f64::max)
}

/// How far the derivative along the first axis of a face is from a difference.
fn slope_miss(surface: &TSplineSurface, face: u32) -> f64 {
    let mesh = surface.domain().mesh();
    let at = [0.4, 0.35, 0.25];
    let here = values(surface, &[SurfacePoint { face, at }], Order::First);
    let [along, _] = mesh.face_frame(face);
    let [p, q, r] = mesh.triangle(face);
    let normal = (q - p).cross(&(r - p));
    let by = |e: Vector3<f64>| e.cross(&along).dot(&normal) / normal.norm_squared();
    let (b, c) = (-by(r - p), by(q - p));
    let step = 1e-6;
    let moved = |s: f64| SurfacePoint {
        face,
        at: [at[0] - s * (b + c), at[1] + s * b, at[2] + s * c],
    };
    let pair = values(surface, &[moved(step), moved(-step)], Order::Value).values;
    let miss = (0..3).map(|k| ((pair[k] - pair[3 + k]) / (2.0 * step) - here.first[k]).abs());
    miss.fold(0.0, f64::max)
}

#[test]
fn surfaces_over_meshes_are_the_fit_at_vertices_and_continuous_between() {
    for (mesh, most) in [
        (shapes::torus(1.0, 0.4, 1500), 150),
        (shapes::genus(2, 2500), 500),
    ] {
        let domain = Domain::of_surface(&mesh, &DomainOptions::default(), &mut unobserved());
        let domain = domain.expect("a domain");
        let (options, sampling) = (budget(most), Sampling::default());
        let samples = sampling.samples(&domain, &mesh, options.stop);
        let complex = Arc::new(domain.complex().clone());
        let found = fit(
            &complex,
            &samples.expect("samples"),
            &options,
            &mut unobserved(),
        );
        let found = found.expect("a fit");
        let whole = TSplineSurface::fit(domain, &mesh, &sampling, &options, &mut unobserved());
        let surface = whole.expect("a surface").surface;
        assert_eq!(*surface.spline(), found.spline);
        let mesh = surface.domain().mesh();
        for face in 0..mesh.face_count() as u32 {
            let at = [1.0, 0.0, 0.0];
            let has = values(&surface, &[SurfacePoint { face, at }], Order::Value);
            let vertex = mesh.faces()[face as usize][0] as usize;
            let place = found.samples[vertex].at;
            let due = found.spline.evaluate(&[place], Order::Value).positions[0];
            assert!((Point3::from_slice(&has.values) - due).norm() < 1e-12);
            let twin = mesh.topology().twin(3 * face);
            let far = (twin % 3 + 2) % 3;
            let beyond = [0, 1, 2].map(|i| if i == far { 0.0 } else { 0.5 });
            let sides = [(face, [0.5, 0.5, 0.0]), (twin / 3, beyond)];
            let apart = gap(&surface, sides.map(|(face, at)| SurfacePoint { face, at }));
            assert!(apart < 1e-9, "face {face}: {apart:e}");
            let miss = slope_miss(&surface, face);
            assert!(miss < 1e-4, "face {face}: {miss:e}");
        }
    }
}
