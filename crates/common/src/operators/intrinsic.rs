//! The intrinsic Delaunay triangulation: other edges over the same vertices of the same surface.
//!
//! Edges are geodesics of the polyhedral surface, so lengths are all there is to a triangle: no
//! positions move and the surface keeps its areas and its angle sums. What changes is that every
//! cotangent weight becomes non-negative, and with it the Laplacian well conditioned.
//!
//! The triangulation is a Δ-complex: an edge may join a vertex to itself, two edges may join the
//! same two vertices, and a face may be glued to itself.
//!
//! # Notation
//! Half-edge `h = 3 f + i` runs in face `f` from corner `i` to corner `i + 1 (mod 3)`, as in
//! [`Topology`].

use crate::mesh::{FlipComplex, NONE, Topology, TriangleMesh, carry_flip, sides_around};
use crate::progress::Outcome;

/// How far the sum of the two shorter sides exceeds the longest side of every triangle before
/// flips start, relative to the longest side or to the mean edge, whichever is longer.
///
/// Heron's formula loses a relative `machine epsilon / margin` of the squared area, so that eight
/// digits remain; triangles of aspect ratio above 10⁻⁴ are left as they are.
pub const MOLLIFICATION_MARGIN: f64 = 1e-8;

/// By how much a cotangent weight `cot α + cot β` may fall below zero, relative to
/// `1 + |cot α| + |cot β|`: the edge of a cocircular quadrilateral counts as Delaunay.
pub const DELAUNAY_TOLERANCE: f64 = 1e-10;

/// Flips allowed per edge. Scans take less than one; the rest is for long slivers.
const FLIPS_PER_EDGE: usize = 200;

/// Why a mesh has no intrinsic triangulation.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IntrinsicError {
    /// The length of an edge is NaN or infinite.
    #[error(
        "the edge from vertex {from} to vertex {to} has length {length}; \
         give finite positions whose differences can be squared"
    )]
    LengthNotFinite {
        /// Start of the edge.
        from: u32,
        /// End of the edge.
        to: u32,
        /// The length.
        length: f64,
    },
    /// All vertices coincide.
    #[error("all {edges} edges have length zero: the vertices coincide; give distinct positions")]
    NoExtent {
        /// Number of edges.
        edges: usize,
    },
}

/// Which edges may be flipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FlipRule {
    /// Every edge that is not Delaunay; the result may be a Δ-complex.
    #[default]
    Any,
    /// Only edges whose flip joins two distinct vertices that no edge joins yet: the result has
    /// the faces of an ordinary mesh, and some edges may stay negative.
    Simplicial,
}

/// Triangles given by their edge lengths.
#[derive(Clone, Debug, PartialEq)]
pub struct IntrinsicTriangulation {
    /// Corners of each face, in the vertex numbers of the mesh; corners may coincide.
    pub faces: Vec<[u32; 3]>,
    /// Length of the edge from corner `i` to corner `i + 1 (mod 3)` of each face.
    pub lengths: Vec<[f64; 3]>,
    /// The half-edge that runs the other way along the same edge, for each half-edge, or [`NONE`].
    pub twins: Vec<u32>,
    /// The two half-edges of each flipped edge, flip after flip.
    pub flips: Vec<[u32; 2]>,
    /// Length that was added to every edge before the first flip; 0 unless triangles are
    /// degenerate to [`MOLLIFICATION_MARGIN`].
    pub mollification: f64,
    /// Number of inner edges whose weight is negative beyond [`DELAUNAY_TOLERANCE`]; 0 if
    /// converged.
    pub negative_edges: usize,
    /// `Converged`; `MaxIterations` if the flips were used up; `Stalled` if rounding or the rule
    /// forbade a flip.
    pub outcome: Outcome,
}

impl IntrinsicTriangulation {
    /// Carries a closed 1-form of the mesh over to these edges, in place: `form[h]` is its integral
    /// along half-edge `h`, of the mesh before and of this triangulation after.
    ///
    /// Closed forms are sums of the two sides beside a new diagonal, so integers stay integers.
    ///
    /// # Panics
    /// If there is not one value per half-edge.
    pub fn carry<T>(&self, form: &mut [T])
    where
        T: Copy + std::ops::Add<Output = T> + std::ops::Neg<Output = T>,
    {
        assert_eq!(form.len(), self.twins.len(), "one value per half-edge");
        for &pair in &self.flips {
            let [bc, _, _, db] = sides_around(pair);
            let diagonal = form[db as usize] + form[bc as usize];
            carry_flip(form, pair, [diagonal, -diagonal]);
        }
    }
}

/// Returns the intrinsic Delaunay triangulation of a mesh.
///
/// Opposite angles of every inner edge sum to at most π, so that its cotangent weight is not
/// negative. Boundary edges stay. Time and memory are linear in the vertices on scans: 0.1 s for
/// 100,000 vertices. Equal input gives equal bits.
///
/// # Reference
/// [Fisher2007] §2.3, edge flips. Deviation: new lengths come from unfolding the two triangles in
/// the plane, which keeps digits that the tangents of half angles lose on slivers.
///
/// # Reference
/// [Sharp2020] Eq. (7), §4.5, intrinsic mollification. Deviation: the margin is also relative to
/// each triangle's longest side.
///
/// # Errors
/// A length that is not finite, or a mesh without extent.
pub fn intrinsic_delaunay(mesh: &TriangleMesh) -> Result<IntrinsicTriangulation, IntrinsicError> {
    intrinsic_delaunay_by(mesh, FlipRule::Any)
}

/// Returns the triangulation that flips allowed by `rule` reach; see [`intrinsic_delaunay`].
///
/// # Errors
/// As [`intrinsic_delaunay`].
pub fn intrinsic_delaunay_by(
    mesh: &TriangleMesh,
    rule: FlipRule,
) -> Result<IntrinsicTriangulation, IntrinsicError> {
    let mut complex = DeltaComplex::build(mesh)?;
    let mollification = complex.mollify();
    let edges = mesh.topology().edge_count();
    let (flips, within_budget) = complex.flip_until_delaunay(FLIPS_PER_EDGE * edges, rule);
    let negative_edges = complex.negative_edges();
    let outcome = match (negative_edges, within_budget) {
        (0, _) => Outcome::Converged,
        (_, true) => Outcome::Stalled,
        (_, false) => Outcome::MaxIterations,
    };
    let unit = complex.unit;
    let lengths = complex
        .lengths
        .as_chunks::<3>()
        .0
        .iter()
        .map(|sides| sides.map(|l| l * unit));
    let lengths = lengths.collect();
    let mollification = mollification * unit;
    let faces = complex.glued.faces().to_vec();
    Ok(IntrinsicTriangulation {
        faces,
        lengths,
        twins: complex.glued.twins().to_vec(),
        flips,
        mollification,
        negative_edges,
        outcome,
    })
}

/// Glued triangles and the lengths of their half-edges.
struct DeltaComplex {
    glued: FlipComplex,
    /// In units of `unit`.
    lengths: Vec<f64>,
    /// A power of two near the mean edge length, so that fourth powers neither over- nor underflow
    /// and multiplying by it is exact.
    unit: f64,
}

impl DeltaComplex {
    fn build(mesh: &TriangleMesh) -> Result<Self, IntrinsicError> {
        let topology = mesh.topology();
        let positions = mesh.positions();
        let half_edges = 0..3 * topology.face_count() as u32;
        let mut lengths = Vec::with_capacity(half_edges.len());
        for half_edge in half_edges {
            // Both half-edges of an edge compute the same bits: the norm is even.
            let [from, to] = [topology.origin(half_edge), topology.target(half_edge)];
            let length = (positions[to as usize] - positions[from as usize]).norm();
            if !length.is_finite() {
                return Err(IntrinsicError::LengthNotFinite { from, to, length });
            }
            lengths.push(length);
        }
        if lengths.iter().all(|&length| length == 0.0) {
            return Err(IntrinsicError::NoExtent {
                edges: topology.edge_count(),
            });
        }
        let count = lengths.len() as f64;
        let unit = lengths
            .iter()
            .map(|length| length / count)
            .sum::<f64>()
            .log2()
            .floor()
            .exp2();
        lengths.iter_mut().for_each(|length| *length /= unit);
        Ok(Self {
            glued: FlipComplex::of(topology),
            lengths,
            unit,
        })
    }

    /// Adds the smallest length to all edges that makes no triangle degenerate, and returns it.
    fn mollify(&mut self) -> f64 {
        let mean = self.lengths.iter().sum::<f64>() / self.lengths.len() as f64;
        let mut added = 0.0_f64;
        for &[a, b, c] in self.lengths.as_chunks::<3>().0 {
            let longest = a.max(b).max(c);
            let slack = excess_over_longest(a, b, c);
            let missing = MOLLIFICATION_MARGIN * longest.max(mean) - slack;
            added = added.max(missing / (1.0 - MOLLIFICATION_MARGIN));
        }
        for length in &mut self.lengths {
            *length += added;
        }
        added
    }

    /// Flips until every edge that the rule lets flip is Delaunay; returns the flips and whether
    /// the budget sufficed.
    fn flip_until_delaunay(&mut self, budget: usize, rule: FlipRule) -> (Vec<[u32; 2]>, bool) {
        let mut flips = Vec::new();
        loop {
            let before = flips.len();
            // Invariant: every edge that is not Delaunay and may be flipped has one of its
            // half-edge slots on the stack. A flip far away may permit one that was forbidden.
            let mut stack: Vec<u32> = (0..self.lengths.len() as u32)
                .rev()
                .filter(|&half_edge| self.breaks_delaunay(half_edge))
                .collect();
            while let Some(half_edge) = stack.pop() {
                if !self.breaks_delaunay(half_edge)
                    || (rule == FlipRule::Simplicial && !self.glued.stays_simplicial(half_edge))
                {
                    continue;
                }
                if flips.len() == budget {
                    return (flips, false);
                }
                if let Some((pair, outer)) = self.flip(half_edge) {
                    flips.push(pair);
                    stack.extend(outer);
                }
            }
            if rule == FlipRule::Any || flips.len() == before {
                return (flips, true);
            }
        }
    }

    fn negative_edges(&self) -> usize {
        (0..self.lengths.len() as u32)
            .filter(|&half_edge| half_edge < self.glued.twin(half_edge))
            .filter(|&half_edge| self.breaks_delaunay(half_edge))
            .count()
    }

    /// Whether the weight of an inner edge is negative.
    ///
    /// Where both sides are the same face, the opposite angles are two of its three and sum to
    /// less than π.
    fn breaks_delaunay(&self, half_edge: u32) -> bool {
        let twin = self.glued.twin(half_edge);
        if twin == NONE || twin / 3 == half_edge / 3 {
            return false;
        }
        let [one, other] = [half_edge, twin].map(|h| self.opposite_cotangent(h));
        one + other < -DELAUNAY_TOLERANCE * (1.0 + one.abs() + other.abs())
    }

    fn opposite_cotangent(&self, half_edge: u32) -> f64 {
        let [l, p, q] = self.sides(half_edge);
        (p * p + (q - l) * (q + l)) / (4.0 * triangle_area(l, p, q))
    }

    /// Lengths of a half-edge, the next and the previous one of the same face.
    fn sides(&self, half_edge: u32) -> [f64; 3] {
        [
            half_edge,
            Topology::next(half_edge),
            Topology::previous(half_edge),
        ]
        .map(|h| self.lengths[h as usize])
    }

    /// Replaces the diagonal of the quadrilateral around an edge; returns its two half-edges and its
    /// four sides, or
    /// nothing where rounding leaves no triangles on both sides of the other diagonal.
    fn flip(&mut self, half_edge: u32) -> Option<([u32; 2], [u32; 4])> {
        let diagonal = self.other_diagonal(half_edge);
        let sides = sides_around([half_edge, self.glued.twin(half_edge)]);
        let [l_bc, l_ca, l_ad, l_db] = sides.map(|h| self.lengths[h as usize]);
        let slack = excess_over_longest(diagonal, l_ca, l_ad)
            .min(excess_over_longest(diagonal, l_db, l_bc));
        if !diagonal.is_finite() || slack <= 0.0 {
            return None;
        }
        let (pair, outer) = self.glued.flip(half_edge);
        carry_flip(&mut self.lengths, pair, [diagonal; 2]);
        Some((pair, outer))
    }

    /// Distance of the two opposite corners of an edge after unfolding its faces in the plane.
    fn other_diagonal(&self, half_edge: u32) -> f64 {
        let twin = self.glued.twin(half_edge);
        // Coordinates from `a` along `a → b`: the twin runs from `b`.
        let [l, bc, ca] = self.sides(half_edge);
        let [_, ad, db] = self.sides(twin);
        let along =
            |from_a: f64, from_b: f64| (from_a * from_a + (l - from_b) * (l + from_b)) / (2.0 * l);
        let away = |p: f64, q: f64| 2.0 * triangle_area(l, p, q) / l;
        (along(ca, bc) - along(ad, db)).hypot(away(bc, ca) + away(ad, db))
    }
}

/// By how much the two shorter sides exceed the longest one.
fn excess_over_longest(a: f64, b: f64, c: f64) -> f64 {
    let [long, middle, short] = descending(a, b, c);
    short - (long - middle)
}

/// Area by Heron's formula in Kahan's order, accurate for slivers; 0 where the triangle
/// inequality fails.
fn triangle_area(a: f64, b: f64, c: f64) -> f64 {
    let [a, b, c] = descending(a, b, c);
    let product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    0.25 * product.max(0.0).sqrt()
}

fn descending(a: f64, b: f64, c: f64) -> [f64; 3] {
    let (high, low) = (a.max(b), a.min(b));
    if c >= high {
        [c, high, low]
    } else {
        [high, low.max(c), low.min(c)]
    }
}

#[cfg(test)]
#[path = "intrinsic_tests.rs"]
mod tests;
