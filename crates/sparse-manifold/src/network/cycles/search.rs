//! The search for the orders of least energy.

use std::collections::BTreeSet;

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use super::super::graph::NetworkArc;
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

/// Junctions that are mirrored together at most.
const MOST_MIRRORED: usize = 32;

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

/// Changes orders at suspect cycles, one or two at a time, and mirrors groups, while the whole energy
/// falls.
fn repair(field: &Field<'_>, chosen: &mut [u32]) {
    let mut tracer = Tracer::new(field);
    for _ in 0..MOST_REPAIRS {
        let suspects = suspects(field, chosen);
        let mut moves = single_moves(field, chosen, &suspects, &mut tracer);
        if moves.is_empty() {
            moves = pair_moves(field, chosen, &suspects, &mut tracer);
        }
        if moves.is_empty() {
            moves = mirror_moves(field, chosen, &mut tracer);
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

/// New orders for some junctions.
pub(super) struct Move {
    gain: f64,
    orders: Vec<(usize, u32)>,
}

impl Move {
    /// Returns the move that mirrors a group of junctions.
    pub(super) fn mirror(field: &Field<'_>, chosen: &[u32], group: &[usize]) -> Self {
        let order = |&v: &usize| (v, field.orders[v].mirror(chosen[v]));
        Self::of(group.iter().map(order).collect())
    }

    fn of(orders: Vec<(usize, u32)>) -> Self {
        Self { gain: 0.0, orders }
    }

    pub(super) fn apply(&self, chosen: &mut [u32]) -> Vec<(usize, u32)> {
        let old = self.orders.iter().map(|&(v, _)| (v, chosen[v])).collect();
        for &(v, order) in &self.orders {
            chosen[v] = order;
        }
        old
    }

    /// Returns the change of the whole energy.
    pub(super) fn weigh(&self, field: &Field<'_>, chosen: &mut [u32], tracer: &mut Tracer) -> f64 {
        let around: Vec<usize> = self.orders.iter().map(|pair| pair.0).collect();
        let before = cost_around(field, chosen, &around, tracer);
        let old = Self::of(self.apply(chosen));
        let after = cost_around(field, chosen, &around, tracer);
        old.apply(chosen);
        after - before
    }
}

/// Returns the part of the energy that depends on the orders of some junctions.
fn cost_around(field: &Field<'_>, chosen: &[u32], around: &[usize], tracer: &mut Tracer) -> f64 {
    let local = |&v: &usize| field.local(&field.costs, v, chosen[v], chosen);
    let mut sum: f64 = around.iter().map(local).sum();
    // Arcs between two of them are in the sums of both.
    let mut inside = around.to_vec();
    inside.sort_unstable();
    for &v in around {
        for &h in &field.graph.junctions()[v].half_edges {
            let other = field.graph.origin(h ^ 1) as usize;
            if h % 2 == 0 && other != v && inside.binary_search(&other).is_ok() {
                let orders = [chosen[v], chosen[other]];
                sum -= field.pair(&field.costs, h / 2, orders);
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

/// Returns the groups of junctions that are better seen from the other side.
fn mirror_moves(field: &Field<'_>, chosen: &mut [u32], tracer: &mut Tracer) -> Vec<Move> {
    let mut moves: Vec<Move> = groups(field, chosen)
        .iter()
        .map(|group| Move::mirror(field, chosen, group))
        .collect();
    for one in &mut moves {
        one.gain = one.weigh(field, chosen, tracer);
    }
    moves.retain(|one| one.gain < -LEAST_GAIN);
    moves
}

/// Returns the groups of junctions that may be mirrored as a whole: those around a cycle, and those
/// that grow together when arcs are joined in the order of how much they tell.
pub(super) fn groups(field: &Field<'_>, chosen: &[u32]) -> BTreeSet<Vec<usize>> {
    let mut groups: BTreeSet<Vec<usize>> = BTreeSet::new();
    for cycle in cycles(field, chosen) {
        let around = cycle.iter().map(|&h| field.graph.origin(h) as usize);
        let around: BTreeSet<usize> = around.collect();
        if around.len() <= MOST_MIRRORED {
            groups.insert(around.into_iter().collect());
        }
    }
    let arcs = field.graph.arcs();
    let mut bonds = Vec::with_capacity(arcs.len());
    for (index, arc) in arcs.iter().enumerate() {
        let [v, w] = arc.ends.map(|v| v as usize);
        let mirrored = field.orders[w].mirror(chosen[w]);
        let alike = field.pair(&field.costs, index as u32, [chosen[v], chosen[w]]);
        let other = field.pair(&field.costs, index as u32, [chosen[v], mirrored]);
        bonds.push((other - alike, [v, w]));
    }
    // Stable, so that equal bonds keep the order of their arcs.
    bonds.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut sets: Vec<u32> = (0..chosen.len() as u32).collect();
    let mut members: Vec<Vec<usize>> = (0..chosen.len()).map(|v| vec![v]).collect();
    for (_, ends) in bonds {
        let [v, w] = ends.map(|v| root(&mut sets, v as u32) as usize);
        if v == w {
            continue;
        }
        let (low, high) = (v.min(w), v.max(w));
        sets[high] = low as u32;
        let joined = std::mem::take(&mut members[high]);
        members[low].extend(joined);
        if members[low].len() <= MOST_MIRRORED {
            let mut group = members[low].clone();
            group.sort_unstable();
            groups.insert(group);
        }
    }
    groups
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

/// Takes from other orders those that lower the energy, one connected group that differs at a time.
///
/// Restarts err in different places, so that together they are better than the best of them.
pub(super) fn fuse(field: &Field<'_>, chosen: &mut [u32], other: &[u32]) {
    let mut tracer = Tracer::new(field);
    let mirror = |(v, &order): (usize, &u32)| field.orders[v].mirror(order);
    let mirrored: Vec<u32> = other.iter().enumerate().map(mirror).collect();
    for other in [other, &mirrored] {
        for group in differences(field, chosen, other) {
            let one = Move::of(group.into_iter().map(|v| (v, other[v])).collect());
            if one.weigh(field, chosen, &mut tracer) < -LEAST_GAIN {
                one.apply(chosen);
            }
        }
    }
}

/// Returns the connected groups of junctions whose orders differ.
fn differences(field: &Field<'_>, one: &[u32], two: &[u32]) -> Vec<Vec<usize>> {
    let mut left: Vec<bool> = one.iter().zip(two).map(|(a, b)| a != b).collect();
    let mut groups = Vec::new();
    for start in 0..left.len() {
        if !std::mem::take(&mut left[start]) {
            continue;
        }
        let mut group = vec![start];
        let mut next = 0;
        while next < group.len() {
            for &h in &field.graph.junctions()[group[next]].half_edges {
                let neighbour = field.graph.origin(h ^ 1) as usize;
                if std::mem::take(&mut left[neighbour]) {
                    group.push(neighbour);
                }
            }
            next += 1;
        }
        groups.push(group);
    }
    groups
}

/// Returns the whole energy.
pub(super) fn energy(field: &Field<'_>, chosen: &[u32]) -> f64 {
    let unary = field.costs.unary.iter().zip(chosen);
    let unary: f64 = unary
        .map(|(costs, &order)| 0.5 * costs[order as usize])
        .sum();
    let pair = |(index, arc): (usize, &NetworkArc)| {
        let orders = arc.ends.map(|v| chosen[v as usize]);
        field.pair(&field.costs, index as u32, orders)
    };
    let pairs: f64 = field.graph.arcs().iter().enumerate().map(pair).sum();
    let all: Vec<usize> = (0..chosen.len()).collect();
    unary + pairs + Tracer::new(field).cost(field, chosen, &all)
}
