//! Laws of least-squares meshes, on a bumpy torus and a bumpy square.

use std::ops::ControlFlow;

use msplines_common::evaluate::{EvaluateError, Order, Samples, SurfaceSpline, VertexData};
use msplines_common::linalg::Mat;
use msplines_common::mesh::{SurfacePoint, TriangleMesh};
use msplines_common::progress::{Outcome, Progress, unobserved};
use nalgebra::{DMatrix, Point3};
use proptest::prelude::*;

use crate::space::Space;
use crate::system::System;
use crate::{Constraints, ControlChoice, FitError, LsMesh, Options, Selection, fit, fit_in};

/// Two backward-stable solutions of systems of condition below 1e5.
const SOLVE_TOLERANCE: f64 = 1e-10;

const SOFT: Constraints = Constraints::Soft { weight: 1.0 };

fn grid_faces(m: u32, n: u32, closed: bool) -> Vec<[u32; 3]> {
    let (rows, columns) = if closed { (m, n) } else { (m - 1, n - 1) };
    let at = |i: u32, j: u32| (i % m) * n + j % n;
    let cells = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
    cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

fn torus(m: u32, n: u32) -> TriangleMesh {
    let position = |v: u32| {
        let turn = std::f64::consts::TAU;
        let (u, w) = (
            f64::from(v / n) / f64::from(m) * turn,
            f64::from(v % n) / f64::from(n) * turn,
        );
        let bump = 1.0 + 0.3 * (3.0 * u + 0.4).sin() * (2.0 * w + 0.7).cos();
        let radius = 3.0 + bump * w.cos();
        Point3::new(radius * u.cos(), radius * u.sin(), bump * w.sin())
    };
    TriangleMesh::build((0..m * n).map(position).collect(), grid_faces(m, n, true)).unwrap()
}

fn square(m: u32, n: u32) -> TriangleMesh {
    let position = |v: u32| {
        // Curved in both directions, so that no two errors are equal.
        let (x, y) = (
            f64::from(v / n),
            1.02_f64.powi((v % n) as i32) * f64::from(v % n),
        );
        Point3::new(x, y, (0.7 * x).sin() * (0.45 * y + 0.3).cos())
    };
    TriangleMesh::build((0..m * n).map(position).collect(), grid_faces(m, n, false)).unwrap()
}

fn coordinates(mesh: &TriangleMesh) -> Vec<f64> {
    mesh.positions()
        .iter()
        .flat_map(|p| [p.x, p.y, p.z])
        .collect()
}

fn positions(values: &[f64]) -> VertexData<'_> {
    VertexData {
        dimension: 3,
        values,
    }
}

fn given(controls: &[u32], constraints: Constraints) -> Options {
    Options {
        controls: ControlChoice::Given(controls.to_vec()),
        constraints,
        ..Options::default()
    }
}

fn selected(count: usize, selection: Selection, constraints: Constraints) -> Options {
    Options {
        controls: ControlChoice::Selected { count },
        selection,
        constraints,
    }
}

fn fitted(mesh: &TriangleMesh, options: &Options) -> LsMesh {
    fit(
        mesh,
        positions(&coordinates(mesh)),
        options,
        &mut unobserved(),
    )
    .unwrap()
    .spline
}

fn mean_error(spline: &LsMesh, values: &[f64]) -> f64 {
    let rows = spline
        .vertex_values()
        .chunks_exact(3)
        .zip(values.chunks_exact(3));
    let total: f64 = rows
        .map(|(a, b)| {
            a.iter()
                .zip(b)
                .map(|(a, b)| (a - b).powi(2))
                .sum::<f64>()
                .sqrt()
        })
        .sum();
    total / (values.len() / 3) as f64
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

/// `I - D⁻¹ W`, from the faces alone.
fn dense_laplacian(mesh: &TriangleMesh) -> DMatrix<f64> {
    let n = mesh.vertex_count();
    let mut adjacency = DMatrix::zeros(n, n);
    for corners in mesh.faces() {
        for i in 0..3 {
            let (a, b) = (corners[i] as usize, corners[(i + 1) % 3] as usize);
            adjacency[(a, b)] = 1.0;
            adjacency[(b, a)] = 1.0;
        }
    }
    DMatrix::from_fn(n, n, |i, j| {
        f64::from(i == j) - adjacency[(i, j)] / adjacency.row(i).sum()
    })
}

#[test]
fn soft_constraints_give_the_dense_least_squares_solution() {
    for mesh in [torus(9, 7), square(8, 9)] {
        let n = mesh.vertex_count();
        let controls = [3, 17, 30, 44, 60];
        for weight in [0.3, 1.0, 20.0] {
            let mut matrix = dense_laplacian(&mesh).insert_rows(n, controls.len(), 0.0);
            let mut rhs = DMatrix::zeros(n + controls.len(), 3);
            for (row, &control) in controls.iter().enumerate() {
                matrix[(n + row, control as usize)] = weight;
                let position = mesh.positions()[control as usize];
                (0..3).for_each(|side| rhs[(n + row, side)] = weight * position[side]);
            }
            let expected = matrix.svd(true, true).solve(&rhs, 0.0).unwrap();
            let expected: Vec<f64> = expected.transpose().iter().copied().collect();
            let spline = fitted(&mesh, &given(&controls, Constraints::Soft { weight }));
            let difference = largest_difference(spline.vertex_values(), &expected);
            assert!(
                difference < SOLVE_TOLERANCE,
                "weight {weight}: {difference}"
            );
        }
    }
}

#[test]
fn hard_constraints_interpolate_and_minimise_over_the_rest() {
    let mesh = torus(9, 7);
    let controls = [3, 17, 30, 44, 60];
    let spline = fitted(&mesh, &given(&controls, Constraints::Hard));
    let values = coordinates(&mesh);
    for &control in &controls {
        let range = 3 * control as usize..3 * control as usize + 3;
        assert_eq!(spline.vertex_values()[range.clone()], values[range]);
    }
    // The gradient of the energy vanishes at every vertex that is no control.
    let laplacian = dense_laplacian(&mesh);
    let x = DMatrix::from_row_slice(mesh.vertex_count(), 3, spline.vertex_values());
    let gradient = laplacian.transpose() * (&laplacian * x);
    for vertex in (0..mesh.vertex_count()).filter(|v| !controls.contains(&(*v as u32))) {
        assert!(
            gradient.row(vertex).amax() < SOLVE_TOLERANCE,
            "vertex {vertex}"
        );
    }
}

#[test]
fn heavy_soft_constraints_approach_hard_ones() {
    let mesh = square(8, 9);
    let controls = [3, 17, 30, 44, 60];
    let hard = fitted(&mesh, &given(&controls, Constraints::Hard));
    let soft = fitted(&mesh, &given(&controls, Constraints::Soft { weight: 1e4 }));
    assert!(largest_difference(soft.vertex_values(), hard.vertex_values()) < 1e-6);
}

#[test]
fn all_vertices_as_hard_controls_reproduce_the_data() {
    let mesh = square(7, 6);
    let all: Vec<u32> = (0..42).rev().collect();
    let values = coordinates(&mesh);
    assert_eq!(
        fitted(&mesh, &given(&all, Constraints::Hard)).vertex_values(),
        values
    );
    for selection in [Selection::Greedy, Selection::Combined { solves: 5 }] {
        let spline = fitted(&mesh, &selected(42, selection, Constraints::Hard));
        assert_eq!(spline.vertex_values(), values);
    }
}

#[test]
fn constant_data_are_reproduced() {
    let mesh = torus(12, 9);
    let values = vec![-7.25; mesh.vertex_count()];
    let data = VertexData {
        dimension: 1,
        values: &values,
    };
    for constraints in [SOFT, Constraints::Hard] {
        let options = selected(9, Selection::Combined { solves: 3 }, constraints);
        let fit = fit(&mesh, data, &options, &mut unobserved()).unwrap();
        assert_eq!(fit.spline.vertex_values(), values);
        assert_eq!(fit.spline.controls().len(), 9);
    }
}

#[test]
fn a_surface_far_from_the_origin_is_the_same_surface() {
    let mesh = torus(16, 12);
    let options = selected(24, Selection::Combined { solves: 6 }, SOFT);
    let near = fitted(&mesh, &options);
    let shift = 1048576.0;
    let moved: Vec<f64> = coordinates(&mesh).iter().map(|x| x + shift).collect();
    let far = fit(&mesh, positions(&moved), &options, &mut unobserved())
        .unwrap()
        .spline;
    let back: Vec<f64> = far.vertex_values().iter().map(|x| x - shift).collect();
    // The coordinates themselves keep ten digits.
    assert!(largest_difference(near.vertex_values(), &back) < 1e-8);
}

#[test]
fn selection_brings_the_error_down() {
    for mesh in [torus(40, 24), square(30, 30)] {
        let values = coordinates(&mesh);
        for constraints in [SOFT, Constraints::Hard] {
            for selection in [Selection::Greedy, Selection::Combined { solves: 10 }] {
                let errors: Vec<f64> = [10, 40, 160]
                    .iter()
                    .map(|&count| {
                        mean_error(
                            &fitted(&mesh, &selected(count, selection, constraints)),
                            &values,
                        )
                    })
                    .collect();
                assert!(
                    errors[1] < errors[0] && errors[2] < 0.3 * errors[0],
                    "{errors:?}"
                );
            }
        }
    }
}

#[test]
fn selected_controls_beat_as_many_in_a_row() {
    let mesh = torus(40, 24);
    let values = coordinates(&mesh);
    let chosen = mean_error(
        &fitted(&mesh, &selected(60, Selection::Greedy, SOFT)),
        &values,
    );
    let regular: Vec<u32> = (0..60).map(|i| i * 16).collect();
    assert!(chosen < mean_error(&fitted(&mesh, &given(&regular, SOFT)), &values));
}

#[test]
fn stale_factors_lead_to_the_solution_from_scratch() {
    let mesh = torus(40, 24);
    let space = Space::assemble(&mesh).unwrap();
    let data = Mat::from_fn(mesh.vertex_count(), 3, |v, side| mesh.positions()[v][side]);
    for constraints in [SOFT, Constraints::Hard] {
        let start = Mat::zeros(mesh.vertex_count(), 3);
        let mut growing = System::new(&space, constraints, data.clone(), start.clone());
        for batch in 0..8u32 {
            let controls: Vec<u32> = (0..10).map(|i| (batch * 10 + i) * 11 % 960).collect();
            growing.add(&controls);
            growing.improve(1e-12).unwrap();
            let mut fresh = System::new(&space, constraints, data.clone(), start.clone());
            fresh.add(growing.controls());
            fresh.solve().unwrap();
            let difference = (growing.solution() - fresh.solution()).norm_max();
            assert!(difference < 1e-8, "batch {batch}: {difference}");
        }
    }
}

#[test]
fn a_rough_solve_with_a_stale_factor_comes_nearer() {
    let mesh = torus(40, 24);
    let space = Space::assemble(&mesh).unwrap();
    let data = Mat::from_fn(mesh.vertex_count(), 3, |v, side| mesh.positions()[v][side]);
    for constraints in [SOFT, Constraints::Hard] {
        let start = Mat::zeros(mesh.vertex_count(), 3);
        let mut growing = System::new(&space, constraints, data.clone(), start.clone());
        growing.add(&[5, 333, 700]);
        growing.improve(0.1).unwrap();
        for batch in 0..3u32 {
            growing.add(&[40 + batch * 300, 90 + batch * 290, 150 + batch * 280]);
            let mut exact = System::new(&space, constraints, data.clone(), start.clone());
            exact.add(growing.controls());
            exact.solve().unwrap();
            let before = (growing.solution() - exact.solution()).norm_l2();
            growing.improve(0.1).unwrap();
            let after = (growing.solution() - exact.solution()).norm_l2();
            assert!(
                after < 0.3 * before,
                "batch {batch}: {before} became {after}"
            );
        }
    }
}

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
fn a_break_returns_the_controls_so_far() {
    let mesh = torus(40, 24);
    let values = coordinates(&mesh);
    let mut seen: Vec<Progress> = Vec::new();
    let options = selected(100, Selection::Combined { solves: 10 }, SOFT);
    let stopped = fit(&mesh, positions(&values), &options, &mut |progress| {
        seen.push(progress.clone());
        if seen.len() == 3 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    })
    .unwrap();
    assert_eq!(stopped.report.outcome, Outcome::Stopped);
    let found = stopped.spline.controls().len();
    assert_eq!(found as u64, seen[2].done);
    assert!(found < 40);
    assert_eq!(seen.iter().filter(|p| p.phase == "select").count(), 3);
    assert!(
        seen[..3]
            .iter()
            .all(|p| p.total == 100 && p.objective > Some(0.0))
    );
    assert_eq!((seen[3].phase, seen[4].phase), ("fit", "fit"));
    let whole = fit(&mesh, positions(&values), &options, &mut unobserved()).unwrap();
    assert_eq!(whole.report.outcome, Outcome::Converged);
    assert_eq!(whole.spline.controls()[..found], *stopped.spline.controls());
    assert_eq!(whole.report.iterations, 10);
}

#[test]
fn every_component_gets_a_control() {
    let one = torus(8, 6);
    let n = one.vertex_count() as u32;
    let faces = one
        .faces()
        .iter()
        .flat_map(|f| [*f, f.map(|v| v + n)])
        .collect();
    let apart = one
        .positions()
        .iter()
        .map(|p| Point3::new(0.01 * p.x + 40.0, p.y, p.z));
    let points = one.positions().iter().copied().chain(apart).collect();
    let mesh = TriangleMesh::build(points, faces).unwrap();
    let spline = fitted(&mesh, &selected(2, Selection::Greedy, SOFT));
    assert!(spline.controls().iter().any(|&v| v < n) && spline.controls().iter().any(|&v| v >= n));
    let values = coordinates(&mesh);
    let refused = |options: &Options| {
        fit(&mesh, positions(&values), options, &mut unobserved())
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        refused(&selected(1, Selection::Greedy, SOFT)),
        "1 controls cannot hold 2 components; ask for one each, or keep only the largest component"
    );
    assert_eq!(
        refused(&given(&[3, 5], SOFT)),
        "the component of vertex 48 has no control; give it at least one"
    );
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
        "component 2 at vertex 5 is NaN; give finite values"
    );
    assert_eq!(
        refused(&given(&[7], Constraints::Soft { weight: -1.0 }), &values),
        "a control weight of -1 is not positive and finite; use 1, or hard constraints"
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

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn renumbering_the_vertices_renumbers_the_surface(keys in prop::collection::vec(0u64.., 96)) {
        let mesh = square(12, 8);
        let mut order: Vec<u32> = (0..96).collect();
        order.sort_by_key(|&v| (keys[v as usize], v));
        // Vertex `order[v]` of the mesh is vertex `v` of the other one.
        let mut rank = vec![0; 96];
        order.iter().enumerate().for_each(|(v, &old)| rank[old as usize] = v as u32);
        let faces = mesh.faces().iter().map(|f| f.map(|v| rank[v as usize])).collect();
        let points = order.iter().map(|&old| mesh.positions()[old as usize]).collect();
        let other = TriangleMesh::build(points, faces).unwrap();
        let options = selected(14, Selection::Combined { solves: 4 }, SOFT);
        let (one, two) = (fitted(&mesh, &options), fitted(&other, &options));
        let mapped: Vec<u32> = two.controls().iter().map(|&v| order[v as usize]).collect();
        prop_assert_eq!(one.controls(), mapped);
    }

    #[test]
    fn the_surface_is_affine_in_its_data(a in prop::array::uniform9(-2.0..2.0), seed in 0u32..40) {
        let mesh = torus(9, 7);
        let controls: Vec<u32> = (0..6).map(|i| (seed + i * 10) % 63).collect();
        let values = coordinates(&mesh);
        let map = |p: &[f64]| (0..3).map(|r| a[3 * r] * p[0] + a[3 * r + 1] * p[1] + a[3 * r + 2] * p[2] + 5.0).collect::<Vec<_>>();
        let mapped: Vec<f64> = values.chunks_exact(3).flat_map(map).collect();
        let options = given(&controls, SOFT);
        let one = fitted(&mesh, &options);
        let two = fit(&mesh, positions(&mapped), &options, &mut unobserved()).unwrap().spline;
        let expected: Vec<f64> = one.vertex_values().chunks_exact(3).flat_map(map).collect();
        prop_assert!(largest_difference(two.vertex_values(), &expected) < SOLVE_TOLERANCE);
    }
}
