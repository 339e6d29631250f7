//! What is refused, and what given holes and fillings do.

use super::*;

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
