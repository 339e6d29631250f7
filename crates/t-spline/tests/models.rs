//! Domains of surfaces of the library of models.
#![allow(clippy::print_stdout, reason = "the figures of every model are shown")]

#[path = "../../../tests/library.rs"]
mod library;

use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::unobserved;
use msplines_t_spline::domain::{Domain, DomainOptions};

/// Closed models of genus >= 1, and the number of cylinders before any is collapsed: `3g - 3`.
const CLOSED: [(&str, usize); 6] = [
    ("kitten_40k", 1),
    ("rocker_arm_50k", 1),
    ("fertility_30k", 9),
    ("double_torus_2k", 3),
    ("happy_buddha_25k", 15),
    ("heptoroid_22k", 63),
];

/// Rounding of sums over thousands of faces, relative.
const ROUNDING: f64 = 1e-12;

fn cut(name: &str, mesh: &TriangleMesh, poles: Vec<u32>) -> Domain {
    let options = DomainOptions {
        poles,
        ..DomainOptions::default()
    };
    let domain = Domain::of_surface(mesh, &options, &mut unobserved()).expect("a domain");
    let report = *domain.report();
    println!("{name}: {report:?}");
    assert!(report.closure < ROUNDING && report.area_defect.abs() < ROUNDING);
    assert_eq!(
        domain.complex().cylinders().len() + report.collapsed,
        report.cylinders
    );
    domain
}

#[test]
fn closed_models_are_cut_into_cylinders() {
    for (name, cylinders) in CLOSED {
        if let Some(mesh) = library::model(name) {
            let domain = cut(name, &mesh, Vec::new());
            assert_eq!(domain.report().cylinders, cylinders);
        }
    }
}

/// The vertices farthest up and down along directions.
fn farthest(mesh: &TriangleMesh, directions: &[[f64; 3]]) -> Vec<u32> {
    let farthest = |axis: &[f64; 3]| {
        let height = |v: &u32| {
            let p = mesh.positions()[*v as usize];
            p.x * axis[0] + p.y * axis[1] + p.z * axis[2]
        };
        let vertices = 0..mesh.vertex_count() as u32;
        vertices
            .max_by(|a, b| height(a).total_cmp(&height(b)))
            .unwrap_or(0)
    };
    directions.iter().map(farthest).collect()
}

#[test]
fn poles_and_boundaries_end_cylinders() {
    let up_and_down = [[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]];
    if let Some(mesh) = library::model("nefertiti_50k") {
        let poles = farthest(&mesh, &up_and_down);
        let domain = cut("nefertiti_50k, two poles", &mesh, poles);
        assert_eq!(domain.report().cylinders, 1);
    }
    if let Some(mesh) = library::model("bunny_30k") {
        let axes = [[0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]];
        let domain = cut("bunny_30k, three poles", &mesh, farthest(&mesh, &axes));
        assert_eq!(domain.report().cylinders, 3);
    }
    if let Some(mesh) = library::model("maxplanck_8k7_open") {
        let poles = farthest(&mesh, &up_and_down[..1]);
        let domain = cut("maxplanck_8k7_open, a pole", &mesh, poles);
        assert_eq!(domain.report().cylinders, 1);
    }
    if let Some(mesh) = library::model("bunny_35k_open") {
        let domain = cut("bunny_35k_open", &mesh, Vec::new());
        // All holes are small beside the surface, so that poles are needed.
        let report = domain.report();
        assert_eq!((report.closed_holes, report.cylinders), (5, 1));
    }
}
