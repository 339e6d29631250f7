//! Evaluation against slower routes.

use msplines_common::evaluate::{EvaluateError, Order, Samples, SurfaceSpline, VertexData};
use msplines_common::linalg::{Cholesky, Mat, Ordering, Symbolic, SymmetricMatrix};
use msplines_common::mesh::{SurfacePoint, zoo};
use msplines_common::progress::unobserved;

use super::{largest, positions, space, spread_knots};
use crate::subdivision::extend;
use crate::{BiharmonicSpline, Extension, Form, KnotChoice, Options, PartsError, Scheme, fit};

fn small_spline() -> BiharmonicSpline {
    let mesh = zoo::closed();
    let values = positions(&mesh);
    let options = Options {
        knots: KnotChoice::Given(spread_knots(mesh.vertex_count(), 24)),
        ..Options::default()
    };
    let data = VertexData {
        dimension: 3,
        values: &values,
    };
    fit(&mesh, data, &options, &mut unobserved())
        .unwrap()
        .spline
}

fn implicit(spline: &BiharmonicSpline) -> (Vec<f64>, Vec<f64>) {
    match spline.form() {
        Form::Implicit {
            coefficients,
            constant,
        } => (coefficients.clone(), constant.clone()),
        Form::KnotValues(_) => panic!("a smooth spline"),
    }
}

/// Returns `b - L x` with products and sums in twice the working precision.
fn exact_residual(laplacian: &SymmetricMatrix, x: &[f64], b: &[f64]) -> Vec<f64> {
    (0..b.len())
        .map(|row| {
            let (mut sum, mut lost) = (b[row], 0.0);
            for (other, entry) in laplacian.column(row) {
                let product = -entry * x[other];
                let error = (-entry).mul_add(x[other], -product);
                let next = sum + product;
                let part = next - sum;
                lost += (sum - (next - part)) + (product - part) + error;
                sum = next;
            }
            sum + lost
        })
        .collect()
}

/// Solves `L x = b` to working precision by refinement with exact residuals.
fn refined(laplacian: &SymmetricMatrix, b: &[f64]) -> Vec<f64> {
    let ordering = Ordering::natural(b.len());
    let symbolic = Symbolic::analyze_kept(laplacian, &ordering, |row| row != 0);
    let factor = Cholesky::factor(symbolic, laplacian).unwrap();
    let mut x = vec![0.0; b.len()];
    for _ in 0..6 {
        let residual = exact_residual(laplacian, &x, b);
        let mut correction =
            Mat::from_fn(b.len(), 1, |v, _| if v == 0 { 0.0 } else { residual[v] });
        factor.solve_in_place(correction.as_mut());
        (0..b.len()).for_each(|v| x[v] += correction[(v, 0)]);
    }
    x
}

#[test]
fn two_solves_give_green_functions_to_eleven_digits() {
    const TOLERANCE: f64 = 1e-11;
    for mesh in [zoo::closed(), zoo::with_boundary(), zoo::genus(2)] {
        let space = space(&mesh);
        let n = mesh.vertex_count();
        let operators = space.operators();
        let total: f64 = operators.mass.iter().sum();
        for knot in [0, n / 3, n - 1] {
            let green = space
                .poisson()
                .unwrap()
                .solve_biharmonic(Mat::from_fn(n, 1, |v, _| f64::from(u8::from(v == knot))));
            let delta: Vec<f64> = (0..n)
                .map(|v| f64::from(u8::from(v == knot)) - 1.0 / n as f64)
                .collect();
            let mut flux = refined(&operators.laplacian, &delta);
            let weighted: f64 = flux.iter().zip(&operators.mass).map(|(y, a)| y * a).sum();
            flux.iter_mut()
                .zip(&operators.mass)
                .for_each(|(y, a)| *y = a * (*y - weighted / total));
            let x = refined(&operators.laplacian, &flux);
            let mean = x.iter().sum::<f64>() / n as f64;
            let difference = Mat::from_fn(n, 1, |v, _| green[(v, 0)] - (x[v] - mean));
            assert!(largest(&difference) < TOLERANCE * largest(&green));
        }
    }
}

/// The loop over knots of [Hou2017] Alg. 1, lines 8-13.
#[test]
fn one_subdivision_solve_equals_the_loop_over_knots() {
    const TOLERANCE: f64 = 1e-10;
    let spline = small_spline();
    let (coefficients, constant) = implicit(&spline);
    let space = spline.space();
    let n = space.mesh().vertex_count();
    for extension in [Extension::Literal, Extension::AreaWeighted] {
        let (fine, values) = spline.subdivision_values(1, extension).unwrap();
        let mut sum: Mat<f64> = Mat::zeros(fine.vertex_count(), 3);
        for (k, &knot) in spline.knots().iter().enumerate() {
            let delta = Mat::from_fn(n, 1, |v, _| f64::from(u8::from(v == knot as usize)));
            let green = space.poisson().unwrap().solve_biharmonic(delta);
            let (_, column) = extend(space, &green, 1, extension, Scheme::Planar).unwrap();
            for v in 0..fine.vertex_count() {
                for c in 0..3 {
                    sum[(v, c)] += coefficients[3 * k + c] * column[(v, 0)];
                }
            }
        }
        let difference = Mat::from_fn(fine.vertex_count(), 3, |v, c| {
            sum[(v, c)] + constant[c] - values[3 * v + c]
        });
        assert!(largest(&difference) < TOLERANCE * space.mesh().diagonal());
    }
}

#[test]
fn subdivision_keeps_vertices_and_refines_towards_the_surface() {
    let spline = small_spline();
    let coarse = spline.vertex_values().unwrap();
    let (once, fine) = spline
        .subdivision_values(1, Extension::AreaWeighted)
        .unwrap();
    assert_eq!(&fine[..coarse.len()], &coarse[..]);
    let (twice, finer) = spline
        .subdivision_values(2, Extension::AreaWeighted)
        .unwrap();
    assert_eq!(
        (once.face_count(), twice.face_count()),
        (2560 * 2, 2560 * 8)
    );
    let difference = fine
        .iter()
        .zip(&finer)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    assert!(
        difference < 2e-3 * spline.space().mesh().diagonal(),
        "{difference}"
    );
}

/// On another surface than the domain the extension is another function.
#[test]
fn only_the_planar_subdivision_gives_the_spline() {
    let spline = small_spline();
    let (_, expected) = spline
        .subdivision_values(1, Extension::AreaWeighted)
        .unwrap();
    let largest = |scheme| {
        let (_, values) = spline.extension_by(scheme, 1).unwrap();
        let apart = values.iter().zip(&expected).map(|(a, b)| (a - b).abs());
        apart.fold(0.0, f64::max)
    };
    assert_eq!(largest(Scheme::Planar), 0.0);
    assert!(largest(Scheme::Loop) > 1e-4 && largest(Scheme::Butterfly) > 1e-4);
}

#[test]
fn points_at_vertices_and_midpoints_take_the_values_there() {
    let spline = small_spline();
    let mesh = spline.space().mesh();
    let values = spline.vertex_values().unwrap();
    let (fine_mesh, fine) = spline
        .subdivision_values(1, Extension::AreaWeighted)
        .unwrap();
    let face = 11u32;
    let corners = mesh.faces()[face as usize];
    let mut samples = Samples::default();
    let at = |at| SurfacePoint { face, at };
    spline
        .prepare(&[at([0.0, 1.0, 0.0])], Order::Value)
        .unwrap()
        .evaluate(&mut samples);
    assert_eq!(samples.values[0], values[3 * corners[1] as usize]);
    let inner = [
        at([0.5, 0.5, 0.0]),
        at([0.0, 0.5, 0.5]),
        at([0.0, 0.0, 1.0]),
    ];
    spline
        .prepare(&inner, Order::Value)
        .unwrap()
        .evaluate(&mut samples);
    let middle = fine_mesh.faces()[4 * face as usize + 3];
    assert_eq!(samples.values[1], fine[3 * middle[0] as usize + 1]);
    assert_eq!(samples.values[3], fine[3 * middle[1] as usize]);
    assert_eq!(samples.values[6], values[3 * corners[2] as usize]);
}

#[test]
fn points_and_orders_that_do_not_exist_are_refused() {
    let spline = small_spline();
    let outside = SurfacePoint {
        face: 99_999,
        at: [1.0, 0.0, 0.0],
    };
    let error = |point, order| spline.prepare(&[point], order).err().unwrap();
    assert!(matches!(
        error(outside, Order::Value),
        EvaluateError::NoSuchFace { face: 99_999, .. }
    ));
    let off = SurfacePoint {
        face: 3,
        at: [0.7, 0.7, -0.4],
    };
    assert!(matches!(
        error(off, Order::Value),
        EvaluateError::OutsideFace { face: 3, .. }
    ));
    let inside = SurfacePoint {
        face: 3,
        at: [1.0, 0.0, 0.0],
    };
    assert!(matches!(
        error(inside, Order::Second),
        EvaluateError::OrderUnavailable { .. }
    ));
}

#[test]
fn parts_rebuild_the_same_bits_and_bad_parts_are_refused() {
    let spline = small_spline();
    let (coefficients, constant) = implicit(&spline);
    let build = |knots: Vec<u32>, coefficients: Vec<f64>| {
        let constant = constant.clone();
        let form = Form::Implicit {
            coefficients,
            constant,
        };
        BiharmonicSpline::from_parts(spline.space(), 3, knots, form)
    };
    let knots = spline.knots().to_vec();
    let again = build(knots.clone(), coefficients.clone()).unwrap();
    assert_eq!(
        again.vertex_values().unwrap(),
        spline.vertex_values().unwrap()
    );
    let mut swapped = knots.clone();
    swapped.swap(2, 3);
    assert!(matches!(
        build(swapped, coefficients.clone()),
        Err(PartsError::Knots { index: 3, .. })
    ));
    let short = coefficients[1..].to_vec();
    assert!(matches!(
        build(knots.clone(), short),
        Err(PartsError::Length { found: 71, .. })
    ));
    let mut bad = coefficients;
    bad[4] = f64::INFINITY;
    assert!(matches!(
        build(knots, bad),
        Err(PartsError::NotFinite { index: 4, .. })
    ));
}
