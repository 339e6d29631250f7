//! Creases: edges across which a spline is continuous but need not be smooth.
//!
//! # Notation
//! `C` the vertices inside crease curves and at corners. The energy of a spline without creases is
//! `Σᵢ (L f)ᵢ² / Aᵢ` over all vertices. With creases the terms of `C` go, which leaves the normals on
//! both sides of a crease free; what is left free along the crease is bound by the bending of the
//! crease as a curve, `γ h̄ Σ hᵢ (f'')ᵢ²`, with the second difference `f''` along the curve, `hᵢ` the
//! length that belongs to vertex `i` and `h̄` the mean length of crease edges, which makes it the
//! bending of a strip of that width. Corners bend freely. The tip of a crease that ends inside the
//! surface is an ordinary vertex.
//!
//! Cutting the surface along creases with natural conditions on both sides is no alternative: those
//! force the normal derivative to zero there, and give a worse surface than no creases at all.
//!
//! # Reference
//! [Hou2017] §9. Deviation: the paper names sharp features as future work; this energy is ours.

use msplines_common::linalg::SymmetricMatrix;
use msplines_common::mesh::{NONE, TriangleMesh, edge_pieces};
use msplines_common::operators::Operators;

use crate::FitError;

/// Weight `γ` of the bending along creases; errors are flat between 3 and 100.
const CURVE_BENDING: f64 = 10.0;

/// Share of the smooth energy that stays at crease vertices, so that the energy of all splines with
/// one knot is definite; anything between 1e-8 and 1e-3 gives the same surface.
const SMOOTH_SHARE: f64 = 1e-6;

/// Crease curves that turn by more than this at a vertex have a corner there, in radians.
const CORNER_TURN: f64 = std::f64::consts::FRAC_PI_4;

/// The turn of a curve is that between the vertices so many edges before and after, where it goes on
/// for so long: the edges of a scan zigzag along its creases, and every corner is free.
const CORNER_REACH: usize = 3;

/// Creases found by their angle have at least so many edges: on a scan shorter ones are noise.
const SHORTEST_CREASE: usize = 5;

/// Edges of one mesh across which splines may have a crease.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Creases {
    /// Ascending pairs of ascending vertices.
    edges: Vec<[u32; 2]>,
}

impl Creases {
    /// Returns no creases.
    #[must_use]
    pub fn none() -> Self {
        Self::default()
    }

    /// Returns the inner edges whose faces meet at more than `angle` radians.
    ///
    /// Marking too many edges costs little, missing some costs much: between 20° and 50° the error of
    /// a mechanical part grows with the angle.
    #[must_use]
    pub fn sharper_than(mesh: &TriangleMesh, angle: f64) -> Self {
        let topology = mesh.topology();
        let normal = |face: u32| {
            let [a, b, c] = mesh.faces()[face as usize].map(|v| mesh.positions()[v as usize]);
            (b - a).cross(&(c - a))
        };
        let mut edges = Vec::new();
        for edge in 0..topology.edge_count() as u32 {
            let half_edge = topology.edge_half_edge(edge);
            let twin = topology.twin(half_edge);
            if twin == NONE {
                continue;
            }
            let (one, other) = (normal(half_edge / 3), normal(twin / 3));
            // The angle between two vectors, accurate for small ones too.
            if one.cross(&other).norm().atan2(one.dot(&other)) > angle {
                edges.push(topology.edge_vertices(edge));
            }
        }
        Self::sorted(edges).without_fragments()
    }

    /// Returns the creases less the connected pieces of few edges.
    fn without_fragments(self) -> Self {
        let ends = Ends::of(&self.edges);
        let mut kept = vec![false; self.edges.len()];
        let mut seen = vec![false; self.edges.len()];
        for start in 0..self.edges.len() {
            if std::mem::replace(&mut seen[start], true) {
                continue;
            }
            let mut piece = vec![start];
            let mut next = 0;
            while next < piece.len() {
                for vertex in self.edges[piece[next]] {
                    for end in ends.at(vertex) {
                        if !std::mem::replace(&mut seen[end.edge], true) {
                            piece.push(end.edge);
                        }
                    }
                }
                next += 1;
            }
            if piece.len() >= SHORTEST_CREASE {
                piece.into_iter().for_each(|edge| kept[edge] = true);
            }
        }
        let pairs = self.edges.into_iter().zip(kept);
        Self {
            edges: pairs
                .filter_map(|(edge, kept)| kept.then_some(edge))
                .collect(),
        }
    }

    /// Returns these edges of a mesh as creases; an edge may be named more than once.
    ///
    /// # Errors
    /// A pair of vertices that is no inner edge of the mesh.
    pub fn along(mesh: &TriangleMesh, edges: &[[u32; 2]]) -> Result<Self, FitError> {
        let topology = mesh.topology();
        for (index, &[a, b]) in edges.iter().enumerate() {
            let exists = (a as usize) < mesh.vertex_count()
                && (b as usize) < mesh.vertex_count()
                && topology.neighbours(a).any(|other| other == b);
            if !exists {
                return Err(FitError::NoSuchCrease {
                    index,
                    from: a,
                    to: b,
                });
            }
        }
        Ok(Self::sorted(edges.to_vec()))
    }

    fn sorted(mut edges: Vec<[u32; 2]>) -> Self {
        edges.iter_mut().for_each(|edge| edge.sort_unstable());
        edges.sort_unstable();
        edges.dedup();
        Self { edges }
    }

    /// Returns the edges, each pair of vertices ascending, in ascending order.
    #[must_use]
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// Returns whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    /// Returns the creases on a midpoint subdivision of their mesh.
    pub(crate) fn subdivided(
        &self,
        coarse: &TriangleMesh,
        fine: &TriangleMesh,
        rounds: u32,
    ) -> Self {
        if self.is_empty() {
            return Self::none();
        }
        let topology = coarse.topology();
        let pieces = edge_pieces(topology, fine.faces(), rounds);
        let of_edge = pieces.chunks(1 << rounds).enumerate();
        let creased = of_edge.filter(|(edge, _)| {
            let mut ends = topology.edge_vertices(*edge as u32);
            ends.sort_unstable();
            self.edges.binary_search(&ends).is_ok()
        });
        Self::sorted(creased.flat_map(|(_, pieces)| pieces.to_vec()).collect())
    }

    /// Returns, for each vertex, whether the smooth energy leaves it out.
    pub(crate) fn breaks(&self, vertices: usize) -> Vec<bool> {
        let mut degree = vec![0u32; vertices];
        for v in self.edges.iter().flatten() {
            degree[*v as usize] += 1;
        }
        degree.iter().map(|&d| d >= 2).collect()
    }

    /// Returns the energy `B` whose minima are the splines with these creases.
    pub(crate) fn energy(&self, mesh: &TriangleMesh, operators: &Operators) -> SymmetricMatrix {
        let breaks = self.breaks(mesh.vertex_count());
        let weights: Vec<f64> = operators
            .mass
            .iter()
            .zip(&breaks)
            .map(|(area, &broken)| if broken { SMOOTH_SHARE } else { 1.0 } / area)
            .collect();
        let mut energy = operators.laplacian.congruence(&weights);
        let mut entries = Vec::new();
        for (vertices, row) in self.bending_rows(mesh) {
            for i in 0..3 {
                for j in 0..3 {
                    entries.push((vertices[i], vertices[j], row[i] * row[j]));
                }
            }
        }
        energy.add_to_entries(&entries);
        energy
    }

    /// Returns the weighted second differences along the creases, as three vertices and factors each.
    fn bending_rows(&self, mesh: &TriangleMesh) -> Vec<([u32; 3], [f64; 3])> {
        let position = |v: u32| mesh.positions()[v as usize];
        let length = |edge: &[u32; 2]| (position(edge[0]) - position(edge[1])).norm();
        let mean = self.edges.iter().map(length).sum::<f64>() / self.edges.len().max(1) as f64;
        let ends = Ends::of(&self.edges);
        let mut rows = Vec::new();
        for around in ends.0.chunk_by(|one, other| one.vertex == other.vertex) {
            let [one, other] = around else {
                continue;
            };
            let (a, v, b) = (one.other, one.vertex, other.other);
            let (before, after) = (position(v) - position(a), position(b) - position(v));
            let far = |to: u32| position(ends.walk(v, to)) - position(v);
            if (-far(a)).angle(&far(b)) > CORNER_TURN {
                continue;
            }
            let (h1, h2) = (before.norm(), after.norm());
            let h = 0.5 * (h1 + h2);
            let weight = (CURVE_BENDING * mean * h).sqrt();
            let second = [1.0 / (h1 * h), -(1.0 / h1 + 1.0 / h2) / h, 1.0 / (h2 * h)];
            rows.push(([a, v, b], second.map(|x| weight * x)));
        }
        rows
    }
}

/// The end of a crease edge at a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct End {
    vertex: u32,
    other: u32,
    edge: usize,
}

/// Both ends of all crease edges, in order of their vertices.
struct Ends(Vec<End>);

impl Ends {
    fn of(edges: &[[u32; 2]]) -> Self {
        let both = |(edge, &[a, b]): (usize, &[u32; 2])| {
            let end = |vertex, other| End {
                vertex,
                other,
                edge,
            };
            [end(a, b), end(b, a)]
        };
        let mut ends: Vec<End> = edges.iter().enumerate().flat_map(both).collect();
        ends.sort_unstable();
        Self(ends)
    }

    fn at(&self, vertex: u32) -> &[End] {
        let first = self.0.partition_point(|end| end.vertex < vertex);
        let last = self.0.partition_point(|end| end.vertex <= vertex);
        &self.0[first..last]
    }

    /// Returns the vertex that a crease reaches from `from` over `to`, some edges on or where it ends
    /// or branches.
    fn walk(&self, from: u32, to: u32) -> u32 {
        let (mut before, mut here) = (from, to);
        for _ in 1..CORNER_REACH {
            let &[one, other] = self.at(here) else {
                break;
            };
            let next = if one.other == before {
                other.other
            } else {
                one.other
            };
            if next == from {
                break;
            }
            (before, here) = (here, next);
        }
        here
    }
}
