//! Domains with more vertices: every new one on a face or an edge of the old domain.
//!
//! Flat lengths stay as they are. Faces and vertices keep their numbers; new ones are appended, and
//! a face that is cut keeps its number for one of its pieces.

use msplines_common::Point3;
use msplines_common::mesh::{NONE, Topology, TriangleMesh};

use super::{DomainError, FlatDomain};
use crate::vector::{add, scale, sub};

/// Faces and vectors while they change.
struct Pieces {
    positions: Vec<Point3<f64>>,
    faces: Vec<[u32; 3]>,
    vectors: Vec<[f64; 2]>,
}

impl Pieces {
    fn of(domain: &FlatDomain) -> Self {
        Self {
            positions: domain.mesh.positions().to_vec(),
            faces: domain.mesh.faces().to_vec(),
            vectors: domain.edge_vectors.clone(),
        }
    }

    fn vertex(&mut self, position: Point3<f64>) -> u32 {
        self.positions.push(position);
        self.positions.len() as u32 - 1
    }

    fn sides(&self, face: u32) -> [[f64; 2]; 3] {
        [0, 1, 2].map(|i| self.vectors[3 * face as usize + i])
    }

    fn set(&mut self, face: u32, corners: [u32; 3], sides: [[f64; 2]; 3]) {
        let face = face as usize;
        if face == self.faces.len() {
            self.faces.push(corners);
            self.vectors.extend(sides);
        } else {
            self.faces[face] = corners;
            self.vectors[3 * face..3 * face + 3].copy_from_slice(&sides);
        }
    }

    /// Joins a new vertex to the corners of a face.
    fn cut_face(&mut self, face: u32, at: [f64; 3], vertex: u32) {
        let corners = self.faces[face as usize];
        let e = self.sides(face);
        let spokes = [0, 1, 2].map(|i| {
            sub(
                scale(at[(i + 1) % 3], e[i]),
                scale(at[(i + 2) % 3], e[(i + 2) % 3]),
            )
        });
        for i in 0..3 {
            let next = (i + 1) % 3;
            let piece = if i == 0 {
                face
            } else {
                self.faces.len() as u32
            };
            let sides = [e[i], spokes[next], scale(-1.0, spokes[i])];
            self.set(piece, [corners[i], corners[next], vertex], sides);
        }
    }

    /// Joins a new vertex on a half-edge to the corner opposite.
    fn cut_side(&mut self, half_edge: u32, share: f64, vertex: u32) {
        let (face, i) = (half_edge / 3, (half_edge % 3) as usize);
        let corner = |k: usize, faces: &[[u32; 3]]| faces[face as usize][k % 3];
        let [tail, head, apex] = [0, 1, 2].map(|k| corner(i + k, &self.faces));
        let sides = self.sides(face);
        let [side, next, last] = [0, 1, 2].map(|k| sides[(i + k) % 3]);
        let (first, second) = (scale(share, side), scale(1.0 - share, side));
        let to_apex = add(second, next);
        self.set(face, [tail, vertex, apex], [first, to_apex, last]);
        let piece = self.faces.len() as u32;
        self.set(
            piece,
            [vertex, head, apex],
            [second, next, scale(-1.0, to_apex)],
        );
    }

    fn build(self) -> Result<FlatDomain, DomainError> {
        FlatDomain::build(
            TriangleMesh::build(self.positions, self.faces)?,
            self.vectors,
        )
    }
}

impl FlatDomain {
    /// Returns the domain with a vertex inside of each of some faces, each joined to the three corners.
    ///
    /// A vertex is given by face, barycentric coordinates and position in space; no face is named
    /// twice.
    ///
    /// # Errors
    /// A place so near to an edge that a face is flat.
    ///
    /// # Panics
    /// If there is no such face.
    pub fn with_vertices_in_faces(
        &self,
        places: &[(u32, [f64; 3], Point3<f64>)],
    ) -> Result<Self, DomainError> {
        let mut pieces = Pieces::of(self);
        for &(face, at, position) in places {
            let vertex = pieces.vertex(position);
            pieces.cut_face(face, at, vertex);
        }
        pieces.build()
    }

    /// Returns the domain with a vertex on an edge, at a share of the way along a half-edge, joined to
    /// the corners opposite.
    ///
    /// # Errors
    /// A place so near to an end that a face is flat.
    ///
    /// # Panics
    /// If there is no such half-edge.
    pub fn with_vertex_on_edge(
        &self,
        half_edge: u32,
        share: f64,
        position: Point3<f64>,
    ) -> Result<Self, DomainError> {
        let mut pieces = Pieces::of(self);
        let vertex = pieces.vertex(position);
        pieces.cut_side(half_edge, share, vertex);
        let twin = self.topology().twin(half_edge);
        if twin != NONE {
            pieces.cut_side(twin, 1.0 - share, vertex);
        }
        pieces.build()
    }
}

/// Returns the half-edges of the faces around some vertices.
pub(super) fn star(topology: &Topology, vertices: std::ops::Range<u32>) -> Vec<u32> {
    let spokes = vertices.flat_map(|v| topology.outgoing(v));
    spokes
        .flat_map(|h| [h, Topology::next(h), Topology::previous(h)])
        .collect()
}
