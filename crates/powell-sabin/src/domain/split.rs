//! Where the Powell-Sabin split meets the edges.

use msplines_common::mesh::{NONE, Topology};

use crate::vector::{cross, norm};

/// Returns, by half-edge, the place of the split as a share of the way to its head.
///
/// Every face is split at its incentre. The line of two incentres crosses the common edge between
/// the two points where the incircles touch it, in the ratio of their radii, whether the edge is
/// Delaunay or not: no chart that holds both faces is needed. At the boundary it is the middle.
///
/// # Reference
/// [He2005] §3.1; [Dierckx1997]. Deviation: both leave the points of the split open.
pub(super) fn splits(topology: &Topology, vectors: &[[f64; 2]]) -> Vec<f64> {
    let mut splits = vec![0.5; vectors.len()];
    let lengths: Vec<f64> = vectors.iter().map(|&e| norm(e)).collect();
    // Tangents from both ends sum to the side, so that both shares keep their small digits.
    let touch = |h: u32| {
        let [own, next, previous] =
            [h, Topology::next(h), Topology::previous(h)].map(|side| lengths[side as usize]);
        let radius = cross(vectors[h as usize], vectors[Topology::next(h) as usize])
            / (own + next + previous);
        (
            radius,
            0.5 * (own + previous - next).max(0.0),
            0.5 * (own + next - previous).max(0.0),
        )
    };
    for edge in 0..topology.edge_count() as u32 {
        let h = topology.edge_half_edge(edge);
        let twin = topology.twin(h);
        if twin == NONE {
            continue;
        }
        let (own_radius, own_tail, own_head) = touch(h);
        // The twin runs the other way: its head is the tail here.
        let (other_radius, other_head, other_tail) = touch(twin);
        let to_tail = other_radius * own_tail + own_radius * other_tail;
        let to_head = other_radius * own_head + own_radius * other_head;
        splits[h as usize] = to_tail / (to_tail + to_head);
        splits[twin as usize] = to_head / (to_tail + to_head);
    }
    splits
}
