//! Integer closed forms between boundary loops.

use std::collections::VecDeque;

use msplines_common::mesh::{NONE, Topology};

/// Returns, for each loop but the first, the form of a path of faces from the first loop to it: how
/// often each half-edge is crossed from its left to its right.
///
/// Its integral around the loop at the end of the path is 1, around the first loop -1, and around
/// the others 0, the surface on the left.
pub(crate) fn between_loops(topology: &Topology, loops: &[Vec<u32>]) -> Vec<Vec<i32>> {
    let entered = enter_from(topology, &loops[0]);
    loops[1..]
        .iter()
        .map(|half_edges| {
            let mut form = vec![0; 3 * topology.face_count()];
            let mut left = half_edges[0];
            loop {
                form[left as usize] += 1;
                let into = entered[(left / 3) as usize];
                form[into as usize] -= 1;
                left = topology.twin(into);
                if left == NONE {
                    return form;
                }
            }
        })
        .collect()
}

/// Returns the half-edge of each face over which shortest paths from a boundary loop enter it.
fn enter_from(topology: &Topology, start: &[u32]) -> Vec<u32> {
    let mut entered = vec![NONE; topology.face_count()];
    let mut queue = VecDeque::new();
    for &half_edge in start {
        let face = half_edge / 3;
        if entered[face as usize] == NONE {
            entered[face as usize] = half_edge;
            queue.push_back(face);
        }
    }
    while let Some(face) = queue.pop_front() {
        for half_edge in 3 * face..3 * face + 3 {
            let twin = topology.twin(half_edge);
            if twin != NONE && entered[(twin / 3) as usize] == NONE {
                entered[(twin / 3) as usize] = twin;
                queue.push_back(twin / 3);
            }
        }
    }
    entered
}
