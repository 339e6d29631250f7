//! The search for the orders of least energy.

use std::collections::BTreeSet;

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use super::energy::{Costs, Field};
use super::trace::{Tracer, cycles};

/// A move must save this much, so that rounding cannot go in circles.
const LEAST_GAIN: f64 = 1e-9;

/// Sweeps over all junctions; each lowers the energy, and few are needed.
const MOST_SWEEPS: usize = 100;

/// Rounds of repair; each lowers the energy.
const MOST_REPAIRS: usize = 100;

/// Pairs of orders tried on one arc: all of those of two junctions of up to five arcs.
const MOST_PAIRS: usize = 24 * 24;

/// Returns orders that no single change betters, from costs disturbed by noise.
pub(super) fn start(field: &Field<'_>, deviation: f64, seed: u64) -> Vec<u32> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let disturbed = (deviation > 0.0).then(|| field.noisy(deviation, &mut random));
    let mut chosen = initial(field, disturbed.as_ref().unwrap_or(&field.costs));
    if let Some(costs) = &disturbed {
        sweep(field, costs, &mut chosen);
    }
    sweep(field, &field.costs, &mut chosen);
    repair(field, &mut chosen);
    chosen
}

/// Returns the cheapest order of each junction, mirrored so that the arcs that tell most agree.
fn initial(field: &Field<'_>, costs: &Costs) -> Vec<u32> {
    let cheapest = |costs: &Vec<f64>| {
        let least = (0..costs.len()).min_by(|&a, &b| costs[a].total_cmp(&costs[b]));
        least.unwrap_or_default() as u32
    };
    let mut chosen: Vec<u32> = costs.unary.iter().map(cheapest).collect();
    let mirror = |v: u32| field.orders[v as usize].mirror(chosen[v as usize]);
    let mut arcs: Vec<(f64, u32, bool)> = Vec::with_capacity(costs.tables.len());
    for (index, arc) in field.graph.arcs().iter().enumerate() {
        let [v, w] = arc.ends;
        let own = chosen[v as usize];
        let alike = field.pair(costs, index as u32, [own, chosen[w as usize]]);
        let mirrored = field.pair(costs, index as u32, [own, mirror(w)]);
        arcs.push(((alike - mirrored).abs(), index as u32, mirrored < alike));
    }
    arcs.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut tree = vec![Vec::new(); chosen.len()];
    let mut sets: Vec<u32> = (0..chosen.len() as u32).collect();
    for (_, arc, mirrored) in arcs {
        let [v, w] = field.graph.arcs()[arc as usize].ends;
        let roots = [root(&mut sets, v), root(&mut sets, w)];
        if roots[0] != roots[1] {
            sets[roots[0].max(roots[1]) as usize] = roots[0].min(roots[1]);
            tree[v as usize].push((w, mirrored));
            tree[w as usize].push((v, mirrored));
        }
    }
    let flipped = flags(&tree);
    for (v, flip) in flipped.into_iter().enumerate() {
        if flip {
            chosen[v] = field.orders[v].mirror(chosen[v]);
        }
    }
    chosen
}

fn root(sets: &mut [u32], v: u32) -> u32 {
    let mut v = v;
    while sets[v as usize] != v {
        sets[v as usize] = sets[sets[v as usize] as usize];
        v = sets[v as usize];
    }
    v
}

/// Returns which vertices of a forest are mirrored against the first of their tree.
fn flags(tree: &[Vec<(u32, bool)>]) -> Vec<bool> {
    let mut flags: Vec<Option<bool>> = vec![None; tree.len()];
    for start in 0..tree.len() {
        if flags[start].is_some() {
            continue;
        }
        flags[start] = Some(false);
        let mut waiting = vec![(start, false)];
        while let Some((v, flag)) = waiting.pop() {
            for &(w, mirrored) in &tree[v] {
                if flags[w as usize].is_none() {
                    flags[w as usize] = Some(flag ^ mirrored);
                    waiting.push((w as usize, flag ^ mirrored));
                }
            }
        }
    }
    flags.into_iter().map(|flag| flag == Some(true)).collect()
}

/// Gives each junction its best order in turn until none changes.
fn sweep(field: &Field<'_>, costs: &Costs, chosen: &mut [u32]) {
    for _ in 0..MOST_SWEEPS {
        let mut changed = false;
        for v in 0..chosen.len() {
            let mut least = field.local(costs, v, chosen[v], chosen) - LEAST_GAIN;
            for order in 0..field.orders[v].len() as u32 {
                let cost = field.local(costs, v, order, chosen);
                if cost < least {
                    (least, chosen[v], changed) = (cost, order, true);
                }
            }
        }
        if !changed {
            return;
        }
    }
}

/// Changes orders at suspect cycles, one or two at a time, while the whole energy falls.
fn repair(field: &Field<'_>, chosen: &mut [u32]) {
    let mut tracer = Tracer::new(field);
    for _ in 0..MOST_REPAIRS {
        let suspects = suspects(field, chosen);
        let mut moves = single_moves(field, chosen, &suspects, &mut tracer);
        if moves.is_empty() {
            moves = pair_moves(field, chosen, &suspects, &mut tracer);
        }
        if moves.is_empty() {
            return;
        }
        // Best first; each is weighed again, since those before may have changed what it saves.
        moves.sort_by(|a, b| a.gain.total_cmp(&b.gain).then(a.orders.cmp(&b.orders)));
        for one in moves {
            if one.weigh(field, chosen, &mut tracer) < -LEAST_GAIN {
                one.apply(chosen);
            }
        }
    }
}

/// New orders for one or two junctions.
struct Move {
    gain: f64,
    orders: Vec<(usize, u32)>,
}

impl Move {
    fn of(orders: Vec<(usize, u32)>) -> Self {
        Self { gain: 0.0, orders }
    }

    fn apply(&self, chosen: &mut [u32]) -> Vec<(usize, u32)> {
        let old = self.orders.iter().map(|&(v, _)| (v, chosen[v])).collect();
        for &(v, order) in &self.orders {
            chosen[v] = order;
        }
        old
    }

    /// Returns the change of the whole energy.
    fn weigh(&self, field: &Field<'_>, chosen: &mut [u32], tracer: &mut Tracer) -> f64 {
        let around: Vec<usize> = self.orders.iter().map(|pair| pair.0).collect();
        let before = cost_around(field, chosen, &around, tracer);
        let old = Self::of(self.apply(chosen));
        let after = cost_around(field, chosen, &around, tracer);
        old.apply(chosen);
        after - before
    }
}

/// Returns the part of the energy that depends on the orders of one or two junctions.
fn cost_around(field: &Field<'_>, chosen: &[u32], around: &[usize], tracer: &mut Tracer) -> f64 {
    let local = |&v: &usize| field.local(&field.costs, v, chosen[v], chosen);
    let mut sum: f64 = around.iter().map(local).sum();
    if let [v, w] = around {
        // Arcs between the two are in both sums.
        for &h in &field.graph.junctions()[*v].half_edges {
            if field.graph.origin(h ^ 1) as usize == *w {
                let ends = field.graph.arc(h).ends.map(|v| chosen[v as usize]);
                sum -= field.pair(&field.costs, h / 2, ends);
            }
        }
    }
    sum + tracer.cost(field, chosen, around)
}

fn single_moves(
    field: &Field<'_>,
    chosen: &mut [u32],
    suspects: &BTreeSet<usize>,
    tracer: &mut Tracer,
) -> Vec<Move> {
    let mut moves = Vec::new();
    for &v in suspects {
        let before = cost_around(field, chosen, &[v], tracer);
        let current = chosen[v];
        for order in 0..field.orders[v].len() as u32 {
            chosen[v] = order;
            let gain = cost_around(field, chosen, &[v], tracer) - before;
            if gain < -LEAST_GAIN {
                let orders = vec![(v, order)];
                moves.push(Move { gain, orders });
            }
        }
        chosen[v] = current;
    }
    moves
}

fn pair_moves(
    field: &Field<'_>,
    chosen: &mut [u32],
    suspects: &BTreeSet<usize>,
    tracer: &mut Tracer,
) -> Vec<Move> {
    let mut moves = Vec::new();
    for arc in field.graph.arcs() {
        let [v, w] = arc.ends.map(|v| v as usize);
        let counts = [v, w].map(|v| field.orders[v].len());
        let both = suspects.contains(&v) && suspects.contains(&w);
        if v == w || !both || counts[0] * counts[1] > MOST_PAIRS {
            continue;
        }
        let before = cost_around(field, chosen, &[v, w], tracer);
        let current = [chosen[v], chosen[w]];
        for pair in 0..(counts[0] * counts[1]) as u32 {
            let orders = [pair / counts[1] as u32, pair % counts[1] as u32];
            [chosen[v], chosen[w]] = orders;
            let gain = cost_around(field, chosen, &[v, w], tracer) - before;
            if gain < -LEAST_GAIN {
                let orders = vec![(v, orders[0]), (w, orders[1])];
                moves.push(Move { gain, orders });
            }
        }
        [chosen[v], chosen[w]] = current;
    }
    moves
}

/// Returns the junctions of cycles that pass one twice, or are longer than the median.
fn suspects(field: &Field<'_>, chosen: &[u32]) -> BTreeSet<usize> {
    let cycles = cycles(field, chosen);
    let mut lengths: Vec<usize> = cycles.iter().map(Vec::len).collect();
    lengths.sort_unstable();
    let median = lengths[lengths.len() / 2];
    let mut suspects = BTreeSet::new();
    for cycle in cycles {
        let all: BTreeSet<usize> = cycle
            .iter()
            .map(|&h| field.graph.origin(h) as usize)
            .collect();
        if all.len() < cycle.len() || cycle.len() > median {
            suspects.extend(all);
        }
    }
    suspects
}

/// Returns the energy of every connected component.
pub(super) fn energies(field: &Field<'_>, chosen: &[u32], component: &[u32]) -> Vec<f64> {
    let count = component.iter().max().map_or(0, |last| *last as usize + 1);
    let mut energies = vec![0.0; count];
    let mut members = vec![Vec::new(); count];
    for (v, &c) in component.iter().enumerate() {
        energies[c as usize] += 0.5 * field.costs.unary[v][chosen[v] as usize];
        members[c as usize].push(v);
    }
    for (index, arc) in field.graph.arcs().iter().enumerate() {
        let orders = arc.ends.map(|v| chosen[v as usize]);
        let c = component[arc.ends[0] as usize];
        energies[c as usize] += field.pair(&field.costs, index as u32, orders);
    }
    let mut tracer = Tracer::new(field);
    for (c, members) in members.iter().enumerate() {
        energies[c] += tracer.cost(field, chosen, members);
    }
    energies
}
