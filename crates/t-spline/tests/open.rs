//! T-splines of surfaces with boundary: how near they are, at the boundary too.
#![allow(
    clippy::print_stdout,
    reason = "the figures of every surface are shown"
)]

#[path = "../../../tests/library.rs"]
mod library;

use msplines_common::evaluate::Order;
use msplines_common::mesh::{TriangleMesh, shapes};
use msplines_common::progress::unobserved;
use msplines_t_spline::caps::CapOptions;
use msplines_t_spline::domain::{Domain, DomainOptions};
use msplines_t_spline::fit::{FitError, FittedSurface};
use msplines_t_spline::{FitOptions, Sampling, Stop, TSplineSurface};

fn cut(mesh: &TriangleMesh, poles: &[u32]) -> Domain {
    let options = DomainOptions {
        poles: poles.to_vec(),
        ..DomainOptions::default()
    };
    Domain::of_surface(mesh, &options, &mut unobserved()).expect("a domain")
}

fn fitted(domain: Domain, mesh: &TriangleMesh, stop: Stop) -> Result<FittedSurface, FitError> {
    let options = FitOptions {
        stop,
        ..FitOptions::default()
    };
    let sampling = Sampling::default();
    TSplineSurface::fit(domain, mesh, &sampling, &options, &mut unobserved())
}

fn surface(mesh: &TriangleMesh, poles: &[u32], points: usize) -> TSplineSurface {
    let fitted = fitted(cut(mesh, poles), mesh, Stop::ControlPoints(points));
    fitted.expect("a surface").surface
}

/// Root mean squares of the errors of all vertices and of those at the boundary, over the longest side of the
/// bounding box, and how many faces at the boundary are turned over.
fn measured(name: &str, mesh: &TriangleMesh, surface: &TSplineSurface) -> ([f64; 2], usize) {
    let [low, high] = mesh.bounding_box();
    let side = (high - low).max();
    let topology = mesh.topology();
    let places = surface.vertices();
    let found = surface.spline().evaluate(&places, Order::Value).positions;
    let mut moved = mesh.positions().to_vec();
    let names = surface.domain().origins().iter().zip(found);
    names.for_each(|(name, at)| {
        if let Some(v) = *name {
            moved[v as usize] = at;
        }
    });
    let moved = mesh.with_positions(moved);
    let pole = |v: u32| surface.domain().poles().iter().any(|pole| pole.vertex == v);
    let square = |v: u32| {
        let [a, b] = [mesh, &moved].map(|mesh| mesh.positions()[v as usize]);
        (a - b).norm_squared() / (side * side)
    };
    let rms = |among: &dyn Fn(u32) -> bool| {
        let chosen = (0..mesh.vertex_count() as u32).filter(|&v| among(v) && !pole(v));
        let squares: Vec<f64> = chosen.map(square).collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    let errors = [rms(&|_| true), rms(&|v| topology.is_boundary_vertex(v))];
    let turned = (0..mesh.face_count() as u32).filter(|&face| {
        let mut corners = mesh.faces()[face as usize].into_iter();
        let normals = [mesh, &moved].map(|mesh| mesh.face_normal(face));
        corners.any(|v| topology.is_boundary_vertex(v)) && normals[0].dot(&normals[1]) <= 0.0
    });
    let turned = turned.count();
    println!(
        "{name}: rms {:.3e}, at the boundary {:.3e}; {turned} faces turned",
        errors[0], errors[1]
    );
    (errors, turned)
}

/// Surface, control points, and bounds on the errors: a quarter above what was measured. Flat faces are sampled
/// too, which a smooth surface through the vertices does not lie in: those are met less well than by themselves.
#[test]
fn boundaries_are_met_as_well_as_the_rest() {
    for (name, mesh, points, [all, boundary]) in [
        ("bowl", shapes::bowl(2000), 200, [1.38e-4, 1.73e-5]),
        ("vase", shapes::vase(2000), 400, [4.73e-4, 4.35e-4]),
        ("sheet", shapes::height_field(1600), 300, [2.5e-4, 5.6e-4]),
        ("pants", shapes::pants(2000), 400, [6.7e-5, 9.05e-5]),
        (
            "torus with a hole",
            shapes::holed_torus(2000),
            300,
            [2.67e-4, 1.44e-4],
        ),
    ] {
        let surface = surface(&mesh, &[], points);
        let ([rms, at_boundary], turned) = measured(name, &mesh, &surface);
        assert!(
            rms < all && at_boundary < boundary,
            "{name}: {rms:e} {at_boundary:e}"
        );
        assert_eq!(turned, 0, "{name}");
    }
}

#[test]
fn the_least_budget_named_is_enough_and_one_less_is_not() {
    let cases = [
        (shapes::torus(1.0, 0.4, 900), vec![]),
        (shapes::genus(2, 2000), vec![]),
        (shapes::sphere(900), vec![0, 400]),
        (shapes::bowl(900), vec![]),
        (shapes::pants(1500), vec![]),
        (shapes::holed_torus(1200), vec![]),
    ];
    for (mesh, poles) in cases {
        let domain = cut(&mesh, &poles);
        let within = |points| fitted(domain.clone(), &mesh, Stop::ControlPoints(points));
        let Err(FitError::Budget { given: 1, least }) = within(1) else {
            panic!("one control point is too few")
        };
        let found = within(least).expect("the least budget");
        assert_eq!(found.report.unknowns, least);
        let given = least - 1;
        let error = within(given).expect_err("one less");
        assert_eq!(error, FitError::Budget { given, least });
        assert!(error.to_string().contains(&format!("at least {least}")));
    }
}

#[test]
fn a_tolerance_of_nothing_is_refused() {
    let mesh = shapes::bowl(600);
    let domain = cut(&mesh, &[]);
    for given in [0.0, -1.0, f64::INFINITY] {
        let found = fitted(domain.clone(), &mesh, Stop::Tolerance(given));
        assert_eq!(found.err(), Some(FitError::Tolerance { given }));
    }
}

#[test]
fn closed_holes_stay_open_in_triangles_and_in_files() {
    let mesh = shapes::holed_torus(1500);
    let given = surface(&mesh, &[], 250);
    let shown = given.tessellate(2).expect("triangles");
    let shown = TriangleMesh::build(shown.positions, shown.faces).expect("a mesh");
    let loops = shown.topology().boundary_loops();
    assert_eq!(loops.len(), 1);
    let own = mesh.topology().boundary_loops();
    assert_eq!(loops[0].len(), 2 * own[0].len());
    let parts = given.parts(&CapOptions::default());
    let own = given.domain().mesh().clone();
    let read = TSplineSurface::from_parts(own.clone(), &parts).expect("a surface");
    assert_eq!(read.tessellate(2), given.tessellate(2));
    let mut damaged = parts;
    damaged.outside.push(0);
    let error = TSplineSurface::from_parts(own, &damaged).expect_err("out of order");
    assert!(error.to_string().contains("faces outside"), "{error}");
}

/// Model, poles, control points, and bounds on the errors: a tenth above what was measured.
#[test]
fn open_models_are_met_at_their_boundaries() {
    let cases: [(&str, &[u32], usize, [f64; 2]); 5] = [
        ("bunny_35k_open", &[], 1300, [8.5e-4, 8.6e-4]),
        ("bunny_35k_open", &[12527, 14447], 1300, [8.4e-4, 9e-4]),
        ("maxplanck_8k7_open", &[], 800, [9.6e-4, 1.32e-3]),
        ("face_4k", &[], 800, [4.15e-4, 4.2e-4]),
        ("mushroom_open", &[], 500, [1.29e-4, 1.63e-4]),
    ];
    for (name, poles, points, [all, boundary]) in cases {
        if let Some(mesh) = library::model(name) {
            let surface = surface(&mesh, poles, points);
            let ([rms, at_boundary], turned) = measured(name, &mesh, &surface);
            assert!(
                rms < all && at_boundary < boundary,
                "{name}: {rms:e} {at_boundary:e}"
            );
            assert_eq!(turned, 0, "{name}");
        }
    }
}
