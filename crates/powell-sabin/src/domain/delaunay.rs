//! Delaunay triangles in the flat metric.

use std::collections::BTreeSet;

use msplines_common::mesh::{NONE, Topology, TriangleMesh};

use super::refine::star;
use super::{DomainError, FlatDomain, POSITIVE};
use crate::vector::{add, cross, dot, norm, scale};

/// By how much the cotangents opposite to an edge may sum to less than zero, relative to them:
/// cocircular corners count as Delaunay.
const TOLERANCE: f64 = 1e-10;

/// Flips allowed per edge; the flips of one pass are far fewer.
const FLIPS_PER_EDGE: usize = 50;

impl FlatDomain {
    /// Returns the domain of the same vertices and flat metric whose edges are flipped until they are
    /// Delaunay in that metric, as far as faces remain those of an ordinary mesh.
    ///
    /// Thin faces cost digits and fairness, so that this is worth its O(n log n) where the edges come
    /// from another metric. A spline over this domain is another surface.
    ///
    /// # Reference
    /// [Fisher2007] §2.3, in the metric of the 1-form.
    ///
    /// # Errors
    /// None is expected: flips keep faces positive.
    pub fn flat_delaunay(&self) -> Result<Self, DomainError> {
        self.flipped((0..self.edge_vectors.len() as u32).collect())
    }

    /// Returns the domain flipped around some vertices, as far as it takes.
    pub(crate) fn delaunay_around(
        &self,
        vertices: std::ops::Range<u32>,
    ) -> Result<Self, DomainError> {
        self.flipped(star(self.topology(), vertices))
    }

    fn flipped(&self, mut stack: Vec<u32>) -> Result<Self, DomainError> {
        let topology = self.topology();
        let edges = (0..topology.edge_count() as u32).map(|e| sorted(topology.edge_vertices(e)));
        let mut flips = Flips {
            faces: self.mesh.faces().to_vec(),
            vectors: self.edge_vectors.clone(),
            twins: (0..self.edge_vectors.len() as u32)
                .map(|h| topology.twin(h))
                .collect(),
            edges: edges.collect(),
        };
        stack.reverse();
        let mut left = FLIPS_PER_EDGE * topology.edge_count();
        while let Some(h) = stack.pop() {
            if left > 0 && flips.is_bad(h) {
                stack.extend(flips.flip(h));
                left -= 1;
            }
        }
        let mesh = TriangleMesh::build(self.mesh.positions().to_vec(), flips.faces)?;
        Self::build(mesh, flips.vectors)
    }
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

struct Flips {
    faces: Vec<[u32; 3]>,
    vectors: Vec<[f64; 2]>,
    twins: Vec<u32>,
    edges: BTreeSet<[u32; 2]>,
}

impl Flips {
    fn origin(&self, h: u32) -> u32 {
        self.faces[(h / 3) as usize][(h % 3) as usize]
    }

    fn vector(&self, h: u32) -> [f64; 2] {
        self.vectors[h as usize]
    }

    /// Cosine and sine of the angle opposite to a half-edge, times the same length.
    fn opposite(&self, h: u32) -> [f64; 2] {
        let (out, back) = (
            self.vector(Topology::previous(h)),
            scale(-1.0, self.vector(Topology::next(h))),
        );
        let size = norm(out) * norm(back);
        [dot(out, back) / size, cross(out, back) / size]
    }

    /// Whether an edge is not Delaunay and its flip leaves an ordinary mesh of positive faces.
    fn is_bad(&self, h: u32) -> bool {
        let twin = self.twins[h as usize];
        if twin == NONE {
            return false;
        }
        let ([cosine, sine], [other_cosine, other_sine]) = (self.opposite(h), self.opposite(twin));
        if cosine * other_sine + other_cosine * sine >= -TOLERANCE {
            return false;
        }
        let apexes = [h, twin].map(|h| self.origin(Topology::previous(h)));
        let diagonal = self.diagonal(h);
        let positive = [
            [Topology::previous(h), Topology::next(twin)],
            [Topology::previous(twin), Topology::next(h)],
        ]
        .into_iter()
        .all(|[a, b]| {
            let (a, b) = (self.vector(a), self.vector(b));
            cross(a, b) > 2.0 * POSITIVE * norm(a) * norm(b)
                && [a, b].iter().all(|&side| {
                    cross(side, diagonal).abs() > 2.0 * POSITIVE * norm(side) * norm(diagonal)
                })
        });
        positive && apexes[0] != apexes[1] && !self.edges.contains(&sorted(apexes))
    }

    /// From the corner opposite in the twin's face to that in the own face.
    fn diagonal(&self, h: u32) -> [f64; 2] {
        let back = add(
            self.vector(Topology::next(self.twins[h as usize])),
            self.vector(Topology::previous(h)),
        );
        scale(-1.0, back)
    }

    /// Replaces `a → b` between the faces `(a, b, c)` and `(b, a, d)` by `c → d` between `(c, a, d)`
    /// and `(d, b, c)`; returns the four sides around.
    fn flip(&mut self, h: u32) -> [u32; 4] {
        let twin = self.twins[h as usize];
        let diagonal = self.diagonal(h);
        let sides = [
            Topology::previous(h),
            Topology::next(twin),
            Topology::previous(twin),
            Topology::next(h),
        ];
        let [c, a, d, b] = sides.map(|side| self.origin(side));
        let (vectors, outer) = (
            sides.map(|s| self.vector(s)),
            sides.map(|s| self.twins[s as usize]),
        );
        self.edges.remove(&sorted([a, b]));
        self.edges.insert(sorted([c, d]));
        let (first, second) = (h / 3, twin / 3);
        self.faces[first as usize] = [c, a, d];
        self.faces[second as usize] = [d, b, c];
        // Sides by place: c → a, a → d in the first face, d → b, b → c in the second. A side may be the
        // twin of another of the four.
        let places = [3 * first, 3 * first + 1, 3 * second, 3 * second + 1];
        for k in 0..4 {
            let place = places[k] as usize;
            let inner = sides.iter().position(|&side| side == outer[k]);
            self.vectors[place] = vectors[k];
            self.twins[place] = inner.map_or(outer[k], |other| places[other]);
            if inner.is_none() && outer[k] != NONE {
                self.twins[outer[k] as usize] = places[k];
            }
        }
        let ends = [3 * first + 2, 3 * second + 2];
        self.vectors[ends[0] as usize] = diagonal;
        self.vectors[ends[1] as usize] = scale(-1.0, diagonal);
        self.twins[ends[0] as usize] = ends[1];
        self.twins[ends[1] as usize] = ends[0];
        places
    }
}
