//! Conditions and options that make no task, and surfaces that cannot be filled smoothly.

use std::ops::ControlFlow;

use msplines_common::mesh::shapes;
use msplines_common::progress::unobserved;
use msplines_common::{Point3, Vector3};

use super::{atlas, fitted, options};
use crate::surface::{Cap, Filled, SurfaceWarning};
use crate::{Fill, FitError, SurfaceError, VertexCondition, estimate_normals, fit_surface};

#[test]
fn conditions_that_are_no_task_are_refused() {
    let atlas = atlas(&shapes::genus(2, 2500));
    let normals = estimate_normals(atlas.mesh()).expect("normals");
    let conditions = VertexCondition::of_mesh(atlas.mesh(), &normals);
    let inside = atlas.zeros()[0].vertices[0];
    let refused = |vertex: u32, condition: VertexCondition| {
        let mut conditions = conditions.clone();
        conditions[vertex as usize] = condition;
        let options = options(Fill::Smooth);
        let found = fit_surface(&atlas, &conditions, &options, &mut unobserved());
        found.expect_err("an error")
    };
    let position = Point3::origin();
    let error = refused(
        inside,
        VertexCondition::Fixed {
            position,
            gradient: [Vector3::x(), Vector3::y()],
        },
    );
    assert_eq!(error, SurfaceError::GradientInHole { vertex: inside });
    assert!(error.to_string().contains("give a position and a normal"));
    let normal = Vector3::zeros();
    let error = refused(inside, VertexCondition::Interpolate { position, normal });
    assert_eq!(
        error,
        SurfaceError::Fit(FitError::Normal { vertex: inside })
    );
    let far = Point3::new(f64::NAN, 0.0, 0.0);
    let error = refused(9, VertexCondition::Position { position: far });
    assert_eq!(error, SurfaceError::Fit(FitError::NotFinite { vertex: 9 }));
    let short = &conditions[1..];
    let found = fit_surface(&atlas, short, &options(Fill::Smooth), &mut unobserved());
    assert!(matches!(
        found.err(),
        Some(SurfaceError::Fit(FitError::DataCount { .. }))
    ));
    let free = vec![VertexCondition::Free; conditions.len()];
    let found = fit_surface(&atlas, &free, &options(Fill::Smooth), &mut unobserved());
    let part = FitError::ComponentWithoutPosition { vertex: 0 };
    assert_eq!(found.err(), Some(SurfaceError::Fit(part)));
}

#[test]
fn free_and_fixed_vertices_around_holes_are_no_obstacle() {
    let atlas = atlas(&shapes::genus(2, 2500));
    let normals = estimate_normals(atlas.mesh()).expect("normals");
    let mut conditions = VertexCondition::of_mesh(atlas.mesh(), &normals);
    let mesh = atlas.mesh();
    let inside = atlas.zeros()[0].vertices[0];
    conditions[inside as usize] = VertexCondition::Free;
    let plain = fit_surface(
        &atlas,
        &conditions,
        &options(Fill::Smooth),
        &mut unobserved(),
    );
    let plain = plain.expect("a surface").spline;
    let beside = mesh
        .topology()
        .neighbours(inside)
        .next()
        .expect("a neighbour");
    let place = plain
        .regular_vertices()
        .binary_search(&beside)
        .expect("regular");
    conditions[beside as usize] = VertexCondition::Fixed {
        position: mesh.positions()[beside as usize],
        gradient: plain.regular().vertex_gradient(place as u32),
    };
    let found = fit_surface(
        &atlas,
        &conditions,
        &options(Fill::Smooth),
        &mut unobserved(),
    );
    let found = found.expect("a surface");
    assert!(
        found
            .spline
            .caps()
            .iter()
            .all(|h| matches!(h.cap(), Cap::Smooth(_)))
    );
    let checks = found.spline.measure(&conditions, 1, 2000);
    assert!(
        checks.position_max < 1e-14 && checks.normal_max < 1e-13,
        "{checks:?}"
    );
}

#[test]
fn a_mesh_too_coarse_for_a_chart_gets_a_minimal_surface_and_a_warning() {
    // Any two rings of so few faces are all of them.
    let (found, conditions) = fitted(&shapes::sphere(6), Fill::Smooth);
    let [report] = found.report.holes.as_slice() else {
        panic!("one pole");
    };
    assert!(
        matches!(report.filled, Filled::Minimal { .. }),
        "{report:?}"
    );
    let said = |w: &&SurfaceWarning| matches!(w, SurfaceWarning::MinimalInstead { .. });
    let warning = found.report.warnings.iter().find(said).expect("a warning");
    let text = warning.to_string();
    let vertex = format!("vertex {}", report.vertex);
    assert!(
        text.contains(&vertex) && text.contains("refine the mesh"),
        "{text}"
    );
    assert!(found.spline.measure(&conditions, 1, 100).position_max < 1e-14);
}

#[test]
fn a_break_leaves_holes_open() {
    let atlas = atlas(&shapes::genus(2, 2500));
    let normals = estimate_normals(atlas.mesh()).expect("normals");
    let conditions = VertexCondition::of_mesh(atlas.mesh(), &normals);
    let mut observer = |step: &msplines_common::progress::Progress| {
        if step.phase == "caps" {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let found = fit_surface(&atlas, &conditions, &options(Fill::Smooth), &mut observer);
    let found = found.expect("a surface");
    assert!(found.report.holes.iter().all(|h| h.filled == Filled::Open));
    assert_eq!(found.report.regular.warnings, []);
}
