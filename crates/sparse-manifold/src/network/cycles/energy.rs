//! What a choice of cyclic orders costs, as a Markov random field over junctions.
//!
//! # Notation
//! `T[x][y]` of an arc `(v, w)` is the cost of slot `x` of `v` and slot `y` of `w` being on the same
//! side of the arc: half its corner normals' lengths less their product, one carried to the other's
//! end. Of the two sides, the left has the next slot of `v` and the previous of `w`, the right the
//! previous of `v` and the next of `w`; both normals change sign, and the table is the same.
//!
//! # Reference
//! [Zhuang2013]: orders, and normals that hardly turn along curves. Deviation: sharp corners cost
//! their tour of the tangents instead of planarity, and mates belong apart.

use nalgebra::{Point3, Vector3};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::super::graph::CurveGraph;
use super::orders::Orders;

/// Steps of a rotation-minimising frame on each piece of an arc.
const FRAME_STEPS: usize = 4;

/// Cost of two neighbours that continue one another, where four arcs or more meet.
const NEIGHBOURING_MATES: f64 = 2.0;

/// Costs of all orders and of all pairs of slots along arcs.
#[derive(Clone)]
pub(super) struct Costs {
    /// Per junction and order.
    pub(super) unary: Vec<Vec<f64>>,
    /// `T`, per arc, row after row.
    pub(super) tables: Vec<Vec<f64>>,
}

/// The graph with the orders and slots of its junctions.
pub(super) struct Field<'a> {
    pub(super) graph: &'a CurveGraph,
    pub(super) orders: Vec<Orders>,
    /// The slot of every half-edge at its origin.
    pub(super) slots: Vec<u8>,
    pub(super) costs: Costs,
}

impl<'a> Field<'a> {
    pub(super) fn new(graph: &'a CurveGraph) -> Self {
        let half_edges = 2 * graph.arcs().len() as u32;
        let tangents: Vec<Vector3<f64>> = (0..half_edges).map(|h| graph.tangent(h)).collect();
        let mut slots = vec![0; half_edges as usize];
        let mut orders = Vec::with_capacity(graph.junctions().len());
        for junction in graph.junctions() {
            for (slot, &h) in junction.half_edges.iter().enumerate() {
                slots[h as usize] = slot as u8;
            }
            let around = junction.half_edges.iter().map(|&h| tangents[h as usize]);
            orders.push(Orders::of(&around.collect::<Vec<_>>()));
        }
        let unary = (0..graph.junctions().len())
            .map(|v| unary(graph, v, &orders[v], &slots, &tangents))
            .collect();
        let tables = (0..graph.arcs().len())
            .map(|arc| table(graph, arc as u32, &tangents))
            .collect();
        Self {
            graph,
            orders,
            slots,
            costs: Costs { unary, tables },
        }
    }

    /// Returns the cost of an arc if its two ends have these orders.
    pub(super) fn pair(&self, costs: &Costs, arc: u32, orders: [u32; 2]) -> f64 {
        let [v, w] = self.graph.arcs()[arc as usize].ends.map(|v| v as usize);
        let [x, y] = [2 * arc, 2 * arc + 1].map(|h| self.slots[h as usize] as usize);
        let (from, to) = (&self.orders[v], &self.orders[w]);
        let row = self.graph.junctions()[w].half_edges.len();
        let table = &costs.tables[arc as usize];
        let at = |a: u8, b: u8| table[a as usize * row + b as usize];
        at(from.next(orders[0])[x], to.previous(orders[1])[y])
            + at(from.previous(orders[0])[x], to.next(orders[1])[y])
    }

    /// Returns what junction `v` and its arcs cost if it has an order and the others have theirs.
    pub(super) fn local(&self, costs: &Costs, v: usize, order: u32, chosen: &[u32]) -> f64 {
        let mut sum = 0.5 * costs.unary[v][order as usize];
        for &h in &self.graph.junctions()[v].half_edges {
            let other = self.graph.origin(h ^ 1) as usize;
            if other == v {
                // An arc back to its start is met twice.
                sum += 0.5 * self.pair(costs, h / 2, [order, order]);
                continue;
            }
            let both = [order, chosen[other]];
            let both = if h % 2 == 0 { both } else { [both[1], both[0]] };
            sum += self.pair(costs, h / 2, both);
        }
        sum
    }

    /// Returns the costs with uniform noise of a standard deviation.
    pub(super) fn noisy(&self, deviation: f64, random: &mut Pcg64Mcg) -> Costs {
        let mut costs = self.costs.clone();
        let width = deviation * 12.0_f64.sqrt();
        let all = costs.unary.iter_mut().chain(&mut costs.tables).flatten();
        for cost in all {
            *cost += width * (random.random::<f64>() - 0.5);
        }
        costs
    }
}

/// Returns the cost of every order of a junction: how much longer its tour of the tangents is than
/// the shortest, and how many mates are neighbours.
fn unary(
    graph: &CurveGraph,
    v: usize,
    orders: &Orders,
    slots: &[u8],
    tangents: &[Vector3<f64>],
) -> Vec<f64> {
    let half_edges = &graph.junctions()[v].half_edges;
    let count = half_edges.len();
    let angle = |a: usize, b: usize| {
        let [s, t] = [a, b].map(|slot| tangents[half_edges[slot] as usize]);
        s.cross(&t).norm().atan2(s.dot(&t))
    };
    let angles: Vec<f64> = (0..count * count)
        .map(|i| angle(i / count, i % count))
        .collect();
    let mate = |slot: usize| graph.mate(half_edges[slot]).map(|h| slots[h as usize]);
    let mates: Vec<Option<u8>> = (0..count).map(mate).collect();
    let cost = |order: u32| {
        let next = orders.next(order);
        let tour: f64 = (0..count)
            .map(|x| angles[x * count + next[x] as usize])
            .sum();
        let close = (0..count)
            .filter(|&x| count >= 4 && mates[x] == Some(next[x]))
            .count();
        (tour, NEIGHBOURING_MATES * close as f64)
    };
    let both: Vec<(f64, f64)> = (0..orders.len() as u32).map(cost).collect();
    let shortest = both.iter().map(|c| c.0).fold(f64::INFINITY, f64::min);
    both.iter()
        .map(|(tour, mates)| (tour - shortest) / std::f64::consts::PI + mates)
        .collect()
}

/// Returns `T` of an arc.
fn table(graph: &CurveGraph, arc: u32, tangents: &[Vector3<f64>]) -> Vec<f64> {
    let [h, g] = [2 * arc, 2 * arc + 1];
    let around = |h: u32| &graph.junctions()[graph.origin(h) as usize].half_edges;
    let [along, back] = [h, g].map(|h| tangents[h as usize]);
    let samples = graph.arc(h).shape.samples(FRAME_STEPS);
    let frame = Frame::along(&samples);
    let carried = around(h).iter().map(|&a| {
        let normal = along.cross(&tangents[a as usize]);
        (normal.norm(), frame.carry(&normal))
    });
    let there: Vec<(f64, Vector3<f64>)> = around(g)
        .iter()
        .map(|&d| {
            let normal = tangents[d as usize].cross(&back);
            (normal.norm(), normal)
        })
        .collect();
    carried
        .flat_map(|(size, normal)| {
            there
                .iter()
                .map(move |(other, there)| 0.5 * (size * other - normal.dot(there)))
                .collect::<Vec<_>>()
        })
        .collect()
}

/// The rotation that a rotation-minimising frame makes from one end of a curve to the other.
struct Frame {
    start: [Vector3<f64>; 3],
    end: [Vector3<f64>; 3],
}

impl Frame {
    /// # Reference
    /// [Wang2008] Table I, the double reflection.
    fn along(samples: &[(Point3<f64>, Vector3<f64>)]) -> Self {
        let first = samples[0].1;
        let helper = Vector3::ith(first.iamin(), 1.0);
        let start = first.cross(&helper).normalize();
        let mut normal = start;
        for pair in samples.windows(2) {
            let [(p, t), (q, next)] = [pair[0], pair[1]];
            let chord = q - p;
            let (normal_once, tangent_once) = (mirrored(normal, chord), mirrored(t, chord));
            normal = mirrored(normal_once, next - tangent_once);
        }
        let last = samples[samples.len() - 1].1;
        // Rounding grows along the curve; the frame stays a rotation.
        let normal = (normal - last * normal.dot(&last)).normalize();
        Self {
            start: [first, start, first.cross(&start)],
            end: [last, normal, last.cross(&normal)],
        }
    }

    fn carry(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        (0..3)
            .map(|i| self.end[i] * self.start[i].dot(vector))
            .sum()
    }
}

/// Returns a vector mirrored in the plane perpendicular to another.
fn mirrored(vector: Vector3<f64>, across: Vector3<f64>) -> Vector3<f64> {
    let square = across.norm_squared();
    if square > 0.0 {
        vector - across * (2.0 * across.dot(&vector) / square)
    } else {
        vector
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_frame_of_a_planar_curve_keeps_the_normal_of_its_plane() {
        let at = |i: usize| {
            let a = 0.1 * i as f64;
            let p = Point3::new(a.cos(), a.sin(), 0.0);
            (p, Vector3::new(-a.sin(), a.cos(), 0.0))
        };
        let frame = Frame::along(&(0..20).map(at).collect::<Vec<_>>());
        assert!((frame.carry(&Vector3::z()) - Vector3::z()).norm() < 1e-12);
        let outwards = frame.carry(&Vector3::x());
        let end = at(19).0.coords;
        assert!((outwards - end).norm() < 1e-12, "{outwards}");
    }

    #[test]
    fn the_frame_of_a_helix_turns_by_its_torsion() {
        // Torsion b / (a² + b²) times length, for a radius a and a rise b per radian.
        let (a, b, turns) = (1.0_f64, 0.5_f64, 3.0_f64);
        let c = (a * a + b * b).sqrt();
        let count = 3000;
        let at = |i: usize| {
            let u = turns * i as f64 / f64::from(count);
            let p = Point3::new(a * u.cos(), a * u.sin(), b * u);
            (p, Vector3::new(-a * u.sin(), a * u.cos(), b) / c)
        };
        let frame = Frame::along(&(0..=count as usize).map(at).collect::<Vec<_>>());
        // The principal normal points to the axis; its angle to what it was carried from is the torsion.
        let normal = |u: f64| Vector3::new(-u.cos(), -u.sin(), 0.0);
        let cosine = frame.carry(&normal(0.0)).dot(&normal(turns));
        let torsion = b / (c * c) * turns * c;
        assert!(
            (cosine - torsion.cos()).abs() < 1e-6,
            "{cosine} {}",
            torsion.cos()
        );
    }
}
