//! Edge flips of triangles that are glued along half-edges.
//!
//! The triangles form a Δ-complex: an edge may join a vertex to itself, two edges may join the same
//! two vertices, and a face may be glued to itself.
//!
//! # Notation
//! Half-edge `h = 3 f + i` runs in face `f` from corner `i` to corner `i + 1 (mod 3)`, as in
//! [`Topology`]. The faces `(a, b, c)` and `(b, a, d)` on the edge `ab` become `(d, c, a)` and
//! `(c, d, b)`: slot `ab` then runs `d → c`, and the four sides move one slot on.

use super::topology::{NONE, Topology};

/// Triangles glued along half-edges, whose edges can be flipped.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FlipComplex {
    origins: Vec<u32>,
    twins: Vec<u32>,
}

impl FlipComplex {
    /// Returns the triangles of a mesh.
    #[must_use]
    pub fn of(topology: &Topology) -> Self {
        let half_edges = 0..3 * topology.face_count() as u32;
        Self {
            origins: topology.faces().iter().flatten().copied().collect(),
            twins: half_edges.map(|h| topology.twin(h)).collect(),
        }
    }

    /// Returns the vertex a half-edge starts from.
    #[must_use]
    pub fn origin(&self, half_edge: u32) -> u32 {
        self.origins[half_edge as usize]
    }

    /// Returns the half-edge that runs the other way along the same edge, or [`NONE`].
    #[must_use]
    pub fn twin(&self, half_edge: u32) -> u32 {
        self.twins[half_edge as usize]
    }

    /// Returns the twins of all half-edges.
    #[must_use]
    pub fn twins(&self) -> &[u32] {
        &self.twins
    }

    /// Returns the corners of all faces; corners of one face may coincide.
    #[must_use]
    pub fn faces(&self) -> &[[u32; 3]] {
        self.origins.as_chunks::<3>().0
    }

    /// Returns whether the flip of an inner edge joins two distinct vertices that no edge joins yet,
    /// so that an ordinary mesh stays one. O(valence).
    #[must_use]
    pub fn stays_simplicial(&self, half_edge: u32) -> bool {
        let [_, ca, _, db] = sides_around([half_edge, self.twin(half_edge)]);
        let [c, d] = [ca, db].map(|h| self.origin(h));
        c != d && !self.is_neighbour(ca, d)
    }

    /// Whether an edge joins the origin of a half-edge to `vertex`.
    fn is_neighbour(&self, start: u32, vertex: u32) -> bool {
        let reaches = |outgoing: u32| {
            self.origin(Topology::next(outgoing)) == vertex
                || self.origin(Topology::previous(outgoing)) == vertex
        };
        let mut outgoing = start;
        while outgoing != NONE {
            if reaches(outgoing) {
                return true;
            }
            outgoing = self.twin(Topology::previous(outgoing));
            if outgoing == start {
                return false;
            }
        }
        // A boundary was met; the rest of the fan lies on the other side of the start.
        let mut incoming = self.twin(start);
        while incoming != NONE {
            outgoing = Topology::next(incoming);
            if reaches(outgoing) {
                return true;
            }
            incoming = self.twin(outgoing);
        }
        false
    }

    /// Replaces the diagonal of the quadrilateral around an inner edge, and returns its two
    /// half-edges and the four sides in their new slots.
    ///
    /// # Panics
    /// If the half-edge has no twin.
    pub fn flip(&mut self, half_edge: u32) -> ([u32; 2], [u32; 4]) {
        let pair = [half_edge, self.twin(half_edge)];
        let [bc, ca, ad, db] = sides_around(pair);
        let [c, d] = [ca, db].map(|h| self.origin(h));
        carry_flip(&mut self.origins, pair, [d, c]);

        // A twin may be a side that moves.
        let (old, new) = ([ca, ad, db, bc], [bc, ca, ad, db]);
        let moved = |h: u32| old.iter().position(|&side| side == h).map_or(h, |i| new[i]);
        let twins = old.map(|side| match self.twin(side) {
            NONE => NONE,
            twin => moved(twin),
        });
        for (side, twin) in new.into_iter().zip(twins) {
            self.twins[side as usize] = twin;
            if twin != NONE {
                self.twins[twin as usize] = side;
            }
        }
        (pair, new)
    }
}

/// Half-edges `bc`, `ca`, `ad`, `db` of the quadrilateral around an edge given by its half-edges.
#[must_use]
pub fn sides_around([ab, ba]: [u32; 2]) -> [u32; 4] {
    [
        Topology::next(ab),
        Topology::previous(ab),
        Topology::next(ba),
        Topology::previous(ba),
    ]
}

/// Moves values by half-edge as a flip of the edge `[ab, ba]` moves the half-edges; `diagonal` are
/// the values of the two new half-edges.
pub fn carry_flip<T: Copy>(values: &mut [T], [ab, ba]: [u32; 2], diagonal: [T; 2]) {
    let sides = sides_around([ab, ba]);
    let [bc, ca, ad, db] = sides;
    let [on_bc, on_ca, on_ad, on_db] = sides.map(|h| values[h as usize]);
    let moved = [
        (ab, diagonal[0]),
        (bc, on_ca),
        (ca, on_ad),
        (ba, diagonal[1]),
        (ad, on_db),
        (db, on_bc),
    ];
    for (slot, value) in moved {
        values[slot as usize] = value;
    }
}
