//! Half-edge connectivity of an oriented manifold polygon mesh, in flat arrays.
//!
//! # Notation
//! Half-edge `h` is the corner it starts from: corners are numbered face after face. Its twin runs
//! the other way in the neighbouring face, or is [`NONE`] on the boundary.

use crate::mesh::connectivity;
use crate::mesh::topology::{NONE, TopologyError};

/// Faces of at most so many corners are searched for repeated ones without sorting.
const SMALL_FACE: usize = 16;

/// Connectivity of an oriented 2-manifold polygon mesh, with or without boundary.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PolygonTopology {
    corners: Vec<u32>,
    offsets: Vec<u32>,
    corner_faces: Vec<u32>,
    twins: Vec<u32>,
    vertex_half_edges: Vec<u32>,
    half_edge_edges: Vec<u32>,
    edge_half_edges: Vec<u32>,
}

impl PolygonTopology {
    /// Builds the connectivity of faces over `vertex_count` vertices, in O(n log n).
    ///
    /// Face `f` has the corners `corners[offsets[f]..offsets[f + 1]]`, counter-clockwise.
    ///
    /// # Errors
    /// The first way in which the faces are not an oriented manifold.
    ///
    /// # Panics
    /// If the offsets do not ascend from zero to the number of corners.
    pub fn build(
        vertex_count: usize,
        corners: Vec<u32>,
        offsets: Vec<u32>,
    ) -> Result<Self, TopologyError> {
        if corners.len() >= NONE as usize || vertex_count >= NONE as usize {
            let faces = offsets.len() - 1;
            return Err(TopologyError::TooLarge { faces });
        }
        assert!(
            offsets.first() == Some(&0)
                && offsets.last() == Some(&(corners.len() as u32))
                && offsets.is_sorted(),
            "offsets ascend from 0 to the number of corners"
        );
        check_faces(vertex_count, &corners, &offsets)?;
        let mut corner_faces = Vec::with_capacity(corners.len());
        for (face, ends) in offsets.windows(2).enumerate() {
            corner_faces.resize(
                corner_faces.len() + (ends[1] - ends[0]) as usize,
                face as u32,
            );
        }
        let mut topology = Self {
            corners,
            offsets,
            corner_faces,
            twins: Vec::new(),
            vertex_half_edges: Vec::new(),
            half_edge_edges: Vec::new(),
            edge_half_edges: Vec::new(),
        };
        let half_edges = 0..topology.corners.len();
        let ends = half_edges.map(|h| [topology.origin(h as u32), topology.target(h as u32)]);
        topology.twins = connectivity::pair(ends, |h| topology.face(h))?;
        (topology.half_edge_edges, topology.edge_half_edges) =
            connectivity::number_edges(&topology.twins);
        topology.vertex_half_edges = connectivity::vertex_half_edges(
            vertex_count,
            topology.corners.iter().copied(),
            &topology.twins,
            |h| topology.around(h),
        )?;
        Ok(topology)
    }

    /// Returns the connectivity after every face has been cut into quads, one at each corner, in O(n).
    ///
    /// Vertices keep their ids; after them come the points of edges, then those of faces. Face `h` of
    /// the result lies at corner `h` and has as its corners the vertex there, the point of the edge
    /// that leaves it, the point of its face, and the point of the edge that enters it.
    ///
    /// # Panics
    /// If the result has more corners than 32-bit ids can name.
    #[must_use]
    pub fn cut_into_quads(&self) -> Self {
        let (vertices, edges) = (self.vertex_count() as u32, self.edge_count() as u32);
        let half_edges = self.corners.len() as u32;
        assert!(half_edges < NONE / 4, "corners within 32-bit ids");
        let edge_point = |h: u32| vertices + self.edge(h);
        let (mut corners, mut twins) = (Vec::new(), Vec::new());
        corners.reserve_exact(4 * half_edges as usize);
        twins.reserve_exact(4 * half_edges as usize);
        for h in 0..half_edges {
            let (next, previous) = (self.next(h), self.previous(h));
            let face_point = vertices + edges + self.face(h);
            corners.extend([
                self.origin(h),
                edge_point(h),
                face_point,
                edge_point(previous),
            ]);
            let across = match self.twin(h) {
                NONE => NONE,
                twin => 4 * self.next(twin) + 3,
            };
            let behind = match self.twin(previous) {
                NONE => NONE,
                twin => 4 * twin,
            };
            twins.extend([across, 4 * next + 2, 4 * previous + 1, behind]);
        }
        let (half_edge_edges, edge_half_edges) = connectivity::number_edges(&twins);
        let of_vertex = self.vertex_half_edges.iter().map(|&h| 4 * h);
        let of_edge = self.edge_half_edges.iter().map(|&h| match self.twin(h) {
            // The one from which the whole fan is seen.
            NONE => 4 * self.next(h) + 3,
            _ => 4 * h + 1,
        });
        let of_face = self.offsets[..self.face_count()].iter().map(|&h| 4 * h + 2);
        let vertex_half_edges = of_vertex.chain(of_edge).chain(of_face).collect();
        Self {
            corners,
            offsets: (0..=half_edges).map(|h| 4 * h).collect(),
            corner_faces: (0..4 * half_edges).map(|h| h / 4).collect(),
            twins,
            vertex_half_edges,
            half_edge_edges,
            edge_half_edges,
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
        self.offsets.len() - 1
    }

    /// Returns the number of edges.
    #[must_use]
    pub fn edge_count(&self) -> usize {
        self.edge_half_edges.len()
    }

    /// Returns the number of half-edges, which is that of corners.
    #[must_use]
    pub fn half_edge_count(&self) -> usize {
        self.corners.len()
    }

    /// Returns the vertices of a face, counter-clockwise.
    #[must_use]
    pub fn face_vertices(&self, face: u32) -> &[u32] {
        &self.corners
            [self.offsets[face as usize] as usize..self.offsets[face as usize + 1] as usize]
    }

    /// Returns the vertices of all faces, one face after another.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        (0..self.face_count() as u32).map(|face| self.face_vertices(face))
    }

    /// Returns the half-edge that starts from the first corner of a face.
    #[must_use]
    pub fn face_half_edge(&self, face: u32) -> u32 {
        self.offsets[face as usize]
    }

    /// Returns the face of a half-edge.
    #[must_use]
    pub fn face(&self, half_edge: u32) -> u32 {
        self.corner_faces[half_edge as usize]
    }

    /// Returns the number of corners of a face.
    #[must_use]
    pub fn face_size(&self, face: u32) -> u32 {
        self.offsets[face as usize + 1] - self.offsets[face as usize]
    }

    /// Returns whether every face has four corners.
    #[must_use]
    pub fn is_quad(&self) -> bool {
        (0..self.face_count() as u32).all(|face| self.face_size(face) == 4)
    }

    /// Returns the half-edge that runs the other way along the same edge, or [`NONE`].
    #[must_use]
    pub fn twin(&self, half_edge: u32) -> u32 {
        self.twins[half_edge as usize]
    }

    /// Returns the vertex a half-edge starts from.
    #[must_use]
    pub fn origin(&self, half_edge: u32) -> u32 {
        self.corners[half_edge as usize]
    }

    /// Returns the vertex a half-edge ends in.
    #[must_use]
    pub fn target(&self, half_edge: u32) -> u32 {
        self.origin(self.next(half_edge))
    }

    /// Returns the next half-edge around the same face.
    #[must_use]
    pub fn next(&self, half_edge: u32) -> u32 {
        let face = self.face(half_edge) as usize;
        if half_edge + 1 == self.offsets[face + 1] {
            self.offsets[face]
        } else {
            half_edge + 1
        }
    }

    /// Returns the previous half-edge around the same face.
    #[must_use]
    pub fn previous(&self, half_edge: u32) -> u32 {
        let face = self.face(half_edge) as usize;
        if half_edge == self.offsets[face] {
            self.offsets[face + 1] - 1
        } else {
            half_edge - 1
        }
    }

    /// Returns the outgoing half-edge that follows one counter-clockwise around its origin, or
    /// [`NONE`] after the last one of a boundary vertex.
    #[must_use]
    pub fn around(&self, half_edge: u32) -> u32 {
        self.twin(self.previous(half_edge))
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

    /// Returns the edge between two vertices, if there is one, in time proportional to a valence.
    #[must_use]
    pub fn edge_between(&self, one: u32, two: u32) -> Option<u32> {
        if one as usize >= self.vertex_count() {
            return None;
        }
        self.outgoing(one).find_map(|h| {
            if self.target(h) == two {
                return Some(self.edge(h));
            }
            let before = self.previous(h);
            (self.origin(before) == two).then(|| self.edge(before))
        })
    }

    /// Returns an outgoing half-edge of a vertex: on the boundary the one from which
    /// [`Self::outgoing`] sees the whole fan.
    #[must_use]
    pub fn vertex_half_edge(&self, vertex: u32) -> u32 {
        self.vertex_half_edges[vertex as usize]
    }

    /// Returns the outgoing half-edges of a vertex in counter-clockwise order: one for each of its
    /// faces.
    pub fn outgoing(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        connectivity::fan(self.vertex_half_edge(vertex), |h| self.around(h))
    }

    /// Returns the half-edges of the edges of a vertex, counter-clockwise: outgoing, but for the
    /// last one of a boundary vertex, which comes in.
    pub fn spokes(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        let mut last = NONE;
        let mut outgoing = self.outgoing(vertex);
        std::iter::from_fn(move || {
            if let Some(half_edge) = outgoing.next() {
                last = self.previous(half_edge);
                return Some(half_edge);
            }
            let closing = std::mem::replace(&mut last, NONE);
            (closing != NONE && self.twin(closing) == NONE).then_some(closing)
        })
    }

    /// Returns the neighbours of a vertex along its edges, counter-clockwise.
    pub fn neighbours(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        self.spokes(vertex)
            .map(move |h| self.origin(h) ^ self.target(h) ^ vertex)
    }

    /// Returns the number of edges of a vertex.
    #[must_use]
    pub fn valence(&self, vertex: u32) -> usize {
        self.spokes(vertex).count()
    }

    /// Returns whether a vertex lies on the boundary.
    #[must_use]
    pub fn is_boundary_vertex(&self, vertex: u32) -> bool {
        self.twin(self.vertex_half_edge(vertex)) == NONE
    }

    /// Returns whether an edge lies on the boundary.
    #[must_use]
    pub fn is_boundary_edge(&self, edge: u32) -> bool {
        self.twin(self.edge_half_edge(edge)) == NONE
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

fn check_faces(vertex_count: usize, corners: &[u32], offsets: &[u32]) -> Result<(), TopologyError> {
    for (face, ends) in offsets.windows(2).enumerate() {
        let corners = &corners[ends[0] as usize..ends[1] as usize];
        let face = face as u32;
        if corners.len() < 3 {
            let corners = corners.len();
            return Err(TopologyError::TooFewCorners { face, corners });
        }
        for (i, &vertex) in corners.iter().enumerate() {
            if vertex as usize >= vertex_count {
                return Err(TopologyError::IndexOutOfRange {
                    face,
                    vertex,
                    vertices: vertex_count,
                });
            }
            // Of larger faces the search would take quadratic time.
            if i < SMALL_FACE && corners[..i].contains(&vertex) {
                return Err(TopologyError::RepeatedVertex { face, vertex });
            }
        }
        if corners.len() > SMALL_FACE {
            let mut sorted = corners.to_vec();
            sorted.sort_unstable();
            if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
                let vertex = pair[0];
                return Err(TopologyError::RepeatedVertex { face, vertex });
            }
        }
    }
    Ok(())
}
