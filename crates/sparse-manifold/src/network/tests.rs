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

/// The edges of a cube, each a curve of its own.
fn cube() -> CurveNetwork {
    let corner = |i: u32| [i & 1, i >> 1 & 1, i >> 2].map(f64::from);
    let points: Vec<[f64; 3]> = (0..8).map(corner).collect();
    let edges: Vec<[u32; 2]> = (0..8)
        .flat_map(|i| [1, 2, 4].map(|bit| [i, i | bit]))
        .filter(|[a, b]| a != b)
        .collect();
    let edges: Vec<&[u32]> = edges.iter().map(<[u32; 2]>::as_slice).collect();
    network(&points, &edges)
}

fn refusal(points: &[[f64; 3]], curves: &[&[u32]]) -> String {
    let graph = CurveGraph::build(&network(points, curves));
    graph.expect_err("no graph").to_string()
}

#[test]
fn what_bounds_no_patch_is_refused_with_its_place_and_a_remedy() {
    let square = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
    ];
    let with = |more: &[[f64; 3]]| [square.as_slice(), more].concat();
    let all: &[u32] = &[0, 1, 2, 3, 0];
    for (points, curves, text) in [
        (
            with(&[[2.0, 0.5, 0.0]]),
            vec![all, &[1, 4]],
            "curve 1 ends at point 4 (2.000000, 0.500000, 0.000000), where no other curve passes; \
             join it to one there, or shorten it to its last junction",
        ),
        (
            with(&[[0.5, -1.0, 0.0], [0.5, 2.0, 0.0]]),
            vec![all, &[4, 5]],
            "curves 0 and 1 meet at (0.500000, 0.000000, 0.000000) without a common point; give \
             both a point of the same index there, or move one away",
        ),
        (
            square.to_vec(),
            vec![all, &[0, 1, 3]],
            "curves 0 and 1 run over each other at (0.500000, 0.000000, 0.000000); keep one of \
             them there",
        ),
        (
            with(&[[5.0, 0.0, 0.0], [6.0, 0.0, 0.0], [5.0, 1.0, 0.0]]),
            vec![all, &[0, 2], &[4, 5, 6, 4]],
            "closed curve 2 at (5.000000, 0.000000, 0.000000) meets no other curve, so that no \
             patch can lead to it; connect it with the rest, or take it out",
        ),
    ] {
        assert_eq!(refusal(&points, &curves), text);
    }
    let rays = 130;
    let mut points = vec![[0.0, 0.0, 1.0]];
    let mut rim = Vec::new();
    for i in 0..rays {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(rays);
        points.push([angle.cos(), angle.sin(), 0.0]);
        rim.push(i + 1);
    }
    rim.push(1);
    let spokes: Vec<[u32; 2]> = (1..=rays).map(|i| [0, i]).collect();
    let mut curves: Vec<&[u32]> = spokes.iter().map(<[u32; 2]>::as_slice).collect();
    curves.push(&rim);
    let text = refusal(&points, &curves);
    assert!(
        text.starts_with("130 arcs meet at point 0 (0.000000, 0.000000, 1.000000)"),
        "{text}"
    );
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
fn given_cycles_that_form_no_surface_are_refused() {
    let graph = CurveGraph::build(&cube()).expect("a cube");
    let refused = |cycles: &[&[u32]]| {
        let cycles = cycles.iter().map(|c| c.to_vec()).collect();
        let options = CycleOptions {
            cycles,
            ..CycleOptions::default()
        };
        let error = find_cycles(&graph, &options).expect_err("no surface");
        error.to_string()
    };
    let sides: [&[u32]; 6] = [
        &[0, 1, 3, 2],
        &[4, 5, 7, 6],
        &[0, 1, 5, 4],
        &[2, 3, 7, 6],
        &[0, 2, 6, 4],
        &[1, 3, 7, 5],
    ];
    let options = CycleOptions {
        cycles: sides.iter().map(|c| c.to_vec()).collect(),
        ..CycleOptions::default()
    };
    assert_eq!(
        find_cycles(&graph, &options).expect("a cube").report.euler,
        [2]
    );
    for (cycles, text) in [
        (
            vec![sides[0], &[0, 7, 1]],
            "given cycle 1 goes from point 0 to point 7, which no arc joins that way; give \
             junctions in order",
        ),
        (
            vec![&[9, 10][..]],
            "given cycle 0 has no junction; give the junctions around it, in order",
        ),
        (
            sides[..2].to_vec(),
            "the arc of curve 2 from (0.000000, 0.000000, 0.000000) to (0.000000, 0.000000, \
             1.000000) is in 0 of the given cycles; every arc bounds one or two",
        ),
        (
            [&sides[..], &sides[..1]].concat(),
            "the arc of curve 0 from (0.000000, 0.000000, 0.000000) to (1.000000, 0.000000, \
             0.000000) is in 3 of the given cycles; every arc bounds one or two",
        ),
    ] {
        assert_eq!(refused(&cycles), text);
    }
}

#[test]
fn holes_and_fillings_are_named_by_points() {
    let graph = CurveGraph::build(&cube()).expect("a cube");
    let with = |hole: Vec<Vec<u32>>, fill: Vec<Vec<u32>>| {
        let options = CycleOptions {
            hole,
            fill,
            ..CycleOptions::default()
        };
        find_cycles(&graph, &options)
    };
    let cycles = with(vec![vec![4, 7]], vec![vec![1, 2]]).expect("an open cube");
    assert_eq!((cycles.report.patches, cycles.report.holes), (5, 1));
    let domain = NetworkDomain::build(&graph, &cycles).expect("a domain");
    assert_eq!(domain.mesh.topology().boundary_loops().len(), 1);
    let error = with(vec![vec![0, 3]], vec![vec![1, 2]]).expect_err("both");
    assert_eq!(
        error.to_string(),
        "the cycle through points [0, 3] is given as `fill` and as `hole`; take one away"
    );
    let error = with(vec![vec![0, 1]], vec![]).expect_err("two cycles");
    assert_eq!(
        error.to_string(),
        "2 cycles pass through all the points [0, 1] given as `hole`; name points of exactly one"
    );
    let corners = |[a, b, c]: [u32; 3]| vec![a, b, c];
    let sides = [
        [0, 1, 3],
        [4, 5, 7],
        [0, 1, 5],
        [2, 3, 7],
        [0, 2, 6],
        [1, 3, 7],
    ];
    let cycles = with(sides.map(corners).to_vec(), vec![]).expect("holes only");
    let error = NetworkDomain::build(&graph, &cycles).expect_err("no patch");
    assert_eq!(
        error.to_string(),
        "all 6 cycles are holes, so that there is no surface; fill one of them"
    );
    // Two opposite sides are left, and the arcs between them bound nothing.
    let cycles = with(sides[..4].iter().map(|s| corners(*s)).collect(), vec![]);
    let domain = NetworkDomain::build(&graph, &cycles.expect("two sides")).expect("two sheets");
    assert_eq!(domain.unused_arcs.len(), 4);
}

#[test]
fn patches_that_touch_at_a_junction_only_are_refused() {
    // The top of a box of two by two quads, of which two opposite ones are holes.
    let known = smooth(&box_surface([2, 2, 2]), 2, 0.0, 0);
    let (graph, cycles) = search(&known, &CycleOptions::default());
    let centre = |v: &Junction| v.half_edges.len() == 4 && mates(&graph, v) == 4;
    let middle = graph
        .junctions()
        .iter()
        .find(|v| centre(v))
        .expect("four arcs");
    let mut around: Vec<usize> = (0..cycles.list.len())
        .filter(|&i| {
            let mut origins = cycles.list[i].half_edges.iter().map(|&h| graph.origin(h));
            origins.any(|v| graph.junctions()[v as usize].point == middle.point)
        })
        .collect();
    assert_eq!(around.len(), 4);
    let shared = |i: usize, j: usize| {
        let twins = |h: &u32| cycles.list[j].half_edges.contains(&(h ^ 1));
        cycles.list[i].half_edges.iter().any(twins)
    };
    let first = around.remove(0);
    let opposite = around
        .into_iter()
        .find(|&j| !shared(first, j))
        .expect("across");
    let mut holes = cycles.clone();
    holes.list[first].hole = true;
    holes.list[opposite].hole = true;
    let error = NetworkDomain::build(&graph, &holes).expect_err("two fans");
    let text = error.to_string();
    assert!(
        text.starts_with(&format!("the patches at point {} (", middle.point)),
        "{text}"
    );
    assert!(
        text.contains("fill one of the holes between them"),
        "{text}"
    );
}

fn mates(graph: &CurveGraph, junction: &Junction) -> usize {
    let mate = |h: &&u32| graph.mate(**h).is_some();
    junction.half_edges.iter().filter(mate).count()
}

#[test]
fn a_cycle_that_passes_a_junction_twice_is_no_disc() {
    let graph = CurveGraph::build(&cube()).expect("a cube");
    let mut cycles = find_cycles(&graph, &CycleOptions::default()).expect("cycles");
    let half_edges = [
        cycles.list[0].half_edges.clone(),
        cycles.list[1].half_edges.clone(),
    ];
    cycles.list[0].half_edges = half_edges.concat();
    let error = NetworkDomain::build(&graph, &cycles).expect_err("no disc");
    let text = error.to_string();
    assert!(
        text.starts_with("a cycle of 8 arcs passes point "),
        "{text}"
    );
    assert!(text.contains("give the cycles there by hand"), "{text}");
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
