//! Connectivity of an oriented tetrahedral mesh whose boundary is a surface, in flat arrays.

use std::sync::Arc;

use super::cell::CELL_FACES;
use super::connectivity::{self, FaceUse};
use crate::mesh::topology::{NONE, Topology, TopologyError};

/// Why cells are not those of an oriented solid.
///
/// This names the first defect met; [`preflight`](super::preflight) lists them all.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TetTopologyError {
    /// A cell names a vertex that does not exist.
    #[error("tetrahedron {cell} names vertex {vertex}, but there are {vertices} vertices")]
    IndexOutOfRange {
        /// The cell.
        cell: u32,
        /// The index it holds.
        vertex: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A cell names a vertex twice.
    #[error("tetrahedron {cell} names vertex {vertex} twice")]
    RepeatedVertex {
        /// The cell.
        cell: u32,
        /// The repeated vertex.
        vertex: u32,
    },
    /// More than two cells share a face, or two run around it alike.
    #[error(
        "tetrahedra {first} and {second} have face {face:?} from the same side: more than two share it, or their orientation differs"
    )]
    FaceNotManifold {
        /// Vertices of the face, ascending.
        face: [u32; 3],
        /// One cell.
        first: u32,
        /// The other cell.
        second: u32,
    },
    /// The boundary faces are no surface.
    #[error("the boundary is not a surface: {error}, by vertices {vertices:?}")]
    Boundary {
        /// What is wrong, by ids of the boundary.
        error: TopologyError,
        /// The vertices of the mesh that it names.
        vertices: Vec<u32>,
    },
    /// The cells around a vertex do not fill a ball or half of one.
    #[error("the tetrahedra around vertex {vertex} do not fill a ball or a part of one")]
    VertexNotManifold {
        /// The vertex.
        vertex: u32,
    },
    /// No cell uses a vertex.
    #[error("vertex {vertex} belongs to no tetrahedron")]
    UnreferencedVertex {
        /// The vertex.
        vertex: u32,
    },
    /// There are more cells or vertices than ids.
    #[error("{cells} tetrahedra are more than 32-bit ids allow")]
    TooLarge {
        /// Number of cells.
        cells: usize,
    },
}

/// Connectivity of an oriented tetrahedral mesh of a 3-manifold with boundary.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TetTopology {
    cells: Vec<[u32; 4]>,
    neighbours: Vec<[u32; 4]>,
    vertex_offsets: Vec<u32>,
    vertex_cells: Vec<u32>,
    edges: Vec<[u32; 2]>,
    cell_edges: Vec<[u32; 6]>,
    boundary: Arc<Topology>,
    boundary_faces: Vec<(u32, u8)>,
    boundary_vertices: Vec<u32>,
    boundary_of: Vec<u32>,
}

impl TetTopology {
    /// Builds the connectivity of `cells` over `vertex_count` vertices, in O(n).
    ///
    /// # Errors
    /// The first way in which the cells are not an oriented solid whose boundary is a surface.
    pub fn build(vertex_count: usize, cells: Vec<[u32; 4]>) -> Result<Self, TetTopologyError> {
        if cells.len() >= (NONE / 6) as usize || vertex_count >= NONE as usize {
            return Err(TetTopologyError::TooLarge { cells: cells.len() });
        }
        check_cells(vertex_count, &cells)?;
        let (vertex_offsets, vertex_cells) = connectivity::vertex_cells(vertex_count, &cells);
        if let Some(vertex) = vertex_offsets
            .windows(2)
            .position(|ends| ends[0] == ends[1])
        {
            let vertex = vertex as u32;
            return Err(TetTopologyError::UnreferencedVertex { vertex });
        }
        let (neighbours, boundary_faces) = pair(vertex_count, &cells)?;
        let (edges, cell_edges) = connectivity::edges(vertex_count, &cells);
        let mut topology = Self {
            cells,
            neighbours,
            vertex_offsets,
            vertex_cells,
            edges,
            cell_edges,
            boundary: Arc::new(Topology::empty()),
            boundary_faces,
            boundary_vertices: Vec::new(),
            boundary_of: vec![NONE; vertex_count],
        };
        topology.build_boundary()?;
        topology.check_links()?;
        Ok(topology)
    }

    /// Numbers the boundary vertices in their order, and pairs the boundary faces.
    fn build_boundary(&mut self) -> Result<(), TetTopologyError> {
        let faces: Vec<[u32; 3]> = self
            .boundary_faces
            .iter()
            .map(|&(cell, corner)| self.face(cell, corner.into()))
            .collect();
        for &vertex in faces.iter().flatten() {
            self.boundary_of[vertex as usize] = 0;
        }
        for (vertex, id) in self.boundary_of.iter_mut().enumerate() {
            if *id != NONE {
                *id = self.boundary_vertices.len() as u32;
                self.boundary_vertices.push(vertex as u32);
            }
        }
        let local = |face: [u32; 3]| face.map(|v| self.boundary_of[v as usize]);
        let faces = faces.into_iter().map(local).collect();
        let boundary = Topology::build(self.boundary_vertices.len(), faces);
        let named = |error: TopologyError| {
            let ids = match &error {
                TopologyError::EdgeNotManifold { from, to, .. } => vec![*from, *to],
                TopologyError::VertexNotManifold { vertex } => vec![*vertex],
                _ => Vec::new(),
            };
            let vertices = ids
                .into_iter()
                .map(|v| self.boundary_vertices[v as usize])
                .collect();
            TetTopologyError::Boundary { error, vertices }
        };
        self.boundary = Arc::new(boundary.map_err(named)?);
        Ok(())
    }

    /// Checks that around each vertex the cells form a ball or half of one: seen from the vertex,
    /// its edges, faces and cells have the Euler characteristic of a sphere or of a disk.
    fn check_links(&self) -> Result<(), TetTopologyError> {
        let mut edges = vec![0i64; self.vertex_count()];
        for &vertex in self.edges.iter().flatten() {
            edges[vertex as usize] += 1;
        }
        for vertex in 0..self.vertex_count() as u32 {
            let cells = self.vertex_cells(vertex).len() as i64;
            let id = self.boundary_of[vertex as usize];
            let (open, expected) = match id {
                NONE => (0, 2),
                id => (self.boundary.outgoing(id).count() as i64, 1),
            };
            if edges[vertex as usize] - (3 * cells + open) / 2 + cells != expected {
                return Err(TetTopologyError::VertexNotManifold { vertex });
            }
        }
        Ok(())
    }

    /// Returns the number of vertices.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.boundary_of.len()
    }

    /// Returns the number of cells.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.cells.len()
    }

    /// Returns the corners of all cells.
    #[must_use]
    pub fn cells(&self) -> &[[u32; 4]] {
        &self.cells
    }

    /// Returns, for each cell, the neighbour opposite to each corner, [`NONE`] on the boundary.
    #[must_use]
    pub fn neighbours(&self) -> &[[u32; 4]] {
        &self.neighbours
    }

    /// Returns the face of a cell opposite to a corner, counter-clockwise as seen from outside.
    #[must_use]
    pub fn face(&self, cell: u32, corner: usize) -> [u32; 3] {
        CELL_FACES[corner].map(|i| self.cells[cell as usize][i])
    }

    /// Returns the number of faces, each counted once.
    #[must_use]
    pub fn face_count(&self) -> usize {
        (4 * self.cells.len() + self.boundary_faces.len()) / 2
    }

    /// Returns the cells of a vertex, ascending.
    #[must_use]
    pub fn vertex_cells(&self, vertex: u32) -> &[u32] {
        let range = self.vertex_offsets[vertex as usize]..self.vertex_offsets[vertex as usize + 1];
        &self.vertex_cells[range.start as usize..range.end as usize]
    }

    /// Returns the end vertices of all edges, the smaller first, in ascending order.
    #[must_use]
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// Returns the edges of each cell, in the order of [`CELL_EDGES`](super::CELL_EDGES).
    #[must_use]
    pub fn cell_edges(&self) -> &[[u32; 6]] {
        &self.cell_edges
    }

    /// Returns the connectivity of the boundary, over the vertices [`Self::boundary_vertices`].
    #[must_use]
    pub fn boundary(&self) -> &Arc<Topology> {
        &self.boundary
    }

    /// Returns, for each boundary face, its cell and the corner of the cell opposite to it.
    #[must_use]
    pub fn boundary_faces(&self) -> &[(u32, u8)] {
        &self.boundary_faces
    }

    /// Returns the vertex of the mesh of each boundary vertex, ascending.
    #[must_use]
    pub fn boundary_vertices(&self) -> &[u32] {
        &self.boundary_vertices
    }

    /// Returns the boundary vertex of a vertex of the mesh, or [`NONE`] inside.
    #[must_use]
    pub fn boundary_vertex(&self, vertex: u32) -> u32 {
        self.boundary_of[vertex as usize]
    }

    /// Returns the component of each cell, numbered by first cell, and their number.
    ///
    /// Cells belong together if they share a face; in a manifold this is as if they share a vertex.
    #[must_use]
    pub fn components(&self) -> (Vec<u32>, u32) {
        crate::mesh::connectivity::components(self.cell_count(), |cell| {
            let neighbours = self.neighbours[cell as usize];
            neighbours.into_iter().filter(|&other| other != NONE)
        })
    }

    /// Returns `V - E + F - C`: 1 for a ball.
    #[must_use]
    pub fn euler_characteristic(&self) -> i64 {
        let [vertices, edges] = [self.vertex_count(), self.edges.len()].map(|n| n as i64);
        vertices - edges + self.face_count() as i64 - self.cell_count() as i64
    }

    /// Checks every invariant of the arrays.
    ///
    /// # Panics
    /// If one does not hold: for tests of what makes meshes.
    pub fn sanity_check(&self) {
        self.boundary.sanity_check();
        for cell in 0..self.cell_count() as u32 {
            for corner in 0..4 {
                let other = self.neighbours[cell as usize][corner];
                if other == NONE {
                    assert!(self.boundary_faces.contains(&(cell, corner as u8)));
                    continue;
                }
                let back = self.neighbours[other as usize];
                let across = back
                    .iter()
                    .position(|&n| n == cell)
                    .expect("neighbours know");
                let (mut here, mut there) = (self.face(cell, corner), self.face(other, across));
                here.sort_unstable();
                there.sort_unstable();
                assert_eq!(here, there);
            }
            for (edge, ends) in self.cell_edges[cell as usize]
                .into_iter()
                .zip(super::CELL_EDGES)
            {
                let mut ends = ends.map(|i| self.cells[cell as usize][i]);
                ends.sort_unstable();
                assert_eq!(self.edges[edge as usize], ends);
            }
        }
        assert!(self.edges.is_sorted());
        for vertex in 0..self.vertex_count() as u32 {
            for &cell in self.vertex_cells(vertex) {
                assert!(self.cells[cell as usize].contains(&vertex));
            }
        }
        assert_eq!(self.vertex_cells.len(), 4 * self.cell_count());
    }
}

fn check_cells(vertex_count: usize, cells: &[[u32; 4]]) -> Result<(), TetTopologyError> {
    for (cell, corners) in cells.iter().enumerate() {
        let cell = cell as u32;
        for (i, &vertex) in corners.iter().enumerate() {
            if vertex as usize >= vertex_count {
                return Err(TetTopologyError::IndexOutOfRange {
                    cell,
                    vertex,
                    vertices: vertex_count,
                });
            }
            if corners[..i].contains(&vertex) {
                return Err(TetTopologyError::RepeatedVertex { cell, vertex });
            }
        }
    }
    Ok(())
}

/// Neighbours of each cell, and the faces that have none.
type Paired = (Vec<[u32; 4]>, Vec<(u32, u8)>);

/// Returns the neighbours of each cell, and the faces that have none in order of their cells.
fn pair(vertex_count: usize, cells: &[[u32; 4]]) -> Result<Paired, TetTopologyError> {
    let mut neighbours = vec![[NONE; 4]; cells.len()];
    let mut boundary = Vec::new();
    let uses = connectivity::face_uses(vertex_count, cells);
    for same in uses.chunk_by(|a, b| a.vertices == b.vertices) {
        match same {
            [one] => boundary.push((one.cell, one.corner)),
            [one, two] if one.reversed != two.reversed => {
                neighbours[one.cell as usize][one.corner as usize] = two.cell;
                neighbours[two.cell as usize][two.corner as usize] = one.cell;
            }
            [one, rest @ ..] => {
                let same_side = |other: &&FaceUse| other.reversed == one.reversed;
                let second = rest.iter().find(same_side).or(rest.last());
                return Err(TetTopologyError::FaceNotManifold {
                    face: one.vertices,
                    first: one.cell,
                    second: second.map_or(one.cell, |other| other.cell),
                });
            }
            [] => {}
        }
    }
    boundary.sort_unstable();
    Ok((neighbours, boundary))
}
