//! Curve networks from files to quads, where the files are at hand.
#![allow(clippy::print_stdout, reason = "tests say when they did not run")]

use std::path::PathBuf;

use msplines_common::mesh::curves::CurveNetwork;
use msplines_common::progress::{Outcome, unobserved};
use msplines_io::read_curves;
use msplines_sparse_manifold::network::{
    CurveGraph, CycleOptions, Cycles, NetworkDomain, NetworkOptions, NetworkReport, SurfaceMethod,
    find_cycles, surface_network,
};

/// Returns a network of the library of models, if it is there.
fn network(name: &str) -> Option<CurveNetwork> {
    let here = concat!(env!("CARGO_MANIFEST_DIR"), "/../data/models");
    let root = std::env::var_os("MSPLINES_MODELS").map_or_else(|| here.into(), PathBuf::from);
    let path = root.join("curves").join(name).with_extension("curves");
    if !path.is_file() {
        println!("not run: {name}");
        return None;
    }
    Some(read_curves(&path).expect("a network of the library"))
}

fn cycles(network: &CurveNetwork) -> (CurveGraph, Cycles) {
    let graph = CurveGraph::build(network).expect("a graph");
    let cycles = find_cycles(&graph, &CycleOptions::default()).expect("cycles");
    (graph, cycles)
}

#[test]
fn a_closed_network_of_genus_zero_is_found_without_help() {
    let Some(network) = network("righthanded") else {
        return;
    };
    let (graph, cycles) = cycles(&network);
    let report = &cycles.report;
    assert_eq!((report.patches, report.holes), (434, 0), "{report:?}");
    assert_eq!(report.euler, [2]);
    let domain = NetworkDomain::build(&graph, &cycles).expect("a domain");
    assert!(!domain.split);
    assert_eq!(domain.mesh.face_count(), 434);
    assert!(domain.curves.iter().all(Option::is_some));
}

#[test]
fn a_closed_network_of_genus_six_is_found_without_help() {
    let Some(network) = network("car_body") else {
        return;
    };
    let (graph, cycles) = cycles(&network);
    let report = &cycles.report;
    assert_eq!((report.patches, report.holes), (680, 0), "{report:?}");
    assert_eq!(report.euler, [-10]);
    let domain = NetworkDomain::build(&graph, &cycles).expect("a domain");
    assert!(!domain.split);
    assert_eq!(domain.mesh.topology().euler_characteristic(), -10);
    let creases = domain.curves.iter().flatten().filter(|c| c.crease);
    assert_eq!(creases.count(), 234);
}

#[test]
fn an_open_network_is_found_with_its_opening() {
    let Some(network) = network("helmet") else {
        return;
    };
    let (graph, cycles) = cycles(&network);
    let report = &cycles.report;
    assert_eq!((report.patches, report.holes), (58, 1), "{report:?}");
    let hole = cycles.list.iter().find(|cycle| cycle.hole).expect("a hole");
    assert_eq!(hole.half_edges.len(), 22);
    let domain = NetworkDomain::build(&graph, &cycles).expect("a domain");
    assert!(domain.split, "its corners are triangles");
    assert_eq!(domain.mesh.face_count(), 54 * 4 + 4 * 3);
    assert_eq!(domain.mesh.topology().boundary_loops().len(), 1);
}

fn surface(network: &CurveNetwork) -> NetworkReport {
    let options = NetworkOptions::default();
    let fit = surface_network(network, &options, &mut unobserved()).expect("a surface");
    assert_eq!(fit.report.outcome, Outcome::Converged);
    fit.report
}

#[test]
fn a_closed_network_gets_a_smooth_surface() {
    let Some(network) = network("righthanded") else {
        return;
    };
    let report = surface(&network);
    assert_eq!(
        (report.charts, report.method),
        (436, SurfaceMethod::OneStep)
    );
    // Found: 5.0e-4.
    assert!(report.curve_rms <= 8e-4, "{report:?}");
    assert!(report.sharp_facets < 80, "{report:?}");
    assert!(
        !report.cone_points.is_empty(),
        "it has corners without creases"
    );
    assert!(report.kink_max_degrees < 1e-3, "{report:?}");
}

#[test]
fn a_network_with_creases_has_them_where_they_are_marked_only() {
    let Some(network) = network("car_body") else {
        return;
    };
    let report = surface(&network);
    assert_eq!(
        (report.charts, report.method),
        (670, SurfaceMethod::OneStep)
    );
    assert!(report.c0_atoms_crease > 5.0 && report.c0_atoms_smooth == 0.0);
    // Found: 6.1e-4.
    assert!(report.curve_rms <= 8e-4, "{report:?}");
    assert!(report.kink_max_degrees < 1e-2, "{report:?}");
}

#[test]
fn an_open_network_is_followed_closely() {
    let Some(network) = network("helmet") else {
        return;
    };
    let report = surface(&network);
    assert_eq!(
        (report.charts, report.method),
        (251, SurfaceMethod::TwoStep)
    );
    // Found: 4.4e-4.
    assert!(report.curve_rms <= 8e-4, "{report:?}");
}
