//! Which arcs of a network bound a patch.
//!
//! The unknown is the cyclic order of the arcs around each junction; all cycles follow from it. A good
//! order has a short tour of tangents, and corner normals that hardly turn when a rotation-minimising
//! frame carries them along an arc. That is a Markov random field over the junctions. It is solved from
//! the locally best orders, mirrored along a spanning tree, by iterated conditional modes and by
//! repair of suspect cycles, and again from disturbed costs.
//!
//! # Reference
//! [Wang2016] §4.3 takes the cycles of [Zhuang2013]. Deviation: orders are searched by restarts from
//! disturbed costs rather than by dynamic programming, and cycles may be given by hand.

mod energy;
mod finish;
mod given;
mod options;
mod orders;
mod search;
mod trace;

use super::error::NetworkError;
use super::graph::CurveGraph;

use energy::Field;
use finish::Sorted;
pub(super) use finish::repeated;
pub use options::{CycleOptions, CycleReport};

/// The arcs around one patch or hole.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cycle {
    /// Half-edges, head to tail; the patch lies on their left, seen from outside.
    pub half_edges: Vec<u32>,
    /// Whether the surface is open there.
    pub hole: bool,
}

/// All cycles of a network.
#[derive(Clone, Debug)]
pub struct Cycles {
    /// Patches and holes; every half-edge is in one of them, but for arcs of a sheet, which has one
    /// patch with its half-edges on one side only.
    pub list: Vec<Cycle>,
    /// How they were found.
    pub report: CycleReport,
}

/// Returns the cycles of a network that are most likely meant as patches, or those given.
///
/// Cycles of a component have one orientation: outwards if it is closed, else away from its centre.
/// Takes `restarts` searches, each in about O(arcs) for junctions of up to six arcs.
///
/// # Reference
/// [Wang2016] §4.3; [Zhuang2013].
///
/// # Errors
/// Given cycles that cannot be followed or form no surface, `fill` or `hole` entries that name no
/// cycle, options out of range.
pub fn find_cycles(graph: &CurveGraph, options: &CycleOptions) -> Result<Cycles, NetworkError> {
    options.check()?;
    if !options.cycles.is_empty() {
        let cycles = given::cycles(graph, &options.cycles)?;
        let sorted = Sorted::of_given(graph, cycles, options)?;
        return Ok(sorted.finish(0.0, 0));
    }
    let field = Field::new(graph);
    let (component, components) = graph.components();
    let mut best: Vec<u32> = Vec::new();
    let mut least = vec![f64::INFINITY; components as usize];
    let mut restarts = 0;
    while restarts < options.restarts.max(1) {
        let share = f64::from(restarts) / f64::from(options.restarts.max(2) - 1);
        let seed = options.seed.wrapping_add(u64::from(restarts));
        let chosen = search::start(&field, options.noise * share, seed);
        restarts += 1;
        // The energy is a sum over components, so that each has its own best restart.
        let energies = search::energies(&field, &chosen, &component);
        if best.is_empty() {
            best.clone_from(&chosen);
        }
        for (v, &c) in component.iter().enumerate() {
            if energies[c as usize] < least[c as usize] {
                best[v] = chosen[v];
            }
        }
        for (least, energy) in least.iter_mut().zip(energies) {
            *least = least.min(energy);
        }
        if let Some(expected) = options.expected_euler {
            let sorted = Sorted::of(graph, trace::cycles(&field, &best), options)?;
            if sorted.is_sound() && sorted.euler().iter().sum::<i64>() == expected {
                break;
            }
        }
    }
    let sorted = Sorted::of(graph, trace::cycles(&field, &best), options)?;
    Ok(sorted.finish(least.iter().sum(), restarts))
}

#[cfg(test)]
pub(super) fn truth_energy(graph: &CurveGraph, patches: &[Vec<u32>]) -> Option<f64> {
    use std::collections::BTreeMap;
    let field = Field::new(graph);
    let mut next: BTreeMap<u32, u32> = BTreeMap::new();
    let at: BTreeMap<u32, usize> = graph.junctions().iter().enumerate().map(|(v, j)| (j.point, v)).collect();
    for p in patches {
        let hs: Vec<u32> = (0..p.len()).map(|i| {
            let (a, b) = (at[&p[i]], at[&p[(i + 1) % p.len()]]);
            *graph.junctions()[a].half_edges.iter().find(|&&h| graph.origin(h ^ 1) as usize == b).unwrap()
        }).collect();
        for i in 0..hs.len() { next.insert(hs[i], hs[(i + 1) % hs.len()]); }
    }
    let mut chosen = Vec::new();
    for (v, j) in graph.junctions().iter().enumerate() {
        let o = (0..field.orders[v].len() as u32).find(|&o| j.half_edges.iter().all(|&g| {
            let n = next[&(g ^ 1)];
            field.orders[v].previous(o)[field.slots[g as usize] as usize] == field.slots[n as usize]
        }))?;
        chosen.push(o);
    }
    let (component, _) = graph.components();
    Some(search::energies(&field, &chosen, &component).iter().sum())
}
