//! The rules of one vertex: masks of Catmull-Clark subdivision with creases.
//!
//! # Notation
//! A vertex `v` has the edges `0..n` counter-clockwise, to neighbours `e`, and between edges `j` and
//! `j + 1` the face `j`, with centre `f` and, if it is a quad, opposite corner `d`. An open ring, of a
//! boundary vertex, has one face less than edges.
//!
//! # Reference
//! [CatmullClark1978]; [DeRose1998] §3; semi-sharp vertices as in OpenSubdiv, whose rules blend the
//! masks of this level and the next one by the mean sharpness of what stops being sharp. Deviation: an
//! edge never counts as more than sharp, where OpenSubdiv extrapolates if Chaikin's rule takes a
//! sharpness above one to zero; refined points agree otherwise, see `tests/reference`.

use super::sharpness::{CreaseRule, Sharpness};
use super::topology::PolygonTopology;

/// How sharp the edges around a vertex and the vertex itself are.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ring {
    /// Whether the faces go all around.
    pub closed: bool,
    /// Sharpness of every edge.
    pub edges: Vec<f64>,
    /// By Chaikin's rule: mean sharpness of the other semi-sharp edges at the far end of every edge, or
    /// zero.
    pub far: Vec<f64>,
    /// Sharpness of the vertex.
    pub vertex: f64,
}

/// What happens to a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    /// It moves with all its neighbours.
    Smooth,
    /// The same, at the end of a crease.
    Dart,
    /// It moves with its neighbours along two sharp edges.
    Crease([usize; 2]),
    /// It stays.
    Corner,
}

/// Weights of a vertex, its neighbours along edges and the centres of its faces.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct VertexMask {
    pub vertex: f64,
    pub edges: Vec<f64>,
    pub faces: Vec<f64>,
}

impl Ring {
    /// Returns the ring of a vertex, from [`PolygonTopology::vertex_half_edge`] on.
    pub(super) fn of(
        topology: &PolygonTopology,
        sharpness: &Sharpness,
        vertex: u32,
        rule: CreaseRule,
    ) -> Self {
        let around = |v: u32| {
            let edges = topology.spokes(v).map(|h| topology.edge(h));
            edges.map(|e| sharpness.edge(e))
        };
        let far = |(end, s): (u32, f64)| match rule {
            CreaseRule::Chaikin if is_semi_sharp(s) => SemiSharp::among(around(end)).others(s),
            _ => 0.0,
        };
        let ends = topology.neighbours(vertex).zip(around(vertex));
        Self {
            closed: !topology.is_boundary_vertex(vertex),
            edges: around(vertex).collect(),
            far: ends.map(far).collect(),
            vertex: sharpness.vertex(vertex),
        }
    }

    /// Returns whether neither a vertex nor any of its edges is sharp; those of the boundary are.
    pub(super) fn is_smooth(
        topology: &PolygonTopology,
        sharpness: &Sharpness,
        vertex: u32,
    ) -> bool {
        let mut outgoing = topology.outgoing(vertex);
        sharpness.vertex(vertex) == 0.0
            && !topology.is_boundary_vertex(vertex)
            && outgoing.all(|h| sharpness.edge(topology.edge(h)) == 0.0)
    }

    /// Returns the number of faces.
    pub(super) fn faces(&self) -> usize {
        self.edges.len() - usize::from(!self.closed)
    }

    /// Returns whether subdivision does not change the sharpness any more.
    pub(super) fn is_settled(&self) -> bool {
        let settled = |s: &f64| *s == 0.0 || s.is_infinite();
        settled(&self.vertex) && self.edges.iter().all(settled)
    }

    /// Returns the rule of the vertex.
    pub(super) fn rule(&self) -> Rule {
        if self.vertex > 0.0 {
            return Rule::Corner;
        }
        let mut sharp = (0..self.edges.len()).filter(|&j| self.edges[j] > 0.0);
        match (sharp.next(), sharp.next(), sharp.next()) {
            (None, ..) => Rule::Smooth,
            (Some(_), None, _) => Rule::Dart,
            (Some(a), Some(b), None) => Rule::Crease([a, b]),
            _ => Rule::Corner,
        }
    }

    /// Returns the ring after one refinement.
    pub(super) fn refined(&self, rule: CreaseRule) -> Self {
        let chaikin = match rule {
            CreaseRule::Uniform => SemiSharp::default(),
            CreaseRule::Chaikin => SemiSharp::among(self.edges.iter().copied()),
        };
        let edge = |&s: &f64| fallen(s, chaikin.others(s));
        // In its next ring the far piece of an edge is the only other one that is sharp at its end.
        let far = |(&s, &others): (&f64, &f64)| match fallen(s, others) {
            piece if rule == CreaseRule::Chaikin && is_semi_sharp(piece) => piece,
            _ => 0.0,
        };
        Self {
            closed: self.closed,
            edges: self.edges.iter().map(edge).collect(),
            far: self.edges.iter().zip(&self.far).map(far).collect(),
            vertex: (self.vertex - 1.0).max(0.0),
        }
    }

    /// Returns how the vertex moves, given the ring of the next level.
    pub(super) fn vertex_mask(&self, child: &Self) -> VertexMask {
        let mask = self.mask_of(self.rule());
        if self.rule() == child.rule() {
            return mask;
        }
        let weight = self.transition(child);
        let next = self.mask_of(child.rule());
        let blend = |a: &[f64], b: &[f64]| -> Vec<f64> {
            let pairs = a.iter().zip(b);
            pairs
                .map(|(x, y)| weight * x + (1.0 - weight) * y)
                .collect()
        };
        VertexMask {
            vertex: weight * mask.vertex + (1.0 - weight) * next.vertex,
            edges: blend(&mask.edges, &next.edges),
            faces: blend(&mask.faces, &next.faces),
        }
    }

    /// Returns the mean sharpness, at most 1, of what is sharp here but not in `child`.
    fn transition(&self, child: &Self) -> f64 {
        let edges = self.edges.iter().zip(&child.edges);
        let pairs = edges.chain(std::iter::once((&self.vertex, &child.vertex)));
        let ending = pairs.filter(|(s, next)| **s > 0.0 && **next == 0.0);
        let (count, sum) = ending.fold((0.0, 0.0), |(n, sum), (s, _)| (n + 1.0, sum + s));
        if count == 0.0 {
            return 0.0;
        }
        f64::min(sum / count, 1.0)
    }

    fn mask_of(&self, rule: Rule) -> VertexMask {
        let n = self.edges.len();
        let mut mask = VertexMask {
            vertex: 1.0,
            edges: vec![0.0; n],
            faces: vec![0.0; self.faces()],
        };
        match rule {
            Rule::Corner => {}
            Rule::Crease(ends) => {
                mask.vertex = 0.75;
                ends.iter().for_each(|&j| mask.edges[j] = 0.125);
            }
            Rule::Smooth | Rule::Dart => {
                let n = n as f64;
                mask.vertex = (n - 2.0) / n;
                mask.edges.fill(1.0 / (n * n));
                mask.faces.fill(1.0 / (n * n));
            }
        }
        mask
    }

    /// Returns the matrix that refines the points of a ring of quads: the vertex, its neighbours,
    /// and the opposite corners of its faces.
    pub(super) fn matrix(&self, child: &Self) -> nalgebra::DMatrix<f64> {
        let (n, m) = (self.edges.len(), self.faces());
        let size = 1 + n + m;
        let mut matrix = nalgebra::DMatrix::zeros(size, size);
        let face = |j: usize| [0, 1 + j, 1 + (j + 1) % n, 1 + n + j];
        let mask = self.vertex_mask(child);
        matrix[(0, 0)] = mask.vertex;
        for j in 0..n {
            matrix[(0, 1 + j)] += mask.edges[j];
        }
        for j in 0..m {
            for column in face(j) {
                matrix[(0, column)] += 0.25 * mask.faces[j];
                matrix[(1 + n + j, column)] = 0.25;
            }
        }
        for j in 0..n {
            let row = 1 + j;
            let sharp = sharp_fraction(self.edges[j], [child.edges[j], child.far[j]]);
            for end in [0, row] {
                matrix[(row, end)] += 0.5 * sharp + 0.25 * (1.0 - sharp);
            }
            if sharp < 1.0 {
                for face_index in [j, (j + n - 1) % n] {
                    for column in face(face_index) {
                        matrix[(row, column)] += 0.0625 * (1.0 - sharp);
                    }
                }
            }
        }
        matrix
    }
}

/// Returns how much the midpoint counts in the new point of an edge, given the sharpness of its two
/// pieces: all where both stay sharp, as they may by Chaikin's rule however little the edge is.
pub(super) fn sharp_fraction(sharpness: f64, pieces: [f64; 2]) -> f64 {
    if pieces.iter().all(|&piece| piece > 0.0) {
        1.0
    } else {
        sharpness.min(1.0)
    }
}

fn is_semi_sharp(sharpness: f64) -> bool {
    sharpness > 0.0 && sharpness.is_finite()
}

/// Returns the sharpness of a piece of an edge, at whose end the other semi-sharp edges have this mean.
fn fallen(sharpness: f64, others: f64) -> f64 {
    if others > 0.0 {
        (0.75 * sharpness + 0.25 * others - 1.0).max(0.0)
    } else {
        (sharpness - 1.0).max(0.0)
    }
}

/// The semi-sharp edges around a vertex. Those that are sharp for ever do not count, as in OpenSubdiv.
#[derive(Clone, Copy, Debug, Default)]
struct SemiSharp {
    count: u32,
    sum: f64,
}

impl SemiSharp {
    fn among(edges: impl Iterator<Item = f64>) -> Self {
        edges
            .filter(|&s| is_semi_sharp(s))
            .fold(Self::default(), |all, s| Self {
                count: all.count + 1,
                sum: all.sum + s,
            })
    }

    /// Returns the mean without an edge of this sharpness, or zero if it is no such edge or the only
    /// one.
    fn others(&self, own: f64) -> f64 {
        if is_semi_sharp(own) && self.count > 1 {
            (self.sum - own) / f64::from(self.count - 1)
        } else {
            0.0
        }
    }
}
