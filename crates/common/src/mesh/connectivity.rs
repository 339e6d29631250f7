//! What half-edges of triangles and of polygons have in common: pairing, fans and loops.

use super::topology::{NONE, TopologyError};

/// Returns the twin of every half-edge, [`NONE`] on the boundary.
///
/// `ends` are the two vertices of each half-edge in order, `face_of` its face.
pub(super) fn pair(
    ends: impl ExactSizeIterator<Item = [u32; 2]>,
    face_of: impl Fn(u32) -> u32,
) -> Result<Vec<u32>, TopologyError> {
    let mut twins = vec![NONE; ends.len()];
    // Sorting brings the half-edges of an edge together, the one from the smaller vertex first.
    let mut keys: Vec<(u32, u32, bool, u32)> = ends
        .enumerate()
        .map(|(h, [a, b])| (a.min(b), a.max(b), a > b, h as u32))
        .collect();
    keys.sort_unstable();
    for pair in keys.windows(2) {
        let (one, two) = (pair[0], pair[1]);
        if (one.0, one.1) != (two.0, two.1) {
            continue;
        }
        if one.2 == two.2 || twins[one.3 as usize] != NONE {
            let (from, to) = if two.2 {
                (two.1, two.0)
            } else {
                (two.0, two.1)
            };
            return Err(TopologyError::EdgeNotManifold {
                from,
                to,
                first: face_of(one.3),
                second: face_of(two.3),
            });
        }
        twins[one.3 as usize] = two.3;
        twins[two.3 as usize] = one.3;
    }
    Ok(twins)
}

/// Returns the edge of every half-edge, and the first half-edge of every edge.
pub(super) fn number_edges(twins: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let mut half_edge_edges = vec![NONE; twins.len()];
    let mut edge_half_edges = Vec::with_capacity(twins.len() / 2);
    for (half_edge, &twin) in twins.iter().enumerate() {
        if half_edge_edges[half_edge] == NONE {
            let edge = edge_half_edges.len() as u32;
            half_edge_edges[half_edge] = edge;
            if twin != NONE {
                half_edge_edges[twin as usize] = edge;
            }
            edge_half_edges.push(half_edge as u32);
        }
    }
    (half_edge_edges, edge_half_edges)
}

/// Returns an outgoing half-edge of every vertex, on the boundary the one whose twin is missing.
///
/// `around` turns an outgoing half-edge into the next one counter-clockwise, or [`NONE`].
pub(super) fn vertex_half_edges(
    vertex_count: usize,
    origins: impl Iterator<Item = u32>,
    twins: &[u32],
    around: impl Fn(u32) -> u32,
) -> Result<Vec<u32>, TopologyError> {
    let mut outgoing = vec![NONE; vertex_count];
    let mut degree = vec![0u32; vertex_count];
    for (half_edge, vertex) in origins.enumerate() {
        let vertex = vertex as usize;
        degree[vertex] += 1;
        if outgoing[vertex] == NONE || twins[half_edge] == NONE {
            outgoing[vertex] = half_edge as u32;
        }
    }
    for (vertex, &first) in outgoing.iter().enumerate() {
        let vertex_id = vertex as u32;
        if first == NONE {
            return Err(TopologyError::UnreferencedVertex { vertex: vertex_id });
        }
        if fan(first, &around).count() != degree[vertex] as usize {
            return Err(TopologyError::VertexNotManifold { vertex: vertex_id });
        }
    }
    Ok(outgoing)
}

/// Returns the half-edges from `first` on, turning with `around` until the fan ends or closes.
pub(super) fn fan(first: u32, around: impl Fn(u32) -> u32) -> impl Iterator<Item = u32> {
    let mut current = first;
    std::iter::from_fn(move || {
        if current == NONE {
            return None;
        }
        let here = current;
        let next = around(here);
        current = if next == first { NONE } else { next };
        Some(here)
    })
}

/// Returns the boundary loops, each as its half-edges head to tail; `after` is the boundary
/// half-edge that starts where one ends.
pub(super) fn boundary_loops(twins: &[u32], after: impl Fn(u32) -> u32) -> Vec<Vec<u32>> {
    let mut seen = vec![false; twins.len()];
    let mut loops = Vec::new();
    for start in (0..twins.len() as u32).filter(|&h| twins[h as usize] == NONE) {
        let mut cycle = Vec::new();
        let mut half_edge = start;
        while !seen[half_edge as usize] {
            seen[half_edge as usize] = true;
            cycle.push(half_edge);
            half_edge = after(half_edge);
        }
        if !cycle.is_empty() {
            loops.push(cycle);
        }
    }
    loops
}

/// Returns the component of each vertex, numbered by first vertex, and their number.
pub(super) fn components<I: Iterator<Item = u32>>(
    vertex_count: usize,
    neighbours: impl Fn(u32) -> I,
) -> (Vec<u32>, u32) {
    let mut labels = vec![NONE; vertex_count];
    let mut stack = Vec::new();
    let mut count = 0;
    for seed in 0..vertex_count as u32 {
        if labels[seed as usize] != NONE {
            continue;
        }
        labels[seed as usize] = count;
        stack.push(seed);
        while let Some(vertex) = stack.pop() {
            for other in neighbours(vertex) {
                if labels[other as usize] == NONE {
                    labels[other as usize] = count;
                    stack.push(other);
                }
            }
        }
        count += 1;
    }
    (labels, count)
}
