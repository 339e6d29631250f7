//! Which controls are selected, and how.

use std::ops::ControlFlow;

use msplines_common::linalg::Mat;
use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::{Outcome, Progress, unobserved};
use nalgebra::Point3;

use super::{SOFT, coordinates, fitted, given, mean_error, positions, selected, square, torus};
use crate::space::Space;
use crate::system::System;
use crate::{Constraints, Options, Selection, fit};

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
