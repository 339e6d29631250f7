//! Critical levels, and where every vertex lies between them, in whole numbers.
//!
//! # Notation
//! The `L` critical levels - those of zeros of the form and of boundary loops - are ordered by `v` in
//! `[0, 1)`. The *position* of a vertex is `2i` on level `i`, and `2i - 1` or `2i + 1` in the bands below
//! and above; with the lifts along the sides of a face its corners are `2L` times whole numbers further
//! up. Only vertices of one boundary loop share a level: equal values are told apart by the numbers of
//! vertices.
//!
//! # Reference
//! [He2006] §3.2, the critical graph. Deviation: ties are broken by numbers, so that no level is degenerate.

use std::cmp::Ordering;

use msplines_common::mesh::{NONE, Topology, TriangleMesh};

use super::error::DomainError;
use super::form::{ONE, Values};

/// What lies on a critical level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Critical {
    /// A zero of the form at a vertex; of order 0 where a torus is cut open.
    Zero { vertex: u32, order: u32 },
    /// A boundary loop, and whether the surface lies above it.
    Loop { boundary: u32, above: bool },
}

/// Critical levels of a form.
#[derive(Clone, Debug)]
pub(super) struct Levels {
    pub(super) critical: Vec<Critical>,
    /// `v` on each level.
    values: Vec<i64>,
    /// Positions of the vertices.
    positions: Vec<i32>,
}

impl Levels {
    /// Finds zeros by the changes of sign around every vertex. O(n).
    pub(super) fn find(mesh: &TriangleMesh, values: &Values) -> Result<Self, DomainError> {
        let topology = mesh.topology();
        let mut found = Vec::new();
        for vertex in 0..mesh.vertex_count() as u32 {
            if !topology.is_boundary_vertex(vertex)
                && let Some(order) = order(topology, values, vertex)?
            {
                found.push((vertex, Critical::Zero { vertex, order }));
            }
        }
        let zeros = found.len();
        for boundary in 0..values.loops.len() {
            let (vertex, above) = direction(topology, values, boundary)?;
            let boundary = boundary as u32;
            found.push((vertex, Critical::Loop { boundary, above }));
        }
        check_count(topology, values, &found[..zeros])?;
        if found.is_empty() {
            let (vertex, order) = (0, 0);
            found.push((vertex, Critical::Zero { vertex, order }));
        }
        Ok(Self::order(mesh, values, found))
    }

    fn order(mesh: &TriangleMesh, values: &Values, mut found: Vec<(u32, Critical)>) -> Self {
        let key = |vertex: u32| (values.of[vertex as usize], values.ranks[vertex as usize]);
        found.sort_by_key(|&(vertex, _)| key(vertex));
        let keys: Vec<(i64, u32)> = found.iter().map(|&(vertex, _)| key(vertex)).collect();
        let position = |vertex: u32| match keys.binary_search(&key(vertex)) {
            Ok(level) => 2 * level as i32,
            Err(above) => 2 * above as i32 - 1,
        };
        Self {
            positions: (0..mesh.vertex_count() as u32).map(position).collect(),
            values: keys.iter().map(|key| key.0).collect(),
            critical: found.into_iter().map(|(_, critical)| critical).collect(),
        }
    }

    /// Positions that one turn of `v` adds.
    pub(super) fn turn(&self) -> i32 {
        2 * self.values.len() as i32
    }

    pub(super) fn position(&self, vertex: u32) -> i32 {
        self.positions[vertex as usize]
    }

    /// `v` on the level of an even position.
    pub(super) fn value(&self, position: i32) -> i64 {
        let (level, lift) = self.level(position);
        self.values[level] + i64::from(lift) * ONE
    }

    /// The level of an even position, and how many turns up.
    pub(super) fn level(&self, position: i32) -> (usize, i32) {
        let turn = self.turn();
        let level = position.rem_euclid(turn) / 2;
        (level as usize, position.div_euclid(turn))
    }
}

/// Whether `v` rises along a half-edge; equal only within one boundary loop.
fn rise(topology: &Topology, values: &Values, half_edge: u32) -> Ordering {
    let [from, to] = [topology.origin(half_edge), topology.target(half_edge)].map(|v| v as usize);
    let up = values.of[to] + i64::from(values.lifts[half_edge as usize]) * ONE;
    (up, values.ranks[to]).cmp(&(values.of[from], values.ranks[from]))
}

/// The order of the zero at an inner vertex, if it is one.
fn order(topology: &Topology, values: &Values, vertex: u32) -> Result<Option<u32>, DomainError> {
    let mut rises = topology
        .outgoing(vertex)
        .map(|h| rise(topology, values, h) == Ordering::Greater);
    let first = rises.next();
    let (mut before, mut changes) = (first, 0);
    for now in rises.map(Some).chain([first]) {
        changes += u32::from(now != before);
        before = now;
    }
    match changes / 2 {
        0 => Err(DomainError::Extremum { vertex }),
        1 => Ok(None),
        more => Ok(Some(more - 1)),
    }
}

/// The vertex that stands for a boundary loop, and whether the surface lies above the loop.
fn direction(
    topology: &Topology,
    values: &Values,
    boundary: usize,
) -> Result<(u32, bool), DomainError> {
    let half_edges = &values.loops[boundary];
    let mut found = None;
    for &half_edge in half_edges {
        let vertex = topology.origin(half_edge);
        let mut last = NONE;
        let mut check = |rise: Ordering| match (rise, found) {
            (Ordering::Equal, _) => Ok(()),
            (_, Some(before)) if before != rise => {
                Err(DomainError::ZeroOnLoop { boundary, vertex })
            }
            _ => {
                found = Some(rise);
                Ok(())
            }
        };
        for outgoing in topology.outgoing(vertex) {
            check(rise(topology, values, outgoing))?;
            last = Topology::previous(outgoing);
        }
        if last != NONE {
            check(rise(topology, values, last).reverse())?;
        }
    }
    let vertex = topology.origin(half_edges[0]);
    match found {
        Some(rise) => Ok((vertex, rise == Ordering::Greater)),
        None => Err(DomainError::ZeroOnLoop { boundary, vertex }),
    }
}

/// Checks that orders sum to `2g - 2 + b`, which is minus the Euler characteristic.
fn check_count(
    topology: &Topology,
    values: &Values,
    zeros: &[(u32, Critical)],
) -> Result<(), DomainError> {
    let orders = zeros.iter().map(|(_, critical)| match critical {
        Critical::Zero { order, .. } => i64::from(*order),
        Critical::Loop { .. } => 0,
    });
    let (found, expected) = (orders.sum(), -topology.euler_characteristic());
    if found != expected {
        return Err(DomainError::Zeros { found, expected });
    }
    let flat = topology.faces().iter().position(|corners| {
        let rank = |v: u32| values.ranks[v as usize];
        corners
            .iter()
            .all(|&v| topology.is_boundary_vertex(v) && rank(v) == rank(corners[0]))
    });
    match flat {
        Some(face) => Err(DomainError::FlatFace { face: face as u32 }),
        None => Ok(()),
    }
}
