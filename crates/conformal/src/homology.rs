//! Integer closed 1-forms of a closed surface, by a tree of vertices and a tree of faces.
//!
//! A spanning tree of the vertices and a spanning tree of the faces that crosses no edge of the first
//! leave 2g edges. Each closes one loop of vertices, and one loop of faces; the form that counts the
//! crossings of the latter is closed, and the 2g forms are a basis of the integer cohomology.
//!
//! # Notation
//! `g` genus; `W_k` integer closed forms, `k < 2g`; `γ_k` loops of half-edges.
//!
//! # Reference
//! [Erickson2005] §3; [Gu2003] §4.1.

use msplines_common::mesh::{NONE, SplitMesh, SurfacePoint, Topology};

use crate::error::ConformalError;

/// An integer 1-form with small support: half-edges in ascending order, each with its value; the twin
/// of a half-edge is listed too, with the opposite value.
pub type Cocycle = Vec<(u32, i32)>;

/// Integer closed 1-forms and loops of a closed connected surface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Homology {
    /// The forms `W_k`, a basis of the integer cohomology; empty for a sphere.
    pub cocycles: Vec<Cocycle>,
    /// The loops `γ_k`, each as half-edges head to tail, a basis of the integer homology.
    pub loops: Vec<Vec<u32>>,
}

impl Homology {
    /// Builds the forms and loops of a closed surface, in O(n + g √n) on scans.
    ///
    /// # Errors
    /// A boundary, or several components.
    pub fn build(topology: &Topology) -> Result<Self, ConformalError> {
        if let Some(boundary) = topology.boundary_loops().first() {
            return Err(ConformalError::Boundary {
                loops: topology.boundary_loops().len(),
                vertex: topology.origin(boundary[0]),
            });
        }
        let (_, components) = topology.components();
        if components != 1 {
            return Err(ConformalError::NotConnected { components });
        }
        let vertices = vertex_tree(topology);
        let mut in_tree = vec![false; topology.edge_count()];
        for &half_edge in vertices.iter().filter(|&&h| h != NONE) {
            in_tree[topology.edge(half_edge) as usize] = true;
        }
        let faces = face_tree(topology, &in_tree);
        for &half_edge in faces.iter().filter(|&&h| h != NONE) {
            in_tree[topology.edge(half_edge) as usize] = true;
        }
        let left = (0..topology.edge_count() as u32).filter(|&edge| !in_tree[edge as usize]);
        let left: Vec<u32> = left.map(|edge| topology.edge_half_edge(edge)).collect();
        Ok(Self {
            cocycles: left
                .iter()
                .map(|&h| crossings(topology, &faces, h))
                .collect(),
            loops: left
                .iter()
                .map(|&h| closed_path(topology, &vertices, h))
                .collect(),
        })
    }

    /// Returns the same forms and loops on a mesh whose faces were split.
    ///
    /// Every new vertex is taken for a corner of the edge or face that it lies on: so values along new
    /// edges are values along old ones, or zero.
    pub(crate) fn on_split(&self, topology: &Topology, split: &SplitMesh) -> Self {
        let corners = |face: u32| topology.faces()[face as usize];
        let old = 0..topology.vertex_count() as u32;
        let first_corner = |place: &SurfacePoint| {
            let corner = place.at.iter().position(|&weight| weight > 0.0);
            corners(place.face)[corner.unwrap_or(0)]
        };
        let bases: Vec<u32> = old.chain(split.places.iter().map(first_corner)).collect();
        let carried = |cocycle: &Cocycle| {
            let mut values = Cocycle::new();
            for sides in cocycle.chunk_by(|a, b| a.0 / 3 == b.0 / 3) {
                let parent = sides[0].0 / 3;
                let mut along = [0; 3];
                sides
                    .iter()
                    .for_each(|&(h, value)| along[(h % 3) as usize] = value);
                let corner = |v: u32| {
                    let base = bases[v as usize];
                    corners(parent).iter().position(|&c| c == base).unwrap_or(0)
                };
                let first = split.parents.partition_point(|&p| p < parent);
                let last = split.parents.partition_point(|&p| p <= parent);
                for half_edge in 3 * first as u32..3 * last as u32 {
                    let ends = [half_edge, Topology::next(half_edge)];
                    let [i, j] = ends.map(|h| corner(split.mesh.topology().origin(h)));
                    let value = match (j + 3 - i) % 3 {
                        0 => 0,
                        1 => along[i],
                        _ => -along[j],
                    };
                    if value != 0 {
                        values.push((half_edge, value));
                    }
                }
            }
            values
        };
        let edge = |path: &Vec<u32>| {
            let ends = path
                .iter()
                .map(|&h| [topology.origin(h), topology.target(h)]);
            let pieces = split.edges(&ends.collect::<Vec<_>>());
            let fine = split.mesh.topology();
            let along = |[from, to]: [u32; 2]| fine.outgoing(from).find(|&h| fine.target(h) == to);
            pieces.into_iter().filter_map(along).collect()
        };
        Self {
            cocycles: self.cocycles.iter().map(carried).collect(),
            loops: self.loops.iter().map(edge).collect(),
        }
    }

    /// Returns the number of handles.
    #[must_use]
    pub fn genus(&self) -> usize {
        self.cocycles.len() / 2
    }

    /// Returns the period `∮_{γ_k} ω` of a form with one value per half-edge, for each loop.
    #[must_use]
    pub fn periods(&self, form: impl Fn(u32) -> f64) -> Vec<f64> {
        let periods = self.loops.iter();
        periods
            .map(|half_edges| half_edges.iter().map(|&h| form(h)).sum())
            .collect()
    }

    /// Returns the integers `∮_{γ_j} W_k`, row `j` by row.
    #[must_use]
    pub fn integer_periods(&self) -> Vec<Vec<i64>> {
        let value = |cocycle: &Cocycle, half_edge: u32| {
            let found = cocycle.binary_search_by_key(&half_edge, |entry| entry.0);
            found.map_or(0, |place| i64::from(cocycle[place].1))
        };
        let period = |path: &Vec<u32>, cocycle| path.iter().map(|&h| value(cocycle, h)).sum();
        let row = |path| self.cocycles.iter().map(|w| period(path, w)).collect();
        self.loops.iter().map(row).collect()
    }
}

/// For each vertex the half-edge that leads to it from its parent, breadth first; `NONE` at the root.
fn vertex_tree(topology: &Topology) -> Vec<u32> {
    let mut parents = vec![NONE; topology.vertex_count()];
    let mut reached = vec![false; topology.vertex_count()];
    let mut queue = vec![0u32];
    reached[0] = true;
    let mut next = 0;
    while next < queue.len() {
        for half_edge in topology.outgoing(queue[next]) {
            let target = topology.target(half_edge);
            if !std::mem::replace(&mut reached[target as usize], true) {
                parents[target as usize] = half_edge;
                queue.push(target);
            }
        }
        next += 1;
    }
    parents
}

/// For each face its half-edge to the parent, breadth first over edges outside of the vertex tree;
/// `NONE` at the root.
///
/// The half-edge itself is kept: two faces may share more than one edge.
fn face_tree(topology: &Topology, in_tree: &[bool]) -> Vec<u32> {
    let mut parents = vec![NONE; topology.face_count()];
    let mut reached = vec![false; topology.face_count()];
    let mut queue = vec![0u32];
    reached[0] = true;
    let mut next = 0;
    while next < queue.len() {
        let face = queue[next];
        for half_edge in 3 * face..3 * face + 3 {
            let twin = topology.twin(half_edge);
            let free = !in_tree[topology.edge(half_edge) as usize];
            if free && !std::mem::replace(&mut reached[(twin / 3) as usize], true) {
                parents[(twin / 3) as usize] = twin;
                queue.push(twin / 3);
            }
        }
        next += 1;
    }
    parents
}

/// Counts how the loop of faces through an edge crosses edges from left to right.
///
/// The path leaves the face of `half_edge` over it, and returns over the trees' root.
fn crossings(topology: &Topology, parents: &[u32], half_edge: u32) -> Cocycle {
    let twin = topology.twin(half_edge);
    let mut crossed = vec![half_edge];
    crossed.extend(path_up(parents, twin / 3, |h| topology.twin(h) / 3));
    let back = path_up(parents, half_edge / 3, |h| topology.twin(h) / 3);
    crossed.extend(back.into_iter().map(|h| topology.twin(h)));
    let mut values: Vec<(u32, i32)> = crossed
        .iter()
        .flat_map(|&h| [(h, 1), (topology.twin(h), -1)])
        .collect();
    values.sort_unstable_by_key(|entry| entry.0);
    let mut merged: Cocycle = Vec::with_capacity(values.len());
    for (half_edge, value) in values {
        match merged.last_mut() {
            Some(last) if last.0 == half_edge => last.1 += value,
            _ => merged.push((half_edge, value)),
        }
    }
    merged.retain(|entry| entry.1 != 0);
    merged
}

/// The loop of vertices that an edge closes in the tree, without what it would run to and fro.
fn closed_path(topology: &Topology, parents: &[u32], half_edge: u32) -> Vec<u32> {
    let up = |vertex| path_up(parents, vertex, |h| topology.origin(h));
    let mut to = up(topology.origin(half_edge));
    let mut from = up(topology.target(half_edge));
    while let (Some(a), Some(b)) = (to.last(), from.last())
        && a == b
    {
        to.pop();
        from.pop();
    }
    let down = to.into_iter().rev();
    let back = from.into_iter().map(|h| topology.twin(h));
    down.chain([half_edge]).chain(back).collect()
}

/// The parent half-edges from a node of a tree up to its root.
fn path_up(parents: &[u32], start: u32, parent: impl Fn(u32) -> u32) -> Vec<u32> {
    let mut node = start;
    let mut path = Vec::new();
    while parents[node as usize] != NONE {
        path.push(parents[node as usize]);
        node = parent(parents[node as usize]);
    }
    path
}
