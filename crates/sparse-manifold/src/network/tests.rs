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

#[test]
fn tmp_rates() {
    for levels in [3u32, 1, 0] {
    for restarts in [1u32, 4, 16] {
        for removed in [0.0, 0.15, 0.3] {
            let (mut right, mut all, mut beaten, mut missed) = (0, 0, 0, 0);
            let t = std::time::Instant::now();
            for mesh in &meshes() {
                for seed in 0..5 {
                    let known = smooth(mesh, levels, removed, seed);
                    let options = CycleOptions { restarts, ..Default::default() };
                    let (graph, cycles) = search(&known, &options);
                    all += 1;
                    if is_right(&known, &graph, &cycles) { right += 1; } else {
                        let truth = super::cycles::truth_energy(&graph, &known.patches);
                        let truth = truth.unwrap_or(f64::NAN);
                        if cycles.report.energy < truth - 1e-9 { beaten += 1 } else { missed += 1 }
                    }
                }
            }
            println!("levels {levels} restarts {restarts} removed {removed}: {right}/{all} beaten {beaten} missed {missed} {:?}", t.elapsed());
        }
    }
    }
}


#[test]
fn tmp_models() {
    for name in ["righthanded", "car_body", "helmet"] {
        let text = std::fs::read_to_string(format!("/work/shared/models/curves/{name}.curves")).unwrap();
        let mut points = Vec::new();
        let mut curves: Vec<Curve> = Vec::new();
        for line in text.lines() {
            let w: Vec<&str> = line.split_whitespace().collect();
            match w[0] {
                "v" => points.push(Point3::new(w[1].parse().unwrap(), w[2].parse().unwrap(), w[3].parse().unwrap())),
                "c" => curves.push(Curve::smooth(w[1..].iter().map(|x| x.parse::<u32>().unwrap() - 1).collect())),
                "k" => curves.last_mut().unwrap().creases = w[1..].iter().map(|x| *x == "1").collect(),
                _ => {}
            }
        }
        let network = CurveNetwork::build(points, curves).unwrap();
        let t = std::time::Instant::now();
        let graph = CurveGraph::build(&network).unwrap();
        println!("model {name} graph {:?} junctions {} arcs {}", t.elapsed(), graph.junctions().len(), graph.arcs().len());
        if name == "car_body" {
            let text = std::fs::read_to_string("/work/shared/models/quad/car_body.obj").unwrap();
            let mut ps: Vec<Point3<f64>> = Vec::new(); let mut fs: Vec<Vec<u32>> = Vec::new();
            for line in text.lines() { let w: Vec<&str> = line.split_whitespace().collect();
                if w.is_empty() { continue; }
                if w[0] == "v" { ps.push(Point3::new(w[1].parse().unwrap(), w[2].parse().unwrap(), w[3].parse().unwrap())); }
                if w[0] == "f" { fs.push(w[1..].iter().map(|x| x.split('/').next().unwrap().parse::<usize>().unwrap() - 1).map(|i| {
                    (0..network.points().len()).min_by(|&a, &b| (network.points()[a]-ps[i]).norm().total_cmp(&(network.points()[b]-ps[i]).norm())).unwrap() as u32 }).collect()); }
            }
            println!("model truth {:?}", super::cycles::truth_energy(&graph, &fs));
            let cycles = find_cycles(&graph, &CycleOptions::default()).unwrap();
            let f = found(&graph, &cycles, false);
            let k = set(&fs);
            let m: BTreeSet<Vec<u32>> = k.iter().map(|c| { let mut c = c.clone(); c.reverse(); from_smallest(c) }).collect();
            let k = if f.intersection(&m).count() > f.intersection(&k).count() { m } else { k };
            for c in f.difference(&k) { println!("model found {c:?}"); }
            for c in k.difference(&f) { println!("model true {c:?}"); }
        }
        for restarts in [1, 2, 4, 8, 16, 64] {
            let t = std::time::Instant::now();
            let cycles = find_cycles(&graph, &CycleOptions { restarts, ..Default::default() }).unwrap();
            println!("model {name} restarts {restarts} {:?} {:?}", t.elapsed(), cycles.report);
            if restarts == 16 {
                let t = std::time::Instant::now();
                let d = NetworkDomain::build(&graph, &cycles);
                match d { Ok(d) => println!("model domain {:?} faces {} split {} chi {}", t.elapsed(), d.mesh.face_count(), d.split, d.mesh.topology().euler_characteristic()), Err(e) => println!("model {e}") }
            }
        }
    }
}
