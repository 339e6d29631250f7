//! The cycles that a choice of orders gives.

use super::energy::Field;

/// What a face is worth, against the cost of a junction that a cycle passes again.
const FACE: f64 = -0.3;
const AGAIN: f64 = 1.0;

/// Returns the half-edge after one, around the face on its left.
pub(super) fn after(field: &Field<'_>, chosen: &[u32], h: u32) -> u32 {
    let back = h ^ 1;
    let v = field.graph.origin(back) as usize;
    let slot = field.slots[back as usize] as usize;
    let previous = field.orders[v].previous(chosen[v])[slot];
    field.graph.junctions()[v].half_edges[previous as usize]
}

/// Returns all cycles, each from its smallest half-edge on.
pub(super) fn cycles(field: &Field<'_>, chosen: &[u32]) -> Vec<Vec<u32>> {
    let mut seen = vec![false; field.slots.len()];
    let mut cycles = Vec::new();
    for start in 0..field.slots.len() as u32 {
        if seen[start as usize] {
            continue;
        }
        let mut cycle = Vec::new();
        let mut h = start;
        while !seen[h as usize] {
            seen[h as usize] = true;
            cycle.push(h);
            h = after(field, chosen, h);
        }
        cycles.push(cycle);
    }
    cycles
}

/// Counts cycles around junctions, without clearing its marks each time.
pub(super) struct Tracer {
    round: u32,
    half_edges: Vec<u32>,
    junctions: Vec<u32>,
    /// Distinguishes the cycles of a round.
    cycle: u32,
}

impl Tracer {
    pub(super) fn new(field: &Field<'_>) -> Self {
        Self {
            round: 0,
            half_edges: vec![0; field.slots.len()],
            junctions: vec![0; field.graph.junctions().len()],
            cycle: 0,
        }
    }

    /// Returns what the cycles through some junctions cost: their number and their repetitions.
    pub(super) fn cost(&mut self, field: &Field<'_>, chosen: &[u32], around: &[usize]) -> f64 {
        self.round = self.fresh(self.round);
        let (mut faces, mut repeats) = (0u32, 0u32);
        for &v in around {
            for &start in &field.graph.junctions()[v].half_edges {
                if self.half_edges[start as usize] == self.round {
                    continue;
                }
                faces += 1;
                self.cycle = self.cycle.wrapping_add(1).max(1);
                let mut h = start;
                while self.half_edges[h as usize] != self.round {
                    self.half_edges[h as usize] = self.round;
                    let origin = &mut self.junctions[field.graph.origin(h) as usize];
                    repeats += u32::from(*origin == self.cycle);
                    *origin = self.cycle;
                    h = after(field, chosen, h);
                }
            }
        }
        FACE * f64::from(faces) + AGAIN * f64::from(repeats)
    }

    /// Returns the next mark; after four milliard rounds, clears those of before.
    fn fresh(&mut self, round: u32) -> u32 {
        if round == u32::MAX {
            self.half_edges.fill(0);
            return 1;
        }
        round + 1
    }
}
