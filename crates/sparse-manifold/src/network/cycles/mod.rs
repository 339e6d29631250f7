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
mod ties;
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
    let mut best: Vec<u32> = Vec::new();
    let mut restarts = 0;
    while restarts < options.restarts.max(1) {
        let share = f64::from(restarts) / f64::from(options.restarts.max(2) - 1);
        let seed = options.seed.wrapping_add(u64::from(restarts));
        let mut chosen = search::start(&field, options.noise * share, seed);
        restarts += 1;
        if best.is_empty() {
            best = chosen;
        } else {
            if search::energy(&field, &chosen) < search::energy(&field, &best) {
                std::mem::swap(&mut best, &mut chosen);
            }
            search::fuse(&field, &mut best, &chosen);
        }
        if let Some(expected) = options.expected_euler {
            let sorted = Sorted::of(graph, trace::cycles(&field, &best), options)?;
            if sorted.is_sound() && sorted.euler().iter().sum::<i64>() == expected {
                break;
            }
        }
    }
    ties::settle(&field, &mut best);
    let sorted = Sorted::of(graph, trace::cycles(&field, &best), options)?;
    Ok(sorted.finish(search::energy(&field, &best), restarts))
}
