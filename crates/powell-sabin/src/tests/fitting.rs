//! Fits: interpolation, fairness, orientation, rates.

use msplines_common::evaluate::Order;
use msplines_common::mesh::SurfacePoint;
use msplines_common::progress::{Outcome, unobserved};
use msplines_common::{Point3, Vector3};

use super::{Random, TORUS, jittered_grid, points, torus, torus_point};
use crate::{
    Fairness, Fit, FitError, FlatDomain, Options, Orientation, PowellSabinSpline, VertexCondition,
    Warning, estimate_normals, fit,
};

/// Positions and exact normals of the torus.
pub(crate) fn torus_data(angles: &[[f64; 2]]) -> Vec<VertexCondition> {
    let datum = |&at: &[f64; 2]| {
        let [position, u, v] = torus_point(at);
        VertexCondition::Interpolate {
            position: Point3::from(position),
            normal: Vector3::from(u).cross(&Vector3::from(v)),
        }
    };
    angles.iter().map(datum).collect()
}

pub(crate) fn fitted(domain: &FlatDomain, data: &[VertexCondition], options: &Options) -> Fit {
    fit(domain, data, options, &mut unobserved()).expect("a fit")
}

/// Returns a point of the domain at a vertex.
fn at_vertex(domain: &FlatDomain, vertex: u32) -> SurfacePoint {
    let h = domain.topology().vertex_half_edge(vertex);
    let mut at = [0.0; 3];
    at[(h % 3) as usize] = 1.0;
    SurfacePoint { face: h / 3, at }
}

pub(crate) fn check_interpolation(spline: &PowellSabinSpline, data: &[VertexCondition]) {
    let domain = spline.flat_domain();
    let places: Vec<SurfacePoint> = (0..data.len() as u32)
        .map(|v| at_vertex(domain, v))
        .collect();
    let values = spline
        .evaluate_flat(&places, Order::Value)
        .expect("vertices")
        .values;
    let normals = spline.normals(&places).expect("vertices");
    for (vertex, datum) in data.iter().enumerate() {
        if let VertexCondition::Interpolate { position, normal } = datum {
            let found = Point3::from_slice(&values[3 * vertex..][..3]);
            assert!((found - position).norm() < 1e-14, "vertex {vertex}");
            assert!(
                (normals[vertex] - normal.normalize()).norm() < 1e-13,
                "vertex {vertex}"
            );
        }
    }
}

/// Largest distance from the torus, and largest angle between normals.
fn torus_errors(spline: &PowellSabinSpline) -> [f64; 2] {
    let places = points(spline.flat_domain(), 4, 3);
    let values = spline
        .evaluate_flat(&places, Order::Value)
        .expect("points")
        .values;
    let normals = spline.normals(&places).expect("points");
    let mut worst = [0.0_f64; 2];
    for (value, normal) in values.chunks_exact(3).zip(normals) {
        let round = value[0].hypot(value[1]);
        let offset = Vector3::new(round - TORUS[0], 0.0, value[2]);
        worst[0] = worst[0].max((offset.norm() - TORUS[1]).abs());
        let out = Vector3::new(
            value[0] / round * offset.x,
            value[1] / round * offset.x,
            value[2],
        );
        worst[1] = worst[1].max(normal.cross(&out.normalize()).norm());
    }
    worst
}

const ENERGIES: [Options; 4] = [
    Options::PAPER,
    Options {
        thin_plate: 0.0,
        ..Options::PAPER
    },
    Options {
        membrane: 0.0,
        ..Options::PAPER
    },
    Options {
        membrane: 0.1,
        thin_plate: 1.0,
        fairness: Fairness::Geometric,
        orientation: Orientation::Repair,
    },
];

#[test]
fn positions_and_normals_are_interpolated() {
    for options in ENERGIES {
        let (domain, angles) = torus(8, 0.2);
        let data = torus_data(&angles);
        let fit = fitted(&domain, &data, &options);
        check_interpolation(&fit.spline, &data);
        assert_eq!(fit.report.unknowns, 4 * data.len());
        assert!(fit.report.residual < 1e-13, "{:?}", fit.report);
        assert_eq!(
            (fit.report.violations_before, fit.report.violations_after),
            (0, 0)
        );
        assert!(fit.report.warnings.is_empty() && fit.report.outcome == Outcome::Converged);
    }
}

#[test]
fn fitted_tori_converge() {
    for options in ENERGIES {
        let errors: Vec<[f64; 2]> = [12, 24, 48]
            .iter()
            .map(|&n| {
                let (domain, angles) = torus(n, 0.1);
                torus_errors(&fitted(&domain, &torus_data(&angles), &options).spline)
            })
            .collect();
        let rates = [0, 1].map(|k| (errors[1][k] / errors[2][k]).log2());
        assert!(
            rates[0] > 2.5 && rates[1] > 1.5,
            "{options:?}: {errors:?} {rates:?}"
        );
    }
}

#[test]
fn nothing_admissible_has_less_energy() {
    let (domain, angles) = torus(6, 0.2);
    let mut data = torus_data(&angles);
    data[7] = VertexCondition::Free;
    if let VertexCondition::Interpolate { position, .. } = data[20] {
        data[20] = VertexCondition::Position { position };
    }
    let mut random = Random::new(2);
    for options in ENERGIES {
        let spline = fitted(&domain, &data, &options).spline;
        let least = spline.energy(&options);
        for _ in 0..40 {
            let vertex = (random.next() * data.len() as f64) as usize;
            let mut draw = || Vector3::from_fn(|_, _| 1e-3 * (2.0 * random.next() - 1.0));
            let (mut values, mut gradients) = (
                spline.vertex_values().to_vec(),
                spline.vertex_gradients().to_vec(),
            );
            for (kind, mut change) in [draw(), draw(), draw()].into_iter().enumerate() {
                match data[vertex] {
                    VertexCondition::Interpolate { normal, .. } => {
                        let n = normal.normalize();
                        change -= n * n.dot(&change);
                        change *= f64::from(kind > 0);
                    }
                    VertexCondition::Position { .. } => change *= f64::from(kind > 0),
                    _ => {}
                }
                let target = match kind {
                    0 => &mut values[3 * vertex..][..3],
                    _ => &mut gradients[6 * vertex + 3 * (kind - 1)..][..3],
                };
                target.iter_mut().zip(&change).for_each(|(t, c)| *t += c);
            }
            let other = PowellSabinSpline::from_parts(domain.clone(), 3, values, gradients);
            let more = other.expect("a spline").energy(&options);
            assert!(
                more > least * (1.0 + 1e-12),
                "vertex {vertex}: {more} {least}"
            );
        }
    }
}

#[test]
fn an_affine_map_has_no_plate_energy() {
    let domain = jittered_grid(6, 0.3, 5);
    let options = ENERGIES[2];
    let place = |p: &Point3<f64>| Point3::new(p.x + 2.0 * p.y, 3.0 - p.y, 0.5 * p.x);
    let given = |v: usize| v.is_multiple_of(3) || v < 7;
    let data: Vec<VertexCondition> = domain
        .mesh()
        .positions()
        .iter()
        .enumerate()
        .map(|(v, p)| {
            if given(v) {
                VertexCondition::Position { position: place(p) }
            } else {
                VertexCondition::Free
            }
        })
        .collect();
    let spline = fitted(&domain, &data, &options).spline;
    for (vertex, p) in domain.mesh().positions().iter().enumerate() {
        let found = Point3::from_slice(&spline.vertex_values()[3 * vertex..][..3]);
        assert!((found - place(p)).norm() < 1e-11, "vertex {vertex}");
        let gradient = &spline.vertex_gradients()[6 * vertex..][..6];
        for (found, due) in gradient.iter().zip([1.0, 0.0, 0.5, 2.0, -1.0, 0.0]) {
            assert!((found - due).abs() < 1e-10, "vertex {vertex}: {gradient:?}");
        }
    }
}

#[test]
fn fixed_vertices_stay_to_the_last_bit() {
    let (domain, angles) = torus(6, 0.2);
    let mut data = torus_data(&angles);
    let gradient = [Vector3::new(0.3, 0.1, 0.2), Vector3::new(-0.2, 0.5, 0.1)];
    for vertex in [3, 4, 10] {
        let position = Point3::from(torus_point(angles[vertex])[0]);
        data[vertex] = VertexCondition::Fixed { position, gradient };
    }
    let fit = fitted(&domain, &data, &Options::default());
    assert_eq!(fit.report.unknowns, 4 * (data.len() - 3));
    for vertex in [3, 4, 10] {
        let found = &fit.spline.vertex_gradients()[6 * vertex..][..6];
        assert_eq!(
            found,
            [gradient[0].as_slice(), gradient[1].as_slice()].concat()
        );
    }
    let all: Vec<VertexCondition> = angles
        .iter()
        .map(|&at| VertexCondition::Fixed {
            position: Point3::from(torus_point(at)[0]),
            gradient,
        })
        .collect();
    assert_eq!(
        fitted(&domain, &all, &Options::default()).report.unknowns,
        0
    );
}

#[test]
fn opposed_normals_are_named_and_orientations_repaired() {
    let (domain, angles) = torus(8, 0.2);
    let mut data = torus_data(&angles);
    for vertex in [0, 37, 38, 39, 100] {
        if let VertexCondition::Interpolate { normal, .. } = &mut data[vertex] {
            *normal *= -1.0;
        }
    }
    let counted = Options {
        orientation: Orientation::Count,
        ..Options::default()
    };
    let before = fitted(&domain, &data, &counted).report;
    assert!(before.violations_before > 0 && before.violations_after == before.violations_before);
    assert!(
        before
            .warnings
            .iter()
            .any(|w| matches!(w, Warning::InsideOut { .. }))
    );
    let fit = fitted(&domain, &data, &Options::default());
    let report = &fit.report;
    assert_eq!(
        (report.violations_before, report.violations_after),
        (before.violations_before, 0)
    );
    let opposed = Warning::OpposedNormals {
        vertices: vec![0, 37, 38, 39, 100],
    };
    assert_eq!(report.warnings, std::slice::from_ref(&opposed));
    assert!(
        opposed
            .to_string()
            .contains("vertices [0, 37, 38, 39, 100]")
    );
    assert_eq!(report.outcome, Outcome::Converged);
    check_interpolation(&fit.spline, &data);
}

#[test]
fn orientations_are_repaired_on_thin_faces_with_noisy_normals() {
    let mut random = Random::new(4);
    let plane: Vec<[f64; 2]> = (0..400).map(|_| [random.next(), random.next()]).collect();
    let domain = FlatDomain::planar(&plane).expect("a domain");
    let data: Vec<VertexCondition> = plane
        .iter()
        .map(|&[x, y]| VertexCondition::Interpolate {
            position: Point3::new(x, y, 0.1 * (4.0 * x).sin() * (3.0 * y).cos()),
            normal: Vector3::z() + Vector3::from_fn(|_, _| 1.2 * random.next() - 0.6),
        })
        .collect();
    let fit = fitted(&domain, &data, &Options::default());
    let report = &fit.report;
    assert!(report.violations_before > 0, "{report:?}");
    assert_eq!(
        (report.violations_after, report.outcome),
        (0, Outcome::Converged)
    );
    check_interpolation(&fit.spline, &data);
}

#[test]
fn units_and_places_do_not_change_the_surface() {
    let (domain, angles) = torus(6, 0.2);
    let data = torus_data(&angles);
    let options = ENERGIES[3];
    let spline = fitted(&domain, &data, &options).spline;
    let vectors = domain
        .edge_vectors()
        .iter()
        .map(|e| e.map(|c| 1e3 * c))
        .collect();
    let scaled = FlatDomain::build(domain.mesh().clone(), vectors).expect("a domain");
    let moved: Vec<VertexCondition> = data
        .iter()
        .map(|datum| match *datum {
            VertexCondition::Interpolate { position, normal } => VertexCondition::Interpolate {
                position: Point3::from(1e-2 * position.coords.add_scalar(10.0)),
                normal: 7.0 * normal,
            },
            other => other,
        })
        .collect();
    let other = fitted(&scaled, &moved, &options).spline;
    let places = points(&domain, 2, 6);
    let [one, two] =
        [&spline, &other].map(|s| s.evaluate_flat(&places, Order::First).expect("points"));
    for (a, b) in one.values.iter().zip(&two.values) {
        assert!((1e-2 * (a + 10.0) - b).abs() < 1e-12);
    }
    for (a, b) in one.first.iter().zip(&two.first) {
        assert!((1e-5 * a - b).abs() < 1e-14);
    }
}

#[test]
fn bits_do_not_depend_on_threads() {
    let (domain, angles) = torus(24, 0.2);
    let mut data = torus_data(&angles);
    if let VertexCondition::Interpolate { normal, .. } = &mut data[50] {
        *normal *= -1.0;
    }
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool");
        pool.install(|| fitted(&domain, &data, &Options::default()).spline)
    };
    let (one, three) = (run(1), run(3));
    assert_eq!(one.vertex_gradients(), three.vertex_gradients());
    assert_eq!(one.vertex_values(), three.vertex_values());
}

#[test]
fn tasks_that_are_none_are_refused() {
    let (domain, angles) = torus(4, 0.0);
    let data = torus_data(&angles);
    let run = |data: &[VertexCondition], options: &Options| {
        fit(&domain, data, options, &mut unobserved()).expect_err("no fit")
    };
    let options = Options::default();
    let found = run(&data[1..], &options);
    assert_eq!(
        found,
        FitError::DataCount {
            found: data.len() - 1,
            vertices: data.len()
        }
    );
    let bad = |vertex: usize, datum: VertexCondition| {
        let mut data = data.clone();
        data[vertex] = datum;
        run(&data, &options)
    };
    let position = Point3::new(0.0, f64::NAN, 0.0);
    assert_eq!(
        bad(5, VertexCondition::Position { position }),
        FitError::NotFinite { vertex: 5 }
    );
    let position = Point3::origin();
    for normal in [
        Vector3::zeros(),
        Vector3::new(0.0, f64::INFINITY, 0.0),
        Vector3::new(f64::NAN, 1.0, 0.0),
    ] {
        let found = bad(3, VertexCondition::Interpolate { position, normal });
        assert_eq!(found, FitError::Normal { vertex: 3 });
        assert!(found.to_string().contains("vertex 3"));
    }
}

#[test]
fn energies_that_say_nothing_are_refused() {
    let (domain, angles) = torus(4, 0.0);
    let data = torus_data(&angles);
    let run = |data: &[VertexCondition], options: &Options| {
        fit(&domain, data, options, &mut unobserved()).expect_err("no fit")
    };
    let (options, position) = (Options::default(), Point3::origin());
    let free = vec![VertexCondition::Free; data.len()];
    assert_eq!(
        run(&free, &options),
        FitError::ComponentWithoutPosition { vertex: 0 }
    );
    for membrane in [-1.0, f64::NAN] {
        let found = run(
            &data,
            &Options {
                membrane,
                ..options
            },
        );
        assert!(matches!(found, FitError::Weights { .. }));
    }
    let none = Options {
        membrane: 0.0,
        thin_plate: 0.0,
        ..options
    };
    assert!(matches!(run(&data, &none), FitError::Weights { .. }));
    // One position holds no thin plate in the plane.
    let domain = jittered_grid(3, 0.2, 1);
    let mut loose = vec![VertexCondition::Free; 16];
    loose[4] = VertexCondition::Position { position };
    let found = fit(&domain, &loose, &ENERGIES[2], &mut unobserved());
    let singular = match &found {
        Err(FitError::Factor { .. }) => true,
        Ok(fit) => fit
            .report
            .warnings
            .iter()
            .any(|w| matches!(w, Warning::NearlySingular { .. })),
        _ => false,
    };
    assert!(singular, "{found:?}");
}

#[test]
fn a_break_leaves_orientations_alone() {
    let (domain, angles) = torus(6, 0.0);
    let mut data = torus_data(&angles);
    if let VertexCondition::Interpolate { normal, .. } = &mut data[9] {
        *normal *= -1.0;
    }
    let mut stop = |_: &msplines_common::progress::Progress| std::ops::ControlFlow::Break(());
    let fit = fit(&domain, &data, &Options::default(), &mut stop).expect("a fit");
    assert_eq!(fit.report.outcome, Outcome::Stopped);
    assert!(fit.report.violations_after > 0);
}

#[test]
fn estimated_normals_will_do() {
    let (domain, _) = torus(16, 0.1);
    let normals = estimate_normals(domain.mesh()).expect("normals");
    let data = VertexCondition::of_mesh(domain.mesh(), &normals);
    let fit = fitted(&domain, &data, &Options::default());
    check_interpolation(&fit.spline, &data);
    // Cells are a tenth of the torus wide, estimated normals a few degrees off.
    assert!(
        torus_errors(&fit.spline)[0] < 5e-3,
        "{:?}",
        torus_errors(&fit.spline)
    );
}
