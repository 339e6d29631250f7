//! The boundary of tetrahedra from a lattice, and where it touches itself.

use super::tetrahedra::{Origin, Tetrahedra};

/// The boundary of a solid, and the vertices where it is not a surface.
pub(super) struct Boundary {
    /// Faces, each with its vertices in ascending order.
    pub(super) faces: Vec<[u32; 3]>,
    /// Vertices in which, or in an edge of which, sheets touch; ascending.
    pub(super) contacts: Vec<u32>,
    /// Vertices minus edges plus faces.
    pub(super) euler_characteristic: i64,
}

impl Boundary {
    /// Returns the boundary: the faces of one cell only, all of whose vertices are on the surface,
    /// as lattice points inside are shared by all that is around them.
    pub(super) fn build(solid: &Tetrahedra) -> Self {
        let on_surface = |v: u32| solid.origins[v as usize] != Origin::Inside;
        let mut faces = Vec::new();
        for cell in &solid.cells {
            let count = cell.iter().filter(|&&v| on_surface(v)).count();
            if count < 3 {
                continue;
            }
            for corner in 0..4 {
                let mut face = [1, 2, 3].map(|i| cell[(corner + i) % 4]);
                if face.iter().all(|&v| on_surface(v)) {
                    face.sort_unstable();
                    faces.push(face);
                }
            }
        }
        faces.sort_unstable();
        let faces: Vec<[u32; 3]> = faces
            .chunk_by(|a, b| a == b)
            .filter(|same| same.len() == 1)
            .map(|same| same[0])
            .collect();
        Self::examine(solid.positions.len(), faces)
    }

    fn examine(vertex_count: usize, faces: Vec<[u32; 3]>) -> Self {
        let mut edges: Vec<([u32; 2], u32)> = (0u32..)
            .zip(&faces)
            .flat_map(|(f, &[a, b, c])| [([a, b], f), ([a, c], f), ([b, c], f)])
            .collect();
        edges.sort_unstable();
        let mut contacts = Vec::new();
        let mut edge_count = 0i64;
        let mut fans = Fans::new(vertex_count, &faces);
        for same in edges.chunk_by(|a, b| a.0 == b.0) {
            edge_count += 1;
            if let [one, two] = same {
                fans.join(one.0, [one.1, two.1]);
            } else {
                contacts.extend(same[0].0);
            }
        }
        let vertices = fans.report(&mut contacts);
        contacts.sort_unstable();
        contacts.dedup();
        Self {
            euler_characteristic: vertices - edge_count + faces.len() as i64,
            faces,
            contacts,
        }
    }
}

/// Faces around each vertex, joined across edges.
struct Fans<'a> {
    faces: &'a [[u32; 3]],
    parents: Vec<u32>,
    count: Vec<u32>,
}

impl<'a> Fans<'a> {
    fn new(vertex_count: usize, faces: &'a [[u32; 3]]) -> Self {
        let mut count = vec![0; vertex_count];
        for &vertex in faces.iter().flatten() {
            count[vertex as usize] += 1;
        }
        Self {
            faces,
            parents: (0..3 * faces.len() as u32).collect(),
            count,
        }
    }

    fn root(&mut self, mut corner: u32) -> u32 {
        while self.parents[corner as usize] != corner {
            let above = self.parents[corner as usize];
            self.parents[corner as usize] = self.parents[above as usize];
            corner = above;
        }
        corner
    }

    fn join(&mut self, edge: [u32; 2], faces: [u32; 2]) {
        for vertex in edge {
            let [one, two] = faces.map(|face| {
                let place = self.faces[face as usize].iter().position(|&v| v == vertex);
                self.root(3 * face + place.unwrap_or(0) as u32)
            });
            if one != two {
                self.parents[one.max(two) as usize] = one.min(two);
                self.count[vertex as usize] -= 1;
            }
        }
    }

    /// Adds the vertices of several fans, and returns the number of vertices.
    fn report(&self, contacts: &mut Vec<u32>) -> i64 {
        let mut vertices = 0;
        for (vertex, &fans) in self.count.iter().enumerate() {
            vertices += i64::from(fans > 0);
            if fans > 1 {
                contacts.push(vertex as u32);
            }
        }
        vertices
    }
}
