//! A closed complex form whose imaginary part is a function to the circle, in whole units.
//!
//! # Notation
//! `u + iv` the integral of the form; `v` is held modulo 1, in units of `2^-56`. The *lift* of a
//! half-edge is the whole number that the difference of `v` at its ends lacks along it.

use std::collections::VecDeque;

use msplines_common::mesh::{NONE, Topology, TriangleMesh};
use msplines_conformal::Atlas;
use serde::{Deserialize, Serialize};

use super::error::DomainError;

/// Units of `v` per 1: finer than those of a complex, so that forms may decay over four more digits
/// before their levels are told apart by the numbers of vertices only.
pub(super) const ONE: i64 = 1 << 56;

/// Largest miss of whole periods: the rounding of sums over some hundred edges is far below.
const PERIODS: f64 = 1e-9;

/// What lies beyond a boundary loop of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// Nothing: the surface ends.
    Boundary,
    /// The star of a vertex that was removed, around which a cylinder closes: that vertex.
    Pole(u32),
}

/// A closed complex form on a mesh: its imaginary part has integer periods and is constant on boundary
/// loops.
#[derive(Clone, Debug)]
pub struct PeriodicForm {
    /// The mesh. Away from the zeros the form lays out its faces unfolded.
    pub mesh: TriangleMesh,
    /// `[du, dv]` by half-edge.
    pub form: Vec<[f64; 2]>,
    /// What lies beyond each boundary loop, in the order of
    /// [`Topology::boundary_loops`](msplines_common::mesh::Topology::boundary_loops).
    pub ends: Vec<End>,
}

impl PeriodicForm {
    /// Returns the form of an atlas in the scale in which its imaginary part has integer periods.
    pub(super) fn of_atlas(atlas: &Atlas) -> Self {
        let scale = atlas.scale_factor();
        Self {
            mesh: atlas.mesh().clone(),
            form: (atlas.form().iter())
                .map(|v| v.map(|x| x / scale))
                .collect(),
            ends: Vec::new(),
        }
    }
}

/// `v` at the vertices, in whole units.
#[derive(Clone, Debug)]
pub(super) struct Values {
    /// `v` in `[0, ONE)`.
    pub(super) of: Vec<i64>,
    /// What tells vertices of equal `v` apart: the number of the vertex, or of the first one of its
    /// boundary loop.
    pub(super) ranks: Vec<u32>,
    /// By half-edge.
    pub(super) lifts: Vec<i32>,
    /// Half-edges of the boundary loops.
    pub(super) loops: Vec<Vec<u32>>,
    /// Largest miss of whole periods.
    pub(super) defect: f64,
}

impl Values {
    /// Integrates the imaginary part over a tree of edges, breadth first. O(n).
    pub(super) fn integrate(given: &PeriodicForm) -> Result<Self, DomainError> {
        let topology = given.mesh.topology();
        let loops = topology.boundary_loops();
        check_counts(given, &loops)?;
        let mut of = along_tree(topology, &given.form);
        let mut ranks: Vec<u32> = (0..of.len() as u32).collect();
        for (boundary, half_edges) in loops.iter().enumerate() {
            let first = topology.origin(half_edges[0]);
            let level = of[first as usize];
            for &half_edge in half_edges {
                let vertex = topology.origin(half_edge) as usize;
                let away = (of[vertex] - level + ONE / 2).rem_euclid(ONE) - ONE / 2;
                let change = (away as f64 / ONE as f64).abs();
                if change > PERIODS {
                    return Err(DomainError::LoopNotLevel { boundary, change });
                }
                of[vertex] = level;
                ranks[vertex] = first;
            }
        }
        let mut values = Self {
            lifts: vec![0; given.form.len()],
            of,
            ranks,
            loops,
            defect: 0.0,
        };
        values.lift(given)?;
        Ok(values)
    }

    fn lift(&mut self, given: &PeriodicForm) -> Result<(), DomainError> {
        let topology = given.mesh.topology();
        let mut worst = 0;
        for half_edge in 0..given.form.len() as u32 {
            let ends = [topology.origin(half_edge), topology.target(half_edge)];
            let [from, to] = ends.map(|v| self.of[v as usize]);
            let beyond = given.form[half_edge as usize][1] - (to - from) as f64 / ONE as f64;
            let miss = (beyond - beyond.round()).abs();
            let miss = if miss.is_nan() { f64::INFINITY } else { miss };
            if miss > self.defect {
                (self.defect, worst) = (miss, ends[0]);
            }
            self.lifts[half_edge as usize] = beyond.round() as i32;
        }
        let is_closed = |sides: &[i32; 3]| sides.iter().sum::<i32>() == 0;
        let open = self
            .lifts
            .as_chunks::<3>()
            .0
            .iter()
            .position(|s| !is_closed(s));
        if let Some(face) = open {
            worst = given.mesh.faces()[face][0];
            self.defect = self.defect.max(1.0);
        }
        if self.defect <= PERIODS {
            return Ok(());
        }
        Err(DomainError::Periods {
            vertex: worst,
            defect: self.defect,
        })
    }
}

fn check_counts(given: &PeriodicForm, loops: &[Vec<u32>]) -> Result<(), DomainError> {
    let half_edges = 3 * given.mesh.face_count();
    let counts = [
        ("vectors of half-edges", given.form.len(), half_edges),
        ("ends of boundary loops", given.ends.len(), loops.len()),
    ];
    match counts.into_iter().find(|count| count.1 != count.2) {
        Some((what, given, needed)) => Err(DomainError::Count {
            what,
            given,
            needed,
        }),
        None => Ok(()),
    }
}

/// Sums of the imaginary part, modulo 1. The root is a vertex of the first boundary loop, if there is
/// one, so that its level is 0.
fn along_tree(topology: &Topology, form: &[[f64; 2]]) -> Vec<i64> {
    let units = |half_edge: u32| (form[half_edge as usize][1] * ONE as f64).round() as i64;
    let mut of = vec![-1_i64; topology.vertex_count()];
    let root = topology
        .boundary_loops()
        .first()
        .map_or(0, |l| topology.origin(l[0]));
    let mut queue = VecDeque::from([root]);
    if let Some(value) = of.get_mut(root as usize) {
        *value = 0;
    }
    while let Some(vertex) = queue.pop_front() {
        let here = of[vertex as usize];
        let mut last = NONE;
        let mut reach = |to: u32, along: i64| {
            if of[to as usize] < 0 {
                of[to as usize] = here.wrapping_add(along).rem_euclid(ONE);
                queue.push_back(to);
            }
        };
        for half_edge in topology.outgoing(vertex) {
            reach(topology.target(half_edge), units(half_edge));
            last = Topology::previous(half_edge);
        }
        // The last edge of a fan at a boundary has no half-edge from here.
        if last != NONE && topology.twin(last) == NONE {
            reach(topology.origin(last), -units(last));
        }
    }
    of.iter().map(|&value| value.max(0)).collect()
}
