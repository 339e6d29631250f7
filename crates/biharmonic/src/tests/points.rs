//! Knots and evaluation anywhere on the surface, derivatives against closed forms and differences.

use std::sync::Arc;

use msplines_common::evaluate::{Order, Samples, SurfaceSpline, VertexData};
use msplines_common::linalg::Mat;
use msplines_common::mesh::{SurfacePoint, TriangleMesh, shapes, zoo};
use msplines_common::progress::unobserved;

use super::{fit_positions, positions, space, spread_knots};
use crate::{
    BiharmonicSpline, Creases, FitError, KnotChoice, Laplacian, Options, Space, fit, fit_in,
    interpolate,
};

fn inside(faces: usize) -> Vec<SurfacePoint> {
    let places = [[0.2, 0.3, 0.5], [0.6, 0.3, 0.1], [0.05, 0.9, 0.05]];
    (0..30)
        .map(|i| SurfacePoint {
            face: ((i * 97 + 5) % faces) as u32,
            at: places[i % 3],
        })
        .collect()
}

fn fitted(mesh: &TriangleMesh, knots: KnotChoice) -> BiharmonicSpline {
    let options = Options {
        knots,
        ..Options::default()
    };
    fit_positions(mesh, &options).spline
}

fn samples(spline: &BiharmonicSpline, points: &[SurfacePoint], order: Order) -> Samples {
    let mut samples = Samples::default();
    spline
        .prepare(points, order)
        .unwrap()
        .evaluate(&mut samples);
    samples
}

#[test]
fn knots_may_lie_inside_faces_and_several_in_one() {
    let mesh = zoo::closed();
    let mut points = inside(mesh.face_count());
    let face = points[0].face;
    points.push(SurfacePoint {
        face,
        at: [0.7, 0.1, 0.2],
    });
    points.push(SurfacePoint {
        face,
        at: [1.0, 0.0, 0.0],
    });
    points.push(SurfacePoint {
        face,
        at: [0.5, 0.5, 0.0],
    });
    let spline = fitted(&mesh, KnotChoice::At(points.clone()));
    assert_eq!(spline.knots().len(), points.len());
    let found = spline.vertex_values().unwrap();
    assert_eq!(found.len(), 3 * mesh.vertex_count());
    // As good as as many knots at vertices, and the same as the fit of their nearest vertices but
    // for the way that the knots moved.
    let error = |f: &[f64]| {
        let squares = f
            .iter()
            .zip(&positions(&mesh))
            .map(|(a, b)| (a - b).powi(2))
            .sum::<f64>();
        (squares / mesh.vertex_count() as f64).sqrt()
    };
    let spread = spread_knots(mesh.vertex_count(), points.len());
    let others = fitted(&mesh, KnotChoice::Given(spread))
        .vertex_values()
        .unwrap();
    assert!(error(&found) < 2.0 * error(&others));
}

#[test]
fn knots_at_vertices_given_as_points_are_the_same_knots() {
    let mesh = zoo::with_boundary();
    let knots = spread_knots(mesh.vertex_count(), 30);
    let point = |&knot: &u32| {
        let half_edge = mesh.topology().vertex_half_edge(knot);
        let mut at = [0.0; 3];
        at[half_edge as usize % 3] = 1.0;
        SurfacePoint {
            face: half_edge / 3,
            at,
        }
    };
    let at = fitted(&mesh, KnotChoice::At(knots.iter().map(point).collect()));
    let given = fitted(&mesh, KnotChoice::Given(knots));
    assert_eq!(at.knots(), given.knots());
    assert_eq!(at.vertex_values().unwrap(), given.vertex_values().unwrap());
}

/// Points of a space carry no data, so they cannot all be knots of a fit.
#[test]
fn more_knots_than_data_are_refused() {
    let mesh = zoo::closed();
    let values = positions(&mesh);
    let data = VertexData {
        dimension: 3,
        values: &values,
    };
    let points = inside(mesh.face_count());
    let none = Creases::none();
    let domain = Arc::new(mesh.clone());
    let (space, _) = Space::with_points(domain, &points, Laplacian::Cotangent, &none).unwrap();
    let options = Options {
        knots: KnotChoice::All,
        ..Options::default()
    };
    let error = fit_in(&Arc::new(space), data, &options, &mut unobserved()).unwrap_err();
    let (weighted, knots) = (mesh.vertex_count(), mesh.vertex_count() + points.len());
    assert_eq!(error, FitError::TooFewWeights { weighted, knots });
}

#[test]
fn knots_that_coincide_or_lie_nowhere_are_refused() {
    let mesh = zoo::closed();
    let values = positions(&mesh);
    let data = VertexData {
        dimension: 3,
        values: &values,
    };
    let run = |points: Vec<SurfacePoint>| {
        let options = Options {
            knots: KnotChoice::At(points),
            ..Options::default()
        };
        let direct = fit(&mesh, data, &options, &mut unobserved()).unwrap_err();
        let shared = fit_in(&Arc::new(space(&mesh)), data, &options, &mut unobserved());
        (direct, shared.unwrap_err())
    };
    let point = SurfacePoint {
        face: 7,
        at: [0.2, 0.3, 0.5],
    };
    let (same, shared) = run(vec![point, SurfacePoint { face: 8, ..point }, point]);
    assert_eq!(
        same,
        FitError::CoincidentKnots {
            first: 0,
            second: 2
        }
    );
    assert_eq!(shared, FitError::PointsOutsideSpace);
    let (outside, _) = run(vec![SurfacePoint {
        face: 99_999,
        ..point
    }]);
    assert!(outside.to_string().contains("face 99999"), "{outside}");
}

/// Splitting faces moves nothing: with the same knots the two spaces nearly agree.
#[test]
fn points_of_a_split_surface_are_found_again() {
    let mesh = shapes::bumpy_sphere(1500);
    let spline = fitted(&mesh, KnotChoice::At(inside(mesh.face_count())));
    let points = inside(mesh.face_count());
    let at_knots = samples(&spline, &points, Order::Value);
    let vertices = spline.space().mesh().vertex_count();
    assert_eq!(vertices, mesh.vertex_count() + 30);
    let (_, all) = spline
        .subdivision_values(0, crate::Extension::AreaWeighted)
        .unwrap();
    for (i, value) in at_knots.values.chunks(3).enumerate() {
        let expected = &all[3 * (mesh.vertex_count() + i)..][..3];
        for c in 0..3 {
            assert!((value[c] - expected[c]).abs() < 1e-12);
        }
    }
}

#[test]
fn gradients_are_differences_of_values() {
    const STEP: f64 = 1e-5;
    const TOLERANCE: f64 = 1e-8; // of a quadratic: rounding over the step
    let mesh = shapes::bumpy_sphere(1500);
    let spline = fitted(
        &mesh,
        KnotChoice::Given(spread_knots(mesh.vertex_count(), 60)),
    );
    let points = inside(mesh.face_count());
    let found = samples(&spline, &points, Order::First);
    for axis in 0..2 {
        let moved = |sign: f64| -> Vec<SurfacePoint> {
            let shift = |point: &SurfacePoint| {
                let [a, b, c] = mesh.triangle(point.face);
                let step = mesh.face_frame(point.face)[axis] * (sign * STEP);
                let sides = nalgebra::Matrix3x2::from_columns(&[b - a, c - a]);
                let inverse = (sides.transpose() * sides).try_inverse().unwrap();
                let change = inverse * sides.transpose() * step;
                let at = point.at;
                SurfacePoint {
                    face: point.face,
                    at: [
                        at[0] - change.x - change.y,
                        at[1] + change.x,
                        at[2] + change.y,
                    ],
                }
            };
            points.iter().map(shift).collect()
        };
        let (plus, minus) = (
            samples(&spline, &moved(1.0), Order::Value),
            samples(&spline, &moved(-1.0), Order::Value),
        );
        for point in 0..points.len() {
            for c in 0..3 {
                let i = 3 * point + c;
                let difference = (plus.values[i] - minus.values[i]) / (2.0 * STEP);
                let gradient = found.first[(2 * point + axis) * 3 + c];
                assert!(
                    (difference - gradient).abs() < TOLERANCE,
                    "{difference} {gradient}"
                );
            }
        }
    }
}

/// The second spherical harmonic `z² - 1/3`, whose Laplacian is -6 times itself.
fn harmonic(mesh: &TriangleMesh) -> Vec<f64> {
    mesh.positions()
        .iter()
        .map(|p| p.z * p.z - 1.0 / 3.0)
        .collect()
}

/// Returns the root mean squares of the errors of value, gradient and Laplacian.
fn harmonic_errors(vertices: usize) -> [f64; 3] {
    let mesh = shapes::sphere(vertices);
    let values = harmonic(&mesh);
    let data = VertexData {
        dimension: 1,
        values: &values,
    };
    let spline = interpolate(&mesh, data, Laplacian::Cotangent).unwrap();
    let points: Vec<SurfacePoint> = (0..mesh.face_count() as u32)
        .map(|face| SurfacePoint {
            face,
            at: [0.25, 0.35, 0.4],
        })
        .collect();
    let found = samples(&spline, &points, Order::First);
    let laplacian = spline.laplacian_at(&points).unwrap();
    let mut errors = [0.0; 3];
    for (i, &point) in points.iter().enumerate() {
        let p = mesh.position(point).coords.normalize();
        let exact = p.z * p.z - 1.0 / 3.0;
        let gradient = 2.0 * p.z * (nalgebra::Vector3::z() - p * p.z);
        let frame = mesh.face_frame(point.face);
        errors[0] += (found.values[i] - exact).powi(2);
        errors[1] += (0..2)
            .map(|axis| (found.first[2 * i + axis] - gradient.dot(&frame[axis])).powi(2))
            .sum::<f64>();
        errors[2] += (laplacian[i] + 6.0 * exact).powi(2);
    }
    errors.map(|sum| (sum / points.len() as f64).sqrt())
}

#[test]
fn values_and_derivatives_on_the_sphere_converge() {
    let (coarse, fine) = (harmonic_errors(1000), harmonic_errors(4000));
    let rates = [0, 1, 2].map(|i| (coarse[i] / fine[i]).log2());
    // Twice as fine: h² for values, h for what is differentiated on a flat triangle.
    assert!(
        rates[0] > 1.8 && rates[1] > 0.9 && rates[2] > 0.9,
        "{rates:?} {fine:?}"
    );
}

/// The dilogarithm by its series and its reflection.
fn dilogarithm(x: f64) -> f64 {
    let series = |x: f64| (1..200).map(|k| x.powi(k) / f64::from(k * k)).sum::<f64>();
    if x <= 0.5 {
        series(x)
    } else if x < 1.0 {
        std::f64::consts::PI.powi(2) / 6.0 - x.ln() * (1.0 - x).ln() - series(1.0 - x)
    } else {
        std::f64::consts::PI.powi(2) / 6.0
    }
}

/// On the unit sphere `Δ²G = δ - 1/4π` has the solution `4πG = Li₂((1 + cos θ) / 2) + 1 - π²/6`.
#[test]
fn green_functions_on_the_sphere_converge_to_the_closed_form() {
    let error = |vertices: usize| {
        let mesh = shapes::sphere(vertices);
        let knot = mesh.positions()[0];
        let n = mesh.vertex_count();
        let delta = Mat::from_fn(n, 1, |v, _| f64::from(u8::from(v == 0)));
        let green = space(&mesh).poisson().unwrap().solve_biharmonic(delta);
        let exact: Vec<f64> = mesh
            .positions()
            .iter()
            .map(|p| {
                dilogarithm(0.5 * (1.0 + p.coords.dot(&knot.coords))) / (4.0 * std::f64::consts::PI)
            })
            .collect();
        let mean = exact.iter().sum::<f64>() / n as f64;
        let worst = (0..n).map(|v| (green[(v, 0)] - (exact[v] - mean)).abs());
        worst.fold(0.0, f64::max)
    };
    let (coarse, fine) = (error(1000), error(4000));
    assert!(fine < 1e-3, "{fine}");
    assert!((coarse / fine).log2() > 1.5, "{coarse} {fine}");
}
