//! Vertices far from others.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use msplines_common::mesh::TriangleMesh;

/// Returns the vertex of a surface whose star can be removed beside those of others, and that is farthest along
/// edges from these and from the boundary that is left once some holes are closed; nothing if there is none.
/// O(n log n).
pub(super) fn farthest_vertex(
    closed: &TriangleMesh,
    surface: &TriangleMesh,
    others: &[u32],
) -> Option<u32> {
    let (topology, own) = (closed.topology(), surface.topology());
    let is_taken = |at: u32| {
        let is_beside = |&other: &u32| other == at || own.neighbours(other).any(|v| v == at);
        own.is_boundary_vertex(at) || others.iter().any(is_beside)
    };
    let is_free = |v: u32| !is_taken(v) && !own.neighbours(v).any(is_taken);
    let vertices = 0..surface.vertex_count() as u32;
    let rims = vertices.clone().filter(|&v| topology.is_boundary_vertex(v));
    let mut from: Vec<u32> = rims.chain(others.iter().copied()).collect();
    if from.is_empty() {
        // The end of a longest path, as in a tree.
        from.extend(farthest(&distances(closed, &[0]), vertices.clone()));
    }
    farthest(&distances(closed, &from), vertices.filter(|&v| is_free(v)))
}

/// Returns the first of the farthest vertices.
fn farthest(distances: &[f64], among: impl Iterator<Item = u32>) -> Option<u32> {
    let mut best: Option<(f64, u32)> = None;
    for vertex in among {
        let distance = distances[vertex as usize];
        if distance.is_finite() && best.is_none_or(|(most, _)| distance > most) {
            best = Some((distance, vertex));
        }
    }
    best.map(|(_, vertex)| vertex)
}

/// Returns the length of the shortest path of edges from some vertices to each. O(n log n).
fn distances(mesh: &TriangleMesh, from: &[u32]) -> Vec<f64> {
    let mut distances = vec![f64::INFINITY; mesh.vertex_count()];
    from.iter().for_each(|&v| distances[v as usize] = 0.0);
    // Bits of numbers that are not negative are in their order.
    let start = from.iter().map(|&v| Reverse((0, v)));
    let mut queue: BinaryHeap<Reverse<(u64, u32)>> = start.collect();
    while let Some(Reverse((bits, vertex))) = queue.pop() {
        let here = f64::from_bits(bits);
        if here > distances[vertex as usize] {
            continue;
        }
        for next in mesh.topology().neighbours(vertex) {
            let [a, b] = [vertex, next].map(|v| mesh.positions()[v as usize]);
            let there = here + (b - a).norm();
            if there < distances[next as usize] {
                distances[next as usize] = there;
                queue.push(Reverse((there.to_bits(), next)));
            }
        }
    }
    distances
}
