//! The fit against other formulations of the same problem.

use std::ops::ControlFlow;

use msplines_common::evaluate::VertexData;
use msplines_common::linalg::Mat;
use msplines_common::mesh::{TriangleMesh, double_cover, zoo};
use msplines_common::progress::{Outcome, unobserved};
use proptest::prelude::*;

use super::{centred, dense, dense_solve, gram, largest, positions, space, spread_knots, target};
use crate::knot_values::KnotValues;
use crate::{FitError, KnotChoice, Laplacian, Options, Space, fit, interpolate};

fn given(knots: Vec<u32>) -> Options {
    Options {
        knots: KnotChoice::Given(knots),
        ..Options::default()
    }
}

fn fitted(mesh: &TriangleMesh, values: &[f64], options: &Options) -> Vec<f64> {
    let data = VertexData {
        dimension: 3,
        values,
    };
    fit(mesh, data, options, &mut unobserved())
        .unwrap()
        .spline
        .vertex_values()
        .unwrap()
}

/// The projection form `f = S - B_Zᵀ (B_Z B_Zᵀ)⁻¹ B_Z S` never sees values at knots.
#[test]
fn knot_value_fit_equals_the_orthogonal_projection() {
    const TOLERANCE: f64 = 1e-8; // the projection squares the condition number
    for mesh in [zoo::closed(), zoo::with_boundary()] {
        let (space, data) = (space(&mesh), centred(&mesh));
        let knots = spread_knots(mesh.vertex_count(), 60);
        let b = dense(&space.bilaplacian().unwrap().matrix);
        let free: Vec<usize> = (0..b.nrows())
            .filter(|v| knots.binary_search(&(*v as u32)).is_err())
            .collect();
        let scale = |z: usize| b.row(z).norm_l2();
        let rows = Mat::from_fn(free.len(), b.nrows(), |i, v| {
            b[(free[i], v)] / scale(free[i])
        });
        let multipliers = dense_solve(&(&rows * rows.transpose()), &(&rows * &data));
        let projected = &data - rows.transpose() * multipliers;
        let system = KnotValues::factor(&space, knots).unwrap();
        let target = target(&mesh);
        let gram = gram(&space, &system, &target);
        let (f, report) = system.least_squares(&target, &data, &gram, 1e-22, 300);
        assert!(report.converged);
        assert!(largest(&(f - projected)) < TOLERANCE * largest(&data));
    }
}

/// For symmetric data on the closed double cover the open mesh with natural conditions is the same.
#[test]
fn open_mesh_equals_its_double_cover() {
    const TOLERANCE: f64 = 1e-12;
    let open = zoo::with_two_boundaries();
    let n = open.vertex_count();
    let (cover, other) = double_cover(&open).unwrap();
    assert!(cover.topology().boundary_loops().is_empty());
    let knots = spread_knots(n, 30);
    let mut both: Vec<u32> = knots.iter().flat_map(|&k| [k, other[k as usize]]).collect();
    both.sort_unstable();
    both.dedup();
    let data = centred(&open);
    let (open_space, cover_space) = (space(&open), space(&cover));
    let one = KnotValues::factor(&open_space, knots).unwrap();
    let two = KnotValues::factor(&cover_space, both).unwrap();
    let mut mirrored = Mat::zeros(cover.vertex_count(), 3);
    for v in 0..n {
        for c in 0..3 {
            mirrored[(v, c)] = data[(v, c)];
            mirrored[(other[v] as usize, c)] = data[(v, c)];
        }
    }
    let f = one.extend(one.gather(&data).as_ref());
    let g = two.extend(two.gather(&mirrored).as_ref());
    let upper = Mat::from_fn(n, 3, |v, c| g[(v, c)]);
    assert!(largest(&(f - upper)) < TOLERANCE * largest(&data).max(1.0));
}

#[test]
fn every_vertex_a_knot_interpolates() {
    for mesh in zoo::all() {
        let values = positions(&mesh);
        let data = VertexData {
            dimension: 3,
            values: &values,
        };
        let spline = interpolate(&mesh, data, Laplacian::Cotangent).unwrap();
        let found = spline.vertex_values().unwrap();
        let all = fitted(
            &mesh,
            &values,
            &Options {
                knots: KnotChoice::All,
                ..Options::default()
            },
        );
        let diagonal = mesh.diagonal();
        for ((expected, found), fitted) in values.iter().zip(&found).zip(&all) {
            assert!((expected - found).abs() < 1e-8 * diagonal);
            assert_eq!(found, fitted);
        }
    }
}

#[test]
fn one_knot_gives_the_mean() {
    let mesh = zoo::closed();
    let values = positions(&mesh);
    let found = fitted(&mesh, &values, &given(vec![5]));
    let mean = values.iter().step_by(3).sum::<f64>() / mesh.vertex_count() as f64;
    assert!(found.iter().step_by(3).all(|x| (x - mean).abs() < 1e-12));
}

#[test]
fn intrinsic_delaunay_and_cotangent_splines_are_close() {
    let mesh = zoo::closed();
    let values = positions(&mesh);
    let knots = spread_knots(mesh.vertex_count(), 80);
    let cotangent = fitted(&mesh, &values, &given(knots.clone()));
    let options = Options {
        laplacian: Laplacian::IntrinsicDelaunay,
        ..given(knots)
    };
    let intrinsic = fitted(&mesh, &values, &options);
    let difference = cotangent.iter().zip(&intrinsic).map(|(a, b)| (a - b).abs());
    assert!(difference.fold(0.0, f64::max) < 0.02 * mesh.diagonal());
}

#[test]
fn data_far_from_the_origin_fits_as_well() {
    let mesh = zoo::with_boundary();
    let near = positions(&mesh);
    let far: Vec<f64> = near.iter().map(|x| x + 1e9).collect();
    let options = given(spread_knots(mesh.vertex_count(), 50));
    let (near, far) = (
        fitted(&mesh, &near, &options),
        fitted(&mesh, &far, &options),
    );
    assert!(
        near.iter()
            .zip(&far)
            .all(|(a, b)| (b - a - 1e9).abs() < 1e-5)
    );
}

#[test]
fn stopping_at_once_still_gives_the_asked_number_of_knots() {
    let mesh = zoo::closed();
    let values = positions(&mesh);
    let options = Options {
        knots: KnotChoice::Optimised { count: 40 },
        ..Options::default()
    };
    let data = VertexData {
        dimension: 3,
        values: &values,
    };
    let result = fit(&mesh, data, &options, &mut |_| ControlFlow::Break(())).unwrap();
    assert_eq!(result.report.outcome, Outcome::Stopped);
    assert_eq!(result.spline.knots().len(), 40);
}

#[test]
fn errors_name_the_place_and_the_remedy() {
    let mesh = zoo::closed();
    let mut values = positions(&mesh);
    let run = |values: &[f64], options: &Options| {
        let data = VertexData {
            dimension: 3,
            values,
        };
        fit(&mesh, data, options, &mut unobserved())
            .unwrap_err()
            .to_string()
    };
    let count = |count| Options {
        knots: KnotChoice::Optimised { count },
        ..Options::default()
    };
    let n = mesh.vertex_count();
    let expected = format!("0 knots were asked for, but the mesh has {n} vertices");
    assert!(run(&values, &count(0)).starts_with(&expected));
    assert!(run(&values, &count(n + 1)).contains("choose between 1 and"));
    let repeated = "vertex 7 is given as a knot more than once; give each knot once";
    assert_eq!(run(&values, &given(vec![7, 3, 7])), repeated);
    assert!(run(&values, &given(vec![n as u32])).contains("knot 0 is vertex"));
    assert!(run(&values[1..], &count(9)).contains("values were given for"));
    values[3 * 17 + 1] = f64::NAN;
    assert!(run(&values, &count(9)).contains("component 1 of the data at vertex 17 is NaN"));
}

#[test]
fn separate_surfaces_are_refused() {
    let one = zoo::closed();
    let n = one.vertex_count() as u32;
    let mut positions = one.positions().to_vec();
    positions.extend(
        one.positions()
            .iter()
            .map(|p| p + nalgebra::Vector3::new(9.0, 0.0, 0.0)),
    );
    let mut faces = one.faces().to_vec();
    faces.extend(one.faces().iter().map(|f| f.map(|v| v + n)));
    let mesh = TriangleMesh::build(positions, faces).unwrap();
    let error = Space::build(std::sync::Arc::new(mesh), Laplacian::Cotangent).unwrap_err();
    assert_eq!(error, FitError::NotConnected { components: 2 });
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]
    #[test]
    fn scaling_and_moving_the_surface_scales_and_moves_the_spline(
        scale in 1e-3f64..1e3, shift in -10.0f64..10.0,
    ) {
        let mesh = zoo::with_boundary();
        let moved = mesh.with_positions(
            mesh.positions().iter().map(|p| p.map(|x| x * scale + shift)).collect(),
        );
        let options = given(spread_knots(mesh.vertex_count(), 25));
        let plain = fitted(&mesh, &positions(&mesh), &options);
        let other = fitted(&moved, &positions(&moved), &options);
        for (a, b) in plain.iter().zip(&other) {
            prop_assert!((a * scale + shift - b).abs() < 1e-6 * scale * mesh.diagonal());
        }
    }
}
