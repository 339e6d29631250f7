//! Conditions and options that make no task, and surfaces that cannot be filled smoothly.

use std::collections::BTreeSet;
use std::ops::ControlFlow;

use msplines_common::mesh::{SurfacePoint, TriangleMesh, shapes};
use msplines_common::progress::unobserved;
use msplines_common::{Point3, Vector3};

use super::{atlas, fitted, options};
use crate::fit::Warning;
use crate::surface::{Cap, Filled, SurfaceWarning};
use crate::tests::Random;
use crate::{
    Fill, FitError, PowellSabinSurface, SurfaceError, SurfaceFit, VertexCondition,
    estimate_normals, fit_surface,
};

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

/// Fits a double torus whose normals were changed; returns the surface, or nothing, and what was said.
fn with_normals(
    change: impl Fn(u32, Vector3<f64>) -> Vector3<f64>,
) -> Result<(SurfaceFit, Vec<VertexCondition>), SurfaceError> {
    let atlas = atlas(&shapes::genus(2, 2500));
    let normals = estimate_normals(atlas.mesh()).expect("normals");
    let changed = (0u32..).zip(normals).map(|(v, normal)| change(v, normal));
    let conditions = VertexCondition::of_mesh(atlas.mesh(), &changed.collect::<Vec<_>>());
    let options = options(Fill::Smooth);
    let found = fit_surface(&atlas, &conditions, &options, &mut unobserved())?;
    Ok((found, conditions))
}

/// All vertices that the warnings of a fit name.
fn named(found: &SurfaceFit) -> BTreeSet<u32> {
    let of = |warning: &Warning| match warning {
        Warning::OpposedNormals { vertices } | Warning::InsideOut { vertices } => vertices.clone(),
        Warning::NearlySingular { .. } => Vec::new(),
    };
    let vertices = found
        .report
        .warnings
        .iter()
        .flat_map(|warning| match warning {
            SurfaceWarning::Regular(warning) | SurfaceWarning::Cap { warning, .. } => of(warning),
            SurfaceWarning::Folded { vertices, .. } => vertices.clone(),
            _ => Vec::new(),
        });
    vertices.collect()
}

/// Another normal for a vertex.
type Change<'a> = dyn Fn(u32, Vector3<f64>) -> Vector3<f64> + 'a;

#[test]
fn wrong_normals_are_never_silent() {
    let random = |v: u32| {
        let mut random = Random::new(u64::from(v) + 1);
        Vector3::from_fn(|_, _| random.next() - 0.5)
    };
    let some = |v: u32| v.is_multiple_of(97);
    let turned = |n: Vector3<f64>, v: u32| if some(v) { -n } else { n };
    let cases: [(&str, &Change<'_>); 5] = [
        ("all flipped", &|_, n| -n),
        ("some flipped", &|v, n| turned(n, v)),
        ("some random", &|v, n| if some(v) { random(v) } else { n }),
        ("all random", &|v, _| random(v)),
        ("some along the surface", &|v, n| {
            let along = n.cross(&random(v)).normalize();
            if some(v) { along } else { n }
        }),
    ];
    for (name, change) in cases {
        let (found, conditions) = with_normals(change).expect("a surface");
        let surface = &found.spline;
        let named = named(&found);
        assert!(!named.is_empty(), "{name}");
        let mesh = surface.mesh();
        for (vertex, condition) in conditions.iter().enumerate() {
            let VertexCondition::Interpolate { normal, .. } = condition else {
                continue;
            };
            let mut around = mesh.topology().outgoing(vertex as u32).map(|h| h / 3);
            let opposed = around.all(|f| mesh.face_normal(f).dot(normal) < 0.0);
            let vertex = vertex as u32;
            assert!(
                !opposed || named.contains(&vertex),
                "{name}: vertex {vertex}"
            );
        }
        assert_folds_are_named(name, surface, &named);
        // Values are kept whatever normals say.
        assert!(
            surface.measure(&conditions, 1, 100).position_max < 1e-14,
            "{name}"
        );
        let texts: Vec<String> = found
            .report
            .warnings
            .iter()
            .map(ToString::to_string)
            .collect();
        assert!(
            texts.iter().any(|t| t.contains("normals")),
            "{name}: {texts:?}"
        );
    }
}

/// Checks that faces that random points find turned over have a vertex that is named.
fn assert_folds_are_named(name: &str, surface: &PowellSabinSurface, named: &BTreeSet<u32>) {
    let mesh = surface.mesh();
    let points = random_points(mesh, 20_000);
    let normals = surface.normals(&points).expect("points");
    let (mut folded, mut told) = (0, 0);
    for (point, normal) in points.iter().zip(normals) {
        assert!(normal.iter().all(|c| c.is_finite()), "{name}");
        if normal.dot(&mesh.face_normal(point.face)) < 0.0 {
            folded += 1;
            let corners = mesh.faces()[point.face as usize];
            told += usize::from(corners.iter().any(|v| named.contains(v)));
        }
    }
    // A normal along the surface makes it steep, and turn over at a corner only.
    assert!(folded > 0 || name.ends_with("along the surface"), "{name}");
    // A fold smaller than the grid may be met beside all that are named.
    assert!(told * 1000 >= folded * 999, "{name}: {told} of {folded}");
}

fn random_points(mesh: &TriangleMesh, count: u32) -> Vec<SurfacePoint> {
    let mut random = Random::new(9);
    let faces = mesh.face_count() as u32;
    let point = |k: u32| SurfacePoint {
        face: k % faces,
        at: random.barycentric(),
    };
    (0..count).map(point).collect()
}

#[test]
fn lengths_of_normals_do_not_matter_and_numbers_that_are_none_are_refused() {
    let (plain, _) = with_normals(|_, n| n).expect("a surface");
    assert_eq!(plain.report.warnings, []);
    for scale in [1e-310, 1e-200, 1e200] {
        let (found, _) = with_normals(|_, n| scale * n).expect("a surface");
        assert_eq!(found.report.warnings, []);
        let [a, b] = [&plain, &found].map(|f| f.spline.regular().vertex_gradients());
        let gap = a
            .iter()
            .zip(b)
            .fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        // Numbers near the smallest have few digits themselves.
        let digits = if scale < 1e-300 { 1e-10 } else { 1e-13 };
        assert!(gap < digits, "{scale:e} {gap:e}");
    }
    for bad in [f64::NAN, f64::INFINITY] {
        let error = with_normals(|v, n| if v == 41 { bad * n } else { n }).err();
        assert_eq!(
            error,
            Some(SurfaceError::Fit(FitError::Normal { vertex: 41 }))
        );
    }
    let error = with_normals(|v, n| if v == 41 { 0.0 * n } else { n }).err();
    let error = error.expect("a refusal").to_string();
    assert!(error.contains("vertex 41") && error.contains("estimate normals"));
}
