//! Networks whose patches are known.

use std::collections::BTreeSet;

use msplines_common::mesh::curves::{Curve, CurveNetwork};
use msplines_common::mesh::polygon::{PolygonMesh, Rules, Sharpness};
use msplines_common::mesh::shapes::{
    KnownNetwork, Opening, box_surface, dome_network, jittered, limit_network, mushroom_network,
    slab_with_holes, trapezohedron,
};
use nalgebra::Point3;

use super::*;

mod refusals;

/// Returns a cycle from its smallest point on.
fn from_smallest(mut cycle: Vec<u32>) -> Vec<u32> {
    let least = (0..cycle.len())
        .min_by_key(|&i| cycle[i])
        .unwrap_or_default();
    cycle.rotate_left(least);
    cycle
}

fn set(cycles: &[Vec<u32>]) -> BTreeSet<Vec<u32>> {
    cycles.iter().cloned().map(from_smallest).collect()
}

/// Returns the junctions of found patches, or of holes.
fn found(graph: &CurveGraph, cycles: &Cycles, hole: bool) -> BTreeSet<Vec<u32>> {
    let point = |&h: &u32| graph.junctions()[graph.origin(h) as usize].point;
    let around = |cycle: &Cycle| cycle.half_edges.iter().map(point).collect();
    let wanted = cycles.list.iter().filter(|cycle| cycle.hole == hole);
    set(&wanted.map(around).collect::<Vec<_>>())
}

fn search(known: &KnownNetwork, options: &CycleOptions) -> (CurveGraph, Cycles) {
    let graph = CurveGraph::build(&known.network).expect("a network");
    let cycles = find_cycles(&graph, options).expect("cycles");
    (graph, cycles)
}

fn is_right(known: &KnownNetwork, graph: &CurveGraph, cycles: &Cycles) -> bool {
    found(graph, cycles, false) == set(&known.patches)
        && found(graph, cycles, true) == set(&known.openings)
}

fn smooth(mesh: &PolygonMesh, levels: u32, removed: f64, seed: u64) -> KnownNetwork {
    let sharpness = Sharpness::smooth(mesh.topology(), Rules::default());
    limit_network(mesh, &sharpness, levels, removed, seed)
}

fn meshes() -> Vec<PolygonMesh> {
    let meshes = [
        box_surface([2, 2, 2]),
        box_surface([1, 2, 3]),
        trapezohedron(5),
        trapezohedron(8),
        slab_with_holes(1),
        slab_with_holes(2),
    ];
    let plain = meshes.iter().cloned();
    let moved = meshes
        .iter()
        .zip(1..)
        .map(|(mesh, seed)| jittered(mesh, 0.1, seed));
    plain.chain(moved).collect()
}

#[test]
fn patches_of_limit_curves_are_found_with_and_without_missing_arcs() {
    let mut wrong = Vec::new();
    for (index, mesh) in meshes().iter().enumerate() {
        for removed in [0.0, 0.15, 0.3] {
            for seed in 0..2 {
                let known = smooth(mesh, 3, removed, seed);
                let (graph, cycles) = search(&known, &CycleOptions::default());
                if !is_right(&known, &graph, &cycles) {
                    wrong.push((index, removed, seed, cycles.report));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} wrong: {wrong:#?}", wrong.len());
}

#[test]
fn sketches_are_found_with_their_openings() {
    for meridians in [9, 12] {
        for opening in [Opening::Open, Opening::Closed] {
            let known = mushroom_network(meridians, opening);
            let (graph, cycles) = search(&known, &CycleOptions::default());
            assert!(
                is_right(&known, &graph, &cycles),
                "{meridians} {opening:?} {:?}",
                cycles.report
            );
        }
    }
    let known = dome_network(4);
    let (graph, cycles) = search(&known, &CycleOptions::default());
    assert!(is_right(&known, &graph, &cycles), "{:?}", cycles.report);
    assert_eq!(cycles.report.euler, [1]);
}

fn network(points: &[[f64; 3]], curves: &[&[u32]]) -> CurveNetwork {
    let points = points.iter().map(|p| Point3::from(*p)).collect();
    let curves = curves.iter().map(|c| Curve::smooth(c.to_vec())).collect();
    CurveNetwork::build(points, curves).expect("curves")
}

#[test]
fn a_curve_may_cross_itself_and_says_so() {
    let points = [
        [0.0, 0.0, 0.0],
        [2.0, 2.0, 0.0],
        [2.0, 0.0, 0.0],
        [0.0, 2.0, 0.0],
    ];
    let graph = CurveGraph::build(&network(&points, &[&[0, 1, 2, 3, 0]])).expect("a graph");
    assert_eq!(
        graph.warnings(),
        ["curve 0 crosses itself without a point there; it is kept as it is"]
    );
}

#[test]
fn a_closed_curve_alone_bounds_one_patch() {
    let at = |i: u32| {
        let angle = 0.1 * f64::from(i) * std::f64::consts::TAU;
        [angle.cos(), angle.sin(), 0.0]
    };
    let points: Vec<[f64; 3]> = (0..10).map(at).collect();
    let circle = network(&points, &[&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 0]]);
    let graph = CurveGraph::build(&circle).expect("a graph");
    assert_eq!(graph.junctions().len(), 4);
    let cycles = find_cycles(&graph, &CycleOptions::default()).expect("cycles");
    assert_eq!(
        (cycles.report.patches, &cycles.report.euler[..]),
        (1, &[1][..])
    );
    let domain = NetworkDomain::build(&graph, &cycles).expect("a domain");
    assert_eq!(domain.mesh.face_count(), 1);
}

#[test]
fn arcs_between_the_same_junctions_and_back_to_one_become_simple_edges() {
    // Three half circles from pole to pole: two junctions, three patches of two arcs.
    let mut points = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let mut meridians = Vec::new();
    for m in 0..3 {
        let turn = std::f64::consts::TAU * f64::from(m) / 3.0;
        let mut meridian = vec![0];
        for i in 1..8 {
            let angle = std::f64::consts::PI * f64::from(i) / 8.0;
            let r = angle.sin();
            points.push([r * turn.cos(), r * turn.sin(), angle.cos()]);
            meridian.push(points.len() as u32 - 1);
        }
        meridian.push(1);
        meridians.push(meridian);
    }
    let curves: Vec<&[u32]> = meridians.iter().map(Vec::as_slice).collect();
    let graph = CurveGraph::build(&network(&points, &curves)).expect("a graph");
    let cycles = find_cycles(&graph, &CycleOptions::default()).expect("cycles");
    assert_eq!(cycles.report.patches, 3);
    assert_eq!(cycles.report.euler, [2]);
    let domain = NetworkDomain::build(&graph, &cycles).expect("a domain");
    assert_eq!(domain.mesh.topology().euler_characteristic(), 2);
    check_intervals(&graph, &domain);
}

/// Each arc is covered once, by intervals whose ends are where the vertices are.
fn check_intervals(graph: &CurveGraph, domain: &NetworkDomain) {
    let mut covered = vec![0.0; graph.arcs().len()];
    for (edge, curve) in domain.curves.iter().enumerate() {
        let Some(curve) = curve else { continue };
        let ends = domain.mesh.topology().edge_vertices(edge as u32);
        let shape = &graph.arcs()[curve.arc as usize].shape;
        for (vertex, length) in ends.into_iter().zip(curve.interval) {
            let position = domain.mesh.positions()[vertex as usize];
            assert!((shape.point(length) - position).norm() < 1e-9);
        }
        covered[curve.arc as usize] += (curve.interval[1] - curve.interval[0]).abs();
    }
    for (arc, covered) in graph.arcs().iter().zip(covered) {
        assert!((arc.shape.length() - covered).abs() < 1e-12 * (1.0 + covered));
    }
}

#[test]
fn quads_stay_and_other_patches_are_split() {
    for removed in [0.0, 0.3] {
        let known = smooth(&slab_with_holes(1), 3, removed, 0);
        let (graph, cycles) = search(&known, &CycleOptions::default());
        let domain = NetworkDomain::build(&graph, &cycles).expect("a domain");
        assert_eq!(domain.split, removed > 0.0);
        assert_eq!(domain.mesh.topology().euler_characteristic(), 0);
        let corners: usize = known.patches.iter().map(Vec::len).sum();
        let faces = if domain.split {
            corners
        } else {
            known.patches.len()
        };
        assert_eq!(domain.mesh.face_count(), faces);
        check_intervals(&graph, &domain);
    }
}

#[test]
fn cycles_given_by_hand_replace_the_search() {
    let known = smooth(&slab_with_holes(1), 2, 0.15, 3);
    // Each the other way round, as a user would not care.
    let turned = |(i, patch): (usize, &Vec<u32>)| {
        let mut patch = patch.clone();
        if i % 3 == 0 {
            patch.reverse();
        }
        patch
    };
    let options = CycleOptions {
        cycles: known.patches.iter().enumerate().map(turned).collect(),
        ..CycleOptions::default()
    };
    let (graph, cycles) = search(&known, &options);
    assert!(is_right(&known, &graph, &cycles));
    assert_eq!(cycles.report.restarts, 0);
}

#[test]
fn the_same_seed_gives_the_same_cycles_and_a_known_genus_ends_the_search() {
    let known = smooth(&jittered(&slab_with_holes(2), 0.1, 6), 3, 0.3, 1);
    let (_, once) = search(&known, &CycleOptions::default());
    let (_, again) = search(&known, &CycleOptions::default());
    assert_eq!((once.list, once.report), (again.list, again.report));
    let options = CycleOptions {
        expected_euler: Some(-2),
        ..CycleOptions::default()
    };
    assert_eq!(search(&known, &options).1.report.restarts, 1);
    let noise = f64::NAN;
    let options = CycleOptions {
        noise,
        ..CycleOptions::default()
    };
    let graph = CurveGraph::build(&known.network).expect("a graph");
    let error = find_cycles(&graph, &options).expect_err("noise");
    assert_eq!(
        error.to_string(),
        "a noise of NaN makes no sense; give a number from 0 to 1"
    );
}

#[test]
fn closed_surfaces_come_out_with_their_patches_outwards() {
    for scale in [1.0, -1.0] {
        // A reflection turns inside out what was outside.
        let mesh = box_surface([2, 1, 1]);
        let mirrored = mesh
            .positions()
            .iter()
            .map(|p| Point3::new(scale * p.x, p.y, p.z));
        let mesh = mesh.with_positions(mirrored.collect());
        let known = smooth(&mesh, 3, 0.0, 0);
        let (graph, cycles) = search(&known, &CycleOptions::default());
        let outwards = is_right(&known, &graph, &cycles);
        assert_eq!(outwards, scale > 0.0);
        assert_eq!(cycles.report.patches, 10);
    }
}
