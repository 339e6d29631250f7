//! Cyclic orders of the arcs around a junction.
//!
//! # Notation
//! A junction has slots `0..k`, one per half-edge that starts there. An order is a cyclic permutation
//! of the slots, counter-clockwise seen from outside the surface.

use nalgebra::{Matrix3, Vector3};

/// Junctions of up to this many arcs take every order into account.
const ALL_ORDERS: usize = 6;

/// The orders that a junction may have.
#[derive(Clone, Debug)]
pub(super) struct Orders {
    slots: usize,
    /// After and before each slot, order after order.
    next: Vec<u8>,
    previous: Vec<u8>,
    mirrors: Vec<u32>,
}

impl Orders {
    /// Returns all orders of up to six arcs. Of more, the planar order, each order that differs from
    /// it by a swap of neighbours, and the mirrors of these.
    pub(super) fn of(tangents: &[Vector3<f64>]) -> Self {
        let slots = tangents.len();
        let cycles = if slots <= ALL_ORDERS {
            permutations(slots)
        } else {
            near_planar(tangents)
        };
        let mut orders = Self {
            slots,
            next: Vec::with_capacity(slots * cycles.len()),
            previous: Vec::with_capacity(slots * cycles.len()),
            mirrors: Vec::with_capacity(cycles.len()),
        };
        let mirrored = |cycle: &[u8]| {
            let mut cycle = cycle.to_vec();
            cycle[1..].reverse();
            cycle
        };
        for cycle in &cycles {
            let at = orders.next.len();
            orders.next.resize(at + slots, 0);
            orders.previous.resize(at + slots, 0);
            for (i, &slot) in cycle.iter().enumerate() {
                let after = cycle[(i + 1) % slots];
                orders.next[at + slot as usize] = after;
                orders.previous[at + after as usize] = slot;
            }
            let mirror = mirrored(cycle);
            let mirror = cycles.iter().position(|other| *other == mirror);
            orders.mirrors.push(mirror.unwrap_or_default() as u32);
        }
        orders
    }

    /// Returns how many orders there are.
    pub(super) fn len(&self) -> usize {
        self.mirrors.len()
    }

    /// Returns the slot after each, in an order.
    pub(super) fn next(&self, order: u32) -> &[u8] {
        &self.next[order as usize * self.slots..][..self.slots]
    }

    /// Returns the slot before each, in an order.
    pub(super) fn previous(&self, order: u32) -> &[u8] {
        &self.previous[order as usize * self.slots..][..self.slots]
    }

    /// Returns the order seen from the other side.
    pub(super) fn mirror(&self, order: u32) -> u32 {
        self.mirrors[order as usize]
    }
}

/// Returns all cycles of `0..slots` that start with 0, in lexicographic order.
fn permutations(slots: usize) -> Vec<Vec<u8>> {
    let mut cycles = vec![vec![0]];
    for _ in 1..slots {
        let longer = |cycle: &Vec<u8>| {
            let cycle = cycle.clone();
            (1..slots as u8)
                .filter(|slot| !cycle.contains(slot))
                .map(|slot| [cycle.as_slice(), &[slot]].concat())
                .collect::<Vec<_>>()
        };
        cycles = cycles.iter().flat_map(longer).collect();
    }
    cycles
}

fn near_planar(tangents: &[Vector3<f64>]) -> Vec<Vec<u8>> {
    let [x, y] = plane(tangents);
    let mut planar: Vec<u8> = (0..tangents.len() as u8).collect();
    let angle = |slot: &u8| {
        let t = &tangents[*slot as usize];
        t.dot(&y).atan2(t.dot(&x))
    };
    planar.sort_by(|a, b| angle(a).total_cmp(&angle(b)).then(a.cmp(b)));
    let swapped = (0..planar.len()).map(|i| {
        let mut cycle = planar.clone();
        cycle.swap(i, (i + 1) % planar.len());
        cycle
    });
    let seen_from_above = std::iter::once(planar.clone()).chain(swapped);
    let with_mirrors = seen_from_above.flat_map(|cycle| {
        let mirror = cycle.iter().rev().copied().collect();
        [cycle, mirror]
    });
    with_mirrors.map(from_zero).collect()
}

/// Returns the cycle from slot 0 on.
fn from_zero(mut cycle: Vec<u8>) -> Vec<u8> {
    let start = cycle.iter().position(|&slot| slot == 0);
    cycle.rotate_left(start.unwrap_or_default());
    cycle
}

/// Returns two directions that span the plane nearest to the tangents.
fn plane(tangents: &[Vector3<f64>]) -> [Vector3<f64>; 2] {
    let mean = tangents.iter().sum::<Vector3<f64>>() / tangents.len() as f64;
    let spread = tangents.iter().map(|t| (t - mean) * (t - mean).transpose());
    let spread = spread.sum::<Matrix3<f64>>().symmetric_eigen();
    let smallest = spread.eigenvalues.imin();
    let [x, y] = [1, 2].map(|i| spread.eigenvectors.column((smallest + i) % 3).into_owned());
    [x, y]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fan(count: usize) -> Vec<Vector3<f64>> {
        let turn = std::f64::consts::TAU / count as f64;
        let at = |i: usize| Vector3::new((turn * i as f64).cos(), (turn * i as f64).sin(), 0.2);
        (0..count).map(at).collect()
    }

    #[test]
    fn there_are_all_orders_up_to_six_arcs_and_mirrors_are_mutual() {
        for (count, orders) in [(2, 1), (3, 2), (4, 6), (5, 24), (6, 120), (9, 20)] {
            let all = Orders::of(&fan(count));
            assert_eq!(all.len(), orders);
            for order in 0..orders as u32 {
                assert_eq!(all.mirror(all.mirror(order)), order);
                assert_eq!(all.next(order), all.previous(all.mirror(order)));
                let after = all.next(order);
                let mut slot = 0;
                for _ in 0..count {
                    slot = after[slot as usize];
                }
                assert_eq!(slot, 0, "a cycle through all slots");
            }
        }
    }

    #[test]
    fn many_arcs_are_taken_by_angle() {
        let orders = Orders::of(&fan(9));
        let next: Vec<u8> = (0..9).map(|slot| (slot + 1) % 9).collect();
        assert!([0, 1].iter().any(|&order| orders.next(order) == next));
    }
}
