//! Half-edge connectivity of an oriented manifold triangle mesh, in flat arrays.
//!
//! # Notation
//! Half-edge `h = 3 f + i` runs in face `f` from corner `i` to corner `i + 1 (mod 3)`. Its twin runs
//! the other way in the neighbouring face, or is [`NONE`] on the boundary.

use super::connectivity;

/// The id that stands for "none", such as the twin of a boundary half-edge.
pub const NONE: u32 = u32::MAX;

/// Why faces are not those of an oriented manifold.
///
/// This names the first defect met; `preflight` lists them all.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TopologyError {
    /// A face names a vertex that does not exist.
    #[error("face {face} names vertex {vertex}, but there are {vertices} vertices")]
    IndexOutOfRange {
        /// The face.
        face: u32,
        /// The index it holds.
        vertex: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A face has fewer than three corners.
    #[error("face {face} has {corners} corners; a face needs at least 3")]
    TooFewCorners {
        /// The face.
        face: u32,
        /// Its number of corners.
        corners: usize,
    },
    /// A face names a vertex twice.
    #[error("face {face} names vertex {vertex} twice")]
    RepeatedVertex {
        /// The face.
        face: u32,
        /// The repeated vertex.
        vertex: u32,
    },
    /// Two faces run along an edge in the same direction, or more than two faces share it.
    #[error(
        "edge ({from}, {to}) has the same direction in faces {first} and {second}: more than two faces share it, or their orientation differs"
    )]
    EdgeNotManifold {
        /// Start of the edge.
        from: u32,
        /// End of the edge.
        to: u32,
        /// One face.
        first: u32,
        /// The other face.
        second: u32,
    },
    /// The faces around a vertex form more than one fan.
    #[error("the faces around vertex {vertex} form more than one fan")]
    VertexNotManifold {
        /// The vertex.
        vertex: u32,
    },
    /// No face uses a vertex.
    #[error("vertex {vertex} belongs to no face")]
    UnreferencedVertex {
        /// The vertex.
        vertex: u32,
    },
    /// There are more vertices or half-edges than ids.
    #[error("{faces} faces are more than 32-bit half-edge ids allow")]
    TooLarge {
        /// Number of faces.
        faces: usize,
    },
}

/// Connectivity of an oriented 2-manifold triangle mesh, with or without boundary.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topology {
    faces: Vec<[u32; 3]>,
    twins: Vec<u32>,
    vertex_half_edges: Vec<u32>,
    half_edge_edges: Vec<u32>,
    edge_half_edges: Vec<u32>,
}

impl Topology {
    /// Builds the connectivity of `faces` over `vertex_count` vertices, in O(n log n).
    ///
    /// # Errors
    /// The first way in which the faces are not an oriented manifold.
    pub fn build(vertex_count: usize, faces: Vec<[u32; 3]>) -> Result<Self, TopologyError> {
        if faces.len() >= (NONE / 3) as usize || vertex_count >= NONE as usize {
            return Err(TopologyError::TooLarge { faces: faces.len() });
        }
        check_faces(vertex_count, &faces)?;
        let ends = (0..3 * faces.len()).map(|h| [faces[h / 3][h % 3], faces[h / 3][(h + 1) % 3]]);
        let twins = connectivity::pair(ends, |h| h / 3)?;
        let (half_edge_edges, edge_half_edges) = connectivity::number_edges(&twins);
        let mut topology = Self {
            faces,
            twins,
            vertex_half_edges: Vec::new(),
            half_edge_edges,
            edge_half_edges,
        };
        topology.vertex_half_edges = connectivity::vertex_half_edges(
            vertex_count,
            topology.faces.iter().flatten().copied(),
            &topology.twins,
            |h| topology.twin(Self::previous(h)),
        )?;
        Ok(topology)
    }

    /// Returns the connectivity of no face.
    pub(super) fn empty() -> Self {
        Self {
            faces: Vec::new(),
            twins: Vec::new(),
            vertex_half_edges: Vec::new(),
            half_edge_edges: Vec::new(),
            edge_half_edges: Vec::new(),
        }
    }

    /// Returns the number of vertices.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertex_half_edges.len()
    }

    /// Returns the number of faces.
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// Returns the number of edges.
    #[must_use]
    pub fn edge_count(&self) -> usize {
        self.edge_half_edges.len()
    }

    /// Returns the corners of all faces.
    #[must_use]
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// Returns the half-edge that runs the other way along the same edge, or [`NONE`].
    #[must_use]
    pub fn twin(&self, half_edge: u32) -> u32 {
        self.twins[half_edge as usize]
    }

    /// Returns the vertex a half-edge starts from.
    #[must_use]
    pub fn origin(&self, half_edge: u32) -> u32 {
        self.faces[(half_edge / 3) as usize][(half_edge % 3) as usize]
    }

    /// Returns the vertex a half-edge ends in.
    #[must_use]
    pub fn target(&self, half_edge: u32) -> u32 {
        self.origin(Self::next(half_edge))
    }

    /// Returns the next half-edge around the same face.
    #[must_use]
    pub fn next(half_edge: u32) -> u32 {
        if half_edge % 3 == 2 {
            half_edge - 2
        } else {
            half_edge + 1
        }
    }

    /// Returns the previous half-edge around the same face.
    #[must_use]
    pub fn previous(half_edge: u32) -> u32 {
        if half_edge.is_multiple_of(3) {
            half_edge + 2
        } else {
            half_edge - 1
        }
    }

    /// Returns the edge of a half-edge.
    #[must_use]
    pub fn edge(&self, half_edge: u32) -> u32 {
        self.half_edge_edges[half_edge as usize]
    }

    /// Returns the first half-edge of an edge; its twin, if any, is the second.
    #[must_use]
    pub fn edge_half_edge(&self, edge: u32) -> u32 {
        self.edge_half_edges[edge as usize]
    }

    /// Returns the two end vertices of an edge.
    #[must_use]
    pub fn edge_vertices(&self, edge: u32) -> [u32; 2] {
        let half_edge = self.edge_half_edge(edge);
        [self.origin(half_edge), self.target(half_edge)]
    }

    /// Returns an outgoing half-edge of a vertex: on the boundary the one from which
    /// [`Self::outgoing`] sees the whole fan.
    #[must_use]
    pub fn vertex_half_edge(&self, vertex: u32) -> u32 {
        self.vertex_half_edges[vertex as usize]
    }

    /// Returns the outgoing half-edges of a vertex in counter-clockwise order.
    ///
    /// At a boundary vertex there is one neighbour more than outgoing half-edges: the origin of
    /// the last one's predecessor; see [`Self::neighbours`].
    pub fn outgoing(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        connectivity::fan(self.vertex_half_edge(vertex), |h| {
            self.twin(Self::previous(h))
        })
    }

    /// Returns the neighbouring vertices of a vertex in counter-clockwise order.
    pub fn neighbours(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        let mut last = NONE;
        let mut outgoing = self.outgoing(vertex);
        std::iter::from_fn(move || {
            if let Some(half_edge) = outgoing.next() {
                last = Self::previous(half_edge);
                return Some(self.target(half_edge));
            }
            let closing = std::mem::replace(&mut last, NONE);
            (closing != NONE && self.twin(closing) == NONE).then(|| self.origin(closing))
        })
    }

    /// Returns whether a vertex lies on the boundary.
    #[must_use]
    pub fn is_boundary_vertex(&self, vertex: u32) -> bool {
        self.twin(self.vertex_half_edge(vertex)) == NONE
    }

    /// Returns the boundary loops, each as its half-edges head to tail.
    #[must_use]
    pub fn boundary_loops(&self) -> Vec<Vec<u32>> {
        let after = |h| self.vertex_half_edge(self.target(h));
        connectivity::boundary_loops(&self.twins, after)
    }

    /// Returns the component of each vertex, numbered by first vertex, and their number.
    #[must_use]
    pub fn components(&self) -> (Vec<u32>, u32) {
        connectivity::components(self.vertex_count(), |v| self.neighbours(v))
    }

    /// Returns `V - E + F`.
    #[must_use]
    pub fn euler_characteristic(&self) -> i64 {
        self.vertex_count() as i64 - self.edge_count() as i64 + self.face_count() as i64
    }
}

fn check_faces(vertex_count: usize, faces: &[[u32; 3]]) -> Result<(), TopologyError> {
    for (face, &corners) in faces.iter().enumerate() {
        let face = face as u32;
        for (i, &vertex) in corners.iter().enumerate() {
            if vertex as usize >= vertex_count {
                return Err(TopologyError::IndexOutOfRange {
                    face,
                    vertex,
                    vertices: vertex_count,
                });
            }
            if corners[..i].contains(&vertex) {
                return Err(TopologyError::RepeatedVertex { face, vertex });
            }
        }
    }
    Ok(())
}
