//! A mesh flattened triangle by triangle by a closed complex 1-form, and flips that unfold it.
//!
//! # Notation
//! `ω(h)` the form along half-edge `h`, a vector of the plane; a face is *folded* if its three vectors
//! do not turn to the left.

use std::f64::consts::TAU;

use msplines_common::mesh::{FlipComplex, NONE, Topology, TriangleMesh, carry_flip, sides_around};

/// A vector of the plane.
pub(crate) type Flat = [f64; 2];

/// Triangles of the plane, glued along half-edges by translations.
#[derive(Clone, Debug)]
pub(crate) struct FlatComplex {
    glued: FlipComplex,
    vectors: Vec<Flat>,
}

impl FlatComplex {
    /// Returns the triangles of a triangulation, flattened by a form on its half-edges.
    pub(crate) fn of(glued: &FlipComplex, form: Vec<Flat>) -> Self {
        Self {
            glued: glued.clone(),
            vectors: form,
        }
    }

    pub(crate) fn faces(&self) -> &[[u32; 3]] {
        self.glued.faces()
    }

    pub(crate) fn into_vectors(self) -> Vec<Flat> {
        self.vectors
    }

    /// The three vectors of a face.
    pub(crate) fn sides(&self, face: u32) -> [Flat; 3] {
        std::array::from_fn(|i| self.vectors[3 * face as usize + i])
    }

    /// Twice the signed area of a face.
    pub(crate) fn doubled_area(&self, face: u32) -> f64 {
        let [a, b] = [0, 1].map(|i| self.vectors[(3 * face + i) as usize]);
        cross(a, b)
    }

    /// Flips edges of folded faces while that leaves less folded, keeping an ordinary mesh.
    ///
    /// The two faces of an edge are replaced where that raises the smaller one of their areas; so no
    /// sequence of flips comes back to where it was.
    pub(crate) fn unfold(&mut self) {
        let mut stack: Vec<u32> = (0..self.faces().len() as u32)
            .rev()
            .filter(|&face| self.doubled_area(face) <= 0.0)
            .flat_map(|face| 3 * face..3 * face + 3)
            .collect();
        while let Some(half_edge) = stack.pop() {
            let twin = self.glued.twin(half_edge);
            if twin == NONE || twin / 3 == half_edge / 3 {
                continue;
            }
            let before = [half_edge, twin].map(|h| self.doubled_area(h / 3));
            if before.iter().all(|&area| area > 0.0) {
                continue;
            }
            let pair = [half_edge, twin];
            let [bc, ca, ad, db] = sides_around(pair).map(|h| self.vectors[h as usize]);
            let after = [cross(ca, ad), cross(db, bc)];
            let least = |areas: [f64; 2]| areas[0].min(areas[1]);
            if least(after) <= least(before) || !self.glued.stays_simplicial(half_edge) {
                continue;
            }
            let diagonal = [db[0] + bc[0], db[1] + bc[1]];
            let (pair, outer) = self.glued.flip(half_edge);
            carry_flip(&mut self.vectors, pair, [diagonal, diagonal.map(|x| -x)]);
            stack.extend(outer);
        }
    }

    /// Half-edges out of each vertex, one of each; on a boundary any one.
    pub(crate) fn outgoing(&self, vertices: usize) -> Vec<u32> {
        let mut outgoing = vec![NONE; vertices];
        for h in (0..self.vectors.len() as u32).rev() {
            outgoing[self.glued.origin(h) as usize] = h;
        }
        outgoing
    }

    /// The half-edges around an inner vertex, counter-clockwise; nothing on a boundary.
    pub(crate) fn star(&self, start: u32) -> Option<Vec<u32>> {
        let mut star = vec![start];
        loop {
            let next = self.glued.twin(Topology::previous(star[star.len() - 1]));
            if next == NONE {
                return None;
            }
            if next == start {
                return Some(star);
            }
            star.push(next);
        }
    }

    pub(crate) fn target(&self, half_edge: u32) -> u32 {
        self.glued.origin(Topology::next(half_edge))
    }

    /// Whether all faces around an inner vertex are unfolded and their angles sum to 2π.
    pub(crate) fn is_regular(&self, star: &[u32]) -> bool {
        let mut turned = 0.0;
        for &half_edge in star {
            let along = self.vectors[half_edge as usize];
            let back = self.vectors[Topology::previous(half_edge) as usize].map(|x| -x);
            let doubled = cross(along, back);
            if doubled <= 0.0 {
                return false;
            }
            turned += doubled.atan2(along[0] * back[0] + along[1] * back[1]);
        }
        turned < 1.5 * TAU
    }

    /// `1 - s/2` for the changes of sign `s` of the real part of `e^{-iθ} ω` around an inner vertex.
    pub(crate) fn index(&self, star: &[u32], angle: f64) -> i32 {
        let (sin, cos) = angle.sin_cos();
        let signs: Vec<bool> = star
            .iter()
            .map(|&h| self.vectors[h as usize])
            .map(|[u, v]| u * cos + v * sin > 0.0)
            .collect();
        let changes = (0..signs.len()).filter(|&i| signs[i] != signs[(i + 1) % signs.len()]);
        1 - changes.count() as i32 / 2
    }
}

/// Returns a mesh of the given faces over the same vertices.
pub(crate) fn remeshed(mesh: &TriangleMesh, faces: &[[u32; 3]]) -> Option<TriangleMesh> {
    TriangleMesh::build(mesh.positions().to_vec(), faces.to_vec()).ok()
}

pub(crate) fn cross(a: Flat, b: Flat) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}
