//! Cylinders of surfaces with boundary.

use msplines_common::mesh::{TriangleMesh, shapes};
use msplines_common::progress::unobserved;
use msplines_conformal::bounded::puncture;

use crate::domain::{Domain, DomainOptions, End};

use super::surfaces::check;

fn cut(mesh: &TriangleMesh, poles: &[u32], hole: f64) -> Domain {
    let mut options = DomainOptions {
        poles: poles.to_vec(),
        ..DomainOptions::default()
    };
    options.snap.hole = hole;
    let domain = Domain::of_surface(mesh, &options, &mut unobserved()).expect("a domain");
    check(&domain);
    domain
}

/// Boundary loops, poles, closed holes, zeros, cylinders.
fn counts(domain: &Domain) -> [usize; 5] {
    let is_pole = |end: &&End| matches!(end, End::Pole(_));
    let poles = domain.ends().iter().filter(is_pole).count();
    let report = domain.report();
    let cylinders = domain.complex().cylinders().len();
    [
        domain.ends().len() - poles,
        poles,
        report.closed_holes,
        report.zeros as usize,
        cylinders,
    ]
}

/// A bumpy sphere without the stars of some vertices.
fn with_small_holes(vertices: &[u32]) -> TriangleMesh {
    let whole = shapes::bumpy_sphere(2562);
    puncture(&whole, vertices).expect("stars apart").0
}

#[test]
fn a_disk_gets_a_pole_far_from_its_boundary() {
    let mesh = shapes::bowl(1500);
    let domain = cut(&mesh, &[], 0.5);
    assert_eq!(counts(&domain), [1, 1, 0, 0, 1]);
    let [pole] = domain.poles()[..] else {
        panic!("one pole")
    };
    // The lowest point, but for the detours of edges.
    assert!(mesh.positions()[pole.vertex as usize].z < -0.9);
    let own = &domain.complex().cylinders()[0];
    // All boundary vertices lie exactly at the end of the cylinder, and those only.
    let boundary = domain.boundary_vertices();
    let is_rim = |&v: &u32| {
        let origin = domain.origins()[v as usize];
        origin.is_some_and(|v| mesh.topology().is_boundary_vertex(v))
    };
    assert!(boundary.iter().all(is_rim));
    for &vertex in &boundary {
        let at = domain.vertex(vertex);
        assert!(at.y == 0.0 || at.y == own.height as f64);
        assert!(domain.complex().is_on_boundary(at));
    }
    let inner = domain.vertex(pole.vertex + 60);
    assert!(!domain.complex().is_on_boundary(inner));
}

#[test]
fn long_loops_are_ends_of_cylinders_that_are_not_thin() {
    for (mesh, expected) in [
        (shapes::cylinder(900), [2, 0, 0, 0, 1]),
        (shapes::pants(2000), [3, 0, 0, 1, 3]),
    ] {
        let domain = cut(&mesh, &[], 0.5);
        assert_eq!(counts(&domain), expected);
        assert_eq!(domain.report().thin, 0);
        assert!(domain.outside().is_empty());
    }
}

#[test]
fn handles_alone_close_their_hole_and_run_across() {
    let mesh = shapes::holed_torus(1500);
    let domain = cut(&mesh, &[], 0.1);
    assert_eq!(counts(&domain), [0, 0, 1, 0, 1]);
}

#[test]
fn faces_of_closed_holes_are_no_part_of_the_surface() {
    let mesh = with_small_holes(&[100, 900, 2000]);
    let domain = cut(&mesh, &[], 0.5);
    // Two poles, as on a closed sphere.
    assert_eq!(counts(&domain), [0, 2, 3, 0, 1]);
    let rims: Vec<u32> = (mesh.topology().boundary_loops().concat().iter())
        .map(|&h| mesh.topology().origin(h))
        .collect();
    assert_eq!(domain.outside().len(), rims.len());
    let name = |&v: &u32| domain.origins()[v as usize];
    let found: Vec<u32> = domain.boundary_vertices().iter().filter_map(name).collect();
    assert_eq!(found.len(), rims.len());
    assert!(rims.iter().all(|v| found.contains(v)));
    // Only the centres of the holes are not on the surface, and they have no name.
    let own = domain.vertices_on_surface();
    assert_eq!(own.iter().filter(|own| !**own).count(), 3);
    let names = domain.origins().iter().zip(&own);
    assert!(names.into_iter().all(|(name, own)| name.is_some() == *own));
}

#[test]
fn poles_beside_small_holes_are_ends() {
    let mesh = with_small_holes(&[100, 900]);
    let poles = [400, 1500, 2300];
    let domain = cut(&mesh, &poles, 0.5);
    assert_eq!(counts(&domain)[..4], [0, 3, 2, 1]);
    assert!(
        poles
            .iter()
            .all(|&pole| domain.ends().contains(&End::Pole(pole)))
    );
}
