//! Where the points of a mesh of quads go in the limit of Catmull-Clark subdivision.
//!
//! # Reference
//! [Halstead1993] §4 for smooth vertices; creases and corners from the eigenvectors of their rings;
//! [Wang2016] §4.1 uses limits as observations. Darts have masks of their own, computed here: the
//! smooth mask, which OpenSubdiv uses there, is not the limit.

use std::collections::BTreeMap;

use super::catmull_clark::Refined;
use super::eigen::{dart_tangents, left_fixed_vector, sector_tangent};
use super::ring::{Ring, Rule};
use super::sharpness::Rules;
use super::stencils::Stencils;
use super::topology::PolygonTopology;

/// Returns the limit position of every vertex of a refined mesh, over its control points.
///
/// Exact, also where edges are still semi-sharp: those rings are refined until they are not.
///
/// # Panics
/// If a face is no quad.
#[must_use]
pub fn limit_stencils(refined: &Refined, rules: Rules) -> Stencils {
    let topology = &refined.topology;
    assert!(topology.is_quad(), "limits need quads: refine once");
    let mut masks = Masks::new(rules);
    let count = topology.vertex_count();
    let special: Vec<Option<usize>> = (0..count as u32)
        .map(|v| {
            (!Ring::is_smooth(topology, &refined.sharpness, v))
                .then(|| masks.position(&Ring::of(topology, &refined.sharpness, v, rules.creases)))
        })
        .collect();
    let rows = Stencils::build(count, count, |v, out| match special[v] {
        Some(mask) => row(topology, v as u32, &masks.positions[mask], out),
        None => smooth_row(topology, v as u32, out),
    });
    rows.after(&refined.stencils)
}

/// Appends the limit of a vertex without sharp edges.
fn smooth_row(topology: &PolygonTopology, v: u32, out: &mut Vec<(u32, f64)>) {
    let n = topology.outgoing(v).count() as f64;
    let share = 1.0 / (n * (n + 5.0));
    out.push((v, n / (n + 5.0)));
    for h in topology.outgoing(v) {
        out.push((topology.target(h), 4.0 * share));
        out.push((opposite(topology, h), share));
    }
}

/// Returns two tangents of the limit surface at the origin of each of these half-edges, in their
/// faces, over the control points: rows `2 i` and `2 i + 1` belong to half-edge `i`.
///
/// Every sector between sharp edges has tangents of its own. The cross product of the two points to
/// the outside; their lengths mean nothing. The scheme itself has no tangent plane at corners of
/// several faces and on creases with more than three faces on a side: there they are the directions
/// of the sharp edges, and the crease with the slowest wave across it.
///
/// # Panics
/// If a face is no quad.
#[must_use]
pub fn limit_tangent_stencils(refined: &Refined, half_edges: &[u32], rules: Rules) -> Stencils {
    let topology = &refined.topology;
    assert!(topology.is_quad(), "limits need quads: refine once");
    let mut masks = Masks::new(rules);
    let tangents: Vec<[Vec<f64>; 2]> = half_edges
        .iter()
        .map(|&h| {
            let v = topology.origin(h);
            let place = topology.outgoing(v).position(|x| x == h);
            let place = place.expect("a half-edge leaves its origin");
            let ring = Ring::of(topology, &refined.sharpness, v, rules.creases);
            masks.tangents(&ring, place)
        })
        .collect();
    let columns = topology.vertex_count();
    let rows = Stencils::build(columns, 2 * half_edges.len(), |index, out| {
        let v = topology.origin(half_edges[index / 2]);
        row(topology, v, &tangents[index / 2][index % 2], out);
    });
    rows.after(&refined.stencils)
}

/// Appends the weights of a ring as a row over the vertices.
fn row(topology: &PolygonTopology, v: u32, weights: &[f64], out: &mut Vec<(u32, f64)>) {
    let vertices = std::iter::once(v)
        .chain(topology.neighbours(v))
        .chain(topology.outgoing(v).map(|h| opposite(topology, h)));
    let row = vertices.zip(weights.iter().copied());
    out.extend(row.filter(|&(_, weight)| weight != 0.0));
}

/// Returns the far corner of the quad in which a half-edge leaves its origin.
fn opposite(topology: &PolygonTopology, h: u32) -> u32 {
    topology.origin(topology.next(topology.next(h)))
}

/// Bits of a ring's sharpness.
type Key = (bool, Vec<u64>, Vec<u64>, u64);

/// The masks of rings that have been met.
struct Masks {
    rules: Rules,
    places: BTreeMap<Key, usize>,
    positions: Vec<Vec<f64>>,
    tangents: BTreeMap<(Key, usize), [Vec<f64>; 2]>,
}

impl Masks {
    fn new(rules: Rules) -> Self {
        Self {
            rules,
            places: BTreeMap::new(),
            positions: Vec::new(),
            tangents: BTreeMap::new(),
        }
    }

    /// Returns the place of a mask in `positions`.
    fn position(&mut self, ring: &Ring) -> usize {
        *self.places.entry(key(ring)).or_insert_with(|| {
            let mask = settled(ring, self.rules, |ring| vec![position_mask(ring)]);
            self.positions.extend(mask);
            self.positions.len() - 1
        })
    }

    fn tangents(&mut self, ring: &Ring, face: usize) -> [Vec<f64>; 2] {
        let rules = self.rules;
        let compute = || {
            let both = settled(ring, rules, |ring| tangent_masks(ring, face).to_vec());
            both.try_into().expect("two tangents")
        };
        self.tangents
            .entry((key(ring), face))
            .or_insert_with(compute)
            .clone()
    }
}

fn key(ring: &Ring) -> Key {
    let bits = |sharpness: &[f64]| sharpness.iter().map(|s| s.to_bits()).collect();
    let (edges, far) = (bits(&ring.edges), bits(&ring.far));
    (ring.closed, edges, far, ring.vertex.to_bits())
}

/// Returns masks of the ring that this one becomes once its sharpness is zero or infinite, over the
/// points of this one.
fn settled(ring: &Ring, rules: Rules, masks: impl Fn(&Ring) -> Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut ring = ring.clone();
    let mut steps = Vec::new();
    while !ring.is_settled() {
        let next = ring.refined(rules.creases);
        steps.push(ring.matrix(&next));
        ring = next;
    }
    let through = |weights: Vec<f64>| {
        let last = nalgebra::RowDVector::from_vec(weights);
        let whole = steps.iter().rev().fold(last, |row, step| row * step);
        whole.iter().copied().collect()
    };
    masks(&ring).into_iter().map(through).collect()
}

/// Returns the limit position of the vertex of a settled ring.
fn position_mask(ring: &Ring) -> Vec<f64> {
    let (n, m) = (ring.edges.len(), ring.faces());
    let mut mask = vec![0.0; 1 + n + m];
    match ring.rule() {
        Rule::Corner => mask[0] = 1.0,
        Rule::Crease(ends) => {
            mask[0] = 2.0 / 3.0;
            ends.iter().for_each(|&j| mask[1 + j] = 1.0 / 6.0);
        }
        Rule::Smooth => {
            let n_real = n as f64;
            let share = 1.0 / (n_real * (n_real + 5.0));
            mask[0] = n_real / (n_real + 5.0);
            mask[1..=n].fill(4.0 * share);
            mask[1 + n..].fill(share);
        }
        Rule::Dart => mask = left_fixed_vector(&ring.matrix(ring)),
    }
    mask
}

/// Returns two tangents in face `face` at the vertex of a settled ring.
fn tangent_masks(ring: &Ring, face: usize) -> [Vec<f64>; 2] {
    let n = ring.edges.len();
    match ring.rule() {
        Rule::Smooth => smooth_tangents(n),
        Rule::Dart => dart_tangents(ring),
        Rule::Crease(_) | Rule::Corner => {
            let sector = Sector::around(ring, face);
            if ring.rule() == Rule::Corner {
                sector.corner_tangents(ring)
            } else {
                sector.crease_tangents(ring)
            }
        }
    }
}

fn smooth_tangents(n: usize) -> [Vec<f64>; 2] {
    let turn = std::f64::consts::TAU / n as f64;
    let (c, half) = (turn.cos(), (0.5 * turn).cos());
    let edge = 1.0 + c + half * (2.0 * (9.0 + c)).sqrt();
    let wave = |shift: f64| {
        let value = |j: usize| (turn * j as f64 - shift).cos();
        let mut mask = vec![0.0; 1 + 2 * n];
        for j in 0..n {
            mask[1 + j] = edge * value(j);
            mask[1 + n + j] = value(j) + value(j + 1);
        }
        mask
    };
    [wave(0.0), wave(std::f64::consts::FRAC_PI_2)]
}

/// Faces between two sharp edges.
struct Sector {
    first_edge: usize,
    faces: usize,
}

impl Sector {
    /// Returns the sector of a face; a ring without sharp edges (a tagged corner) has the face alone.
    fn around(ring: &Ring, face: usize) -> Self {
        let n = ring.edges.len();
        let sharp = |j: usize| ring.edges[j % n] > 0.0;
        if !ring.edges.iter().any(|&s| s > 0.0) {
            return Self {
                first_edge: face,
                faces: 1,
            };
        }
        let back = (0..n).find(|&i| sharp(face + n - i)).unwrap_or(0);
        let on = (1..=n).find(|&i| sharp(face + i)).unwrap_or(1);
        Self {
            first_edge: (face + n - back) % n,
            faces: back + on,
        }
    }

    fn edge(&self, ring: &Ring, i: usize) -> usize {
        1 + (self.first_edge + i) % ring.edges.len()
    }

    /// Along the two sharp edges.
    fn corner_tangents(&self, ring: &Ring) -> [Vec<f64>; 2] {
        let towards = |i: usize| {
            let mut mask = vec![0.0; 1 + ring.edges.len() + ring.faces()];
            mask[0] = -1.0;
            mask[self.edge(ring, i)] = 1.0;
            mask
        };
        [towards(0), towards(self.faces)]
    }

    /// Along the crease, and across it into the sector.
    fn crease_tangents(&self, ring: &Ring) -> [Vec<f64>; 2] {
        let n = ring.edges.len();
        let size = 1 + n + ring.faces();
        let (mut along, mut across) = (vec![0.0; size], vec![0.0; size]);
        along[self.edge(ring, 0)] = 0.5;
        along[self.edge(ring, self.faces)] = -0.5;
        if self.faces == 1 {
            across[0] = -6.0;
            for i in [0, 1] {
                across[self.edge(ring, i)] = 3.0;
            }
            return [along, across];
        }
        let local = sector_tangent(self.faces);
        across[0] = local[0];
        for i in 0..=self.faces {
            across[self.edge(ring, i)] = local[1 + i];
        }
        for i in 0..self.faces {
            across[1 + n + (self.first_edge + i) % n] = local[2 + self.faces + i];
        }
        [along, across]
    }
}
