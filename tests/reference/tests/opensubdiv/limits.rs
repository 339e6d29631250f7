//! Limits and normals where the masks of both are exact.

use std::collections::BTreeMap;

use msplines_common::mesh::polygon::{Refined, Rules, limit_stencils, limit_tangent_stencils};
use msplines_reference::Library;
use msplines_reference::polygon::Limits;
use msplines_reference::record::Comparison;
use nalgebra::{Point3, Vector3};

use crate::cases::{ROUNDING, Tags, cases};

/// What a vertex is in the limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Smooth,
    Dart,
    Crease,
    Corner,
    /// Sharpness is still falling.
    Unsettled,
}

fn kind(mesh: &Refined, vertex: u32) -> Kind {
    let topology = &mesh.topology;
    let edges = topology.spokes(vertex).map(|h| topology.edge(h));
    let edges: Vec<f64> = edges.map(|e| mesh.sharpness.edge(e)).collect();
    let own = mesh.sharpness.vertex(vertex);
    let falls = |s: f64| s > 0.0 && s.is_finite();
    let sharp = edges.iter().filter(|&&s| s > 0.0).count();
    match sharp {
        _ if falls(own) || edges.iter().any(|&s| falls(s)) => Kind::Unsettled,
        _ if own > 0.0 => Kind::Corner,
        0 => Kind::Smooth,
        1 => Kind::Dart,
        2 => Kind::Crease,
        _ => Kind::Corner,
    }
}

#[test]
fn limit_positions_agree() {
    let mut comparison = Comparison::new(
        "limits of smooth vertices creases and corners",
        Library::OpenSubdiv,
        ROUNDING,
        "in diagonals: another order of sums",
    );
    let mut counts: BTreeMap<Kind, usize> = BTreeMap::new();
    for case in [Tags::None, Tags::Chains].into_iter().flat_map(cases) {
        let last = case.last();
        let limits = limit_stencils(&last, case.rules);
        let points = case.ours.last().expect("a level");
        let behind = case.apart.last().expect("a level");
        for vertex in 0..last.topology.vertex_count() as u32 {
            let row = vertex as usize;
            let kind = kind(&last, vertex);
            let apart = limits.row(row).0.iter().any(|&c| behind[c as usize]);
            if apart || matches!(kind, Kind::Dart | Kind::Unsettled) {
                continue;
            }
            let gap = limits.point(row, points) - case.limits.positions[row];
            comparison.add(&case.name, [gap.norm() / case.mesh.diagonal()]);
            *counts.entry(kind).or_default() += 1;
        }
    }
    println!("{counts:?}");
    assert_eq!(counts.len(), 3, "all kinds are compared");
    comparison.finish();
}

/// Returns the number of faces from the edge of an outgoing half-edge to the next sharp one.
fn sector(mesh: &Refined, half_edge: u32) -> usize {
    let topology = &mesh.topology;
    let vertex = topology.origin(half_edge);
    let spokes: Vec<u32> = topology.spokes(vertex).collect();
    let first = spokes.iter().position(|&h| h == half_edge);
    let first = first.expect("it leaves");
    let sharp = |i: usize| {
        mesh.sharpness
            .edge(topology.edge(spokes[(first + i) % spokes.len()]))
    };
    let next = (1..=spokes.len()).find(|&i| sharp(i) > 0.0);
    next.unwrap_or(1)
}

/// Returns OpenSubdiv's normal at a vertex, and the half-edge from which on its faces have it.
fn their_normal(mesh: &Refined, limits: &Limits, vertex: u32) -> (u32, Vector3<f64>) {
    let [first, second] = limits.tangents[vertex as usize];
    let lead = match kind(mesh, vertex) {
        Kind::Crease => limits.sharp_neighbours[vertex as usize],
        _ => limits.first_neighbours[vertex as usize],
    };
    let mut outgoing = mesh.topology.outgoing(vertex);
    let half_edge = outgoing.find(|&h| mesh.topology.target(h) == lead);
    let half_edge = half_edge.expect("its first edge has a face on its left");
    (half_edge, first.cross(&second).normalize())
}

pub(super) fn our_normals(
    mesh: &Refined,
    half_edges: &[u32],
    rules: Rules,
    points: &[Point3<f64>],
) -> Vec<Vector3<f64>> {
    let tangents = limit_tangent_stencils(mesh, half_edges, rules).apply(points);
    let (pairs, _) = tangents.as_chunks::<2>();
    let normal = |[a, b]: &[Point3<f64>; 2]| a.coords.cross(&b.coords).normalize();
    pairs.iter().map(normal).collect()
}

#[test]
fn normals_agree_where_both_masks_are_exact() {
    let mut comparison = Comparison::new(
        "normals of smooth vertices regular creases and corners",
        Library::OpenSubdiv,
        1e-11,
        "of unit vectors: differences of points close to each other",
    );
    let mut counts: BTreeMap<Kind, usize> = BTreeMap::new();
    for case in [Tags::None, Tags::Chains].into_iter().flat_map(cases) {
        let last = case.last();
        let points = case.ours.last().expect("a level");
        let behind = case.apart.last().expect("a level");
        let mut theirs = Vec::new();
        for vertex in 0..last.topology.vertex_count() as u32 {
            let kind = kind(&last, vertex);
            let apart = last.topology.outgoing(vertex).any(|h| {
                let face = last.topology.face_vertices(last.topology.face(h));
                face.iter().any(|&v| behind[v as usize])
            });
            if apart || matches!(kind, Kind::Dart | Kind::Unsettled) {
                continue;
            }
            let (half_edge, normal) = their_normal(&last, &case.limits, vertex);
            let edge = last.topology.edge(half_edge);
            let faces = sector(&last, half_edge);
            let smooth = kind == Kind::Smooth;
            // A corner without sharp edges has a normal in each of its faces.
            let lone = kind == Kind::Corner
                && last
                    .topology
                    .spokes(vertex)
                    .all(|h| last.sharpness.edge(last.topology.edge(h)) == 0.0);
            let regular = faces == 1 || (faces == 2 && kind == Kind::Crease);
            let fits = regular && last.sharpness.edge(edge) > 0.0;
            if smooth || lone || fits {
                theirs.push((half_edge, normal));
                *counts.entry(kind).or_default() += 1;
            }
        }
        let half_edges: Vec<u32> = theirs.iter().map(|n| n.0).collect();
        let ours = our_normals(&last, &half_edges, case.rules, points);
        let pairs = ours.iter().zip(&theirs);
        comparison.add(&case.name, pairs.map(|(a, (_, b))| (a - b).norm()));
    }
    println!("{counts:?}");
    assert_eq!(counts.len(), 3, "all kinds are compared");
    comparison.finish();
}
