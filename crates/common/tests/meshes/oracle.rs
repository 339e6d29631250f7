//! What a mesh is, told again in the plainest words, and what its tables must say of it.

use std::collections::{BTreeMap, BTreeSet};

use msplines_common::mesh::{NONE, Topology};

/// A directed edge and the face it runs in.
fn directed(faces: &[[u32; 3]]) -> impl Iterator<Item = ([u32; 2], usize)> + '_ {
    let sides =
        |(face, &[a, b, c]): (usize, &[u32; 3])| [[a, b], [b, c], [c, a]].map(|s| (s, face));
    faces.iter().enumerate().flat_map(sides)
}

/// Returns whether triangles are an oriented manifold that uses all vertices.
pub(crate) fn is_manifold(vertices: usize, faces: &[[u32; 3]]) -> bool {
    let corners_fit = faces.iter().all(|&[a, b, c]| {
        a != b && b != c && c != a && [a, b, c].iter().all(|&v| (v as usize) < vertices)
    });
    let sides: BTreeSet<[u32; 2]> = directed(faces).map(|(side, _)| side).collect();
    let once = sides.len() == 3 * faces.len();
    corners_fit && once && (0..vertices as u32).all(|vertex| has_one_fan(vertex, faces))
}

/// Whether the faces around a vertex hang together along the edges at that vertex, and there are some.
fn has_one_fan(vertex: u32, faces: &[[u32; 3]]) -> bool {
    // A face joins the two other corners it has; the fan is one if these joints are connected.
    let joints: Vec<[u32; 2]> = faces
        .iter()
        .filter_map(|&[a, b, c]| match vertex {
            v if v == a => Some([b, c]),
            v if v == b => Some([c, a]),
            v if v == c => Some([a, b]),
            _ => None,
        })
        .collect();
    let Some(first) = joints.first() else {
        return false;
    };
    let mut reached = BTreeSet::from(*first);
    while let Some([a, b]) = joints
        .iter()
        .find(|[a, b]| reached.contains(a) != reached.contains(b))
    {
        reached.extend([a, b]);
    }
    joints.iter().all(|[a, _]| reached.contains(a))
}

/// Compares all tables of a topology with what its faces say.
pub(crate) fn check(topology: &Topology) {
    topology.sanity_check();
    let faces = topology.faces();
    let sides: BTreeMap<[u32; 2], u32> = directed(faces).map(|(s, _)| s).zip(0..).collect();
    for (&[a, b], &half_edge) in &sides {
        let twin = sides.get(&[b, a]).copied().unwrap_or(NONE);
        assert_eq!(topology.twin(half_edge), twin, "twin of ({a}, {b})");
    }
    let edges: BTreeSet<[u32; 2]> = sides.keys().map(|&[a, b]| [a.min(b), a.max(b)]).collect();
    assert_eq!(topology.edge_count(), edges.len());
    let euler = topology.vertex_count() as i64 - edges.len() as i64 + faces.len() as i64;
    assert_eq!(topology.euler_characteristic(), euler);
    check_loops(topology, &sides);
}

/// Boundary loops are closed, pass no vertex twice, and hold every side without a twin once.
fn check_loops(topology: &Topology, sides: &BTreeMap<[u32; 2], u32>) {
    let open = sides
        .iter()
        .filter(|([a, b], _)| !sides.contains_key(&[*b, *a]));
    let open: BTreeSet<u32> = open.map(|(_, &half_edge)| half_edge).collect();
    let mut met = BTreeSet::new();
    for cycle in topology.boundary_loops() {
        let starts: BTreeSet<u32> = cycle.iter().map(|&h| topology.origin(h)).collect();
        assert_eq!(starts.len(), cycle.len(), "a loop passes a vertex twice");
        for (i, &half_edge) in cycle.iter().enumerate() {
            let next = cycle[(i + 1) % cycle.len()];
            assert_eq!(topology.target(half_edge), topology.origin(next));
            assert!(met.insert(half_edge), "a side lies on two loops");
        }
    }
    assert_eq!(met, open);
}

/// What no edit may change: Euler characteristic, number of boundary loops, number of components.
pub(crate) fn kind(topology: &Topology) -> (i64, usize, u32) {
    let loops = topology.boundary_loops().len();
    (
        topology.euler_characteristic(),
        loops,
        topology.components().1,
    )
}
