//! Faces and positions as a file holds them, with nothing promised about them.

use nalgebra::Point3;

/// Per-vertex data that came with a mesh, such as colours.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexAttribute {
    /// Name in the file, such as `red` or `quality`.
    pub name: String,
    /// One value per vertex.
    pub values: Vec<f64>,
}

/// Positions and polygons, unchecked: indices may lie outside, coordinates may be NaN.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PolygonSoup {
    /// Vertex positions.
    pub positions: Vec<Point3<f64>>,
    /// Vertex indices of all faces, one face after another, as the file has them (zero-based).
    pub face_vertices: Vec<i64>,
    /// Start of each face in `face_vertices`, and its length as the last entry: one more than faces.
    pub face_offsets: Vec<usize>,
    /// Per-vertex data beyond the positions.
    pub attributes: Vec<VertexAttribute>,
}

impl PolygonSoup {
    /// Returns the soup of these triangles.
    #[must_use]
    pub fn from_triangles(positions: Vec<Point3<f64>>, faces: &[[u32; 3]]) -> Self {
        let face_vertices = faces.iter().flatten().map(|&v| i64::from(v)).collect();
        let face_offsets = (0..=faces.len()).map(|f| 3 * f).collect();
        Self {
            positions,
            face_vertices,
            face_offsets,
            attributes: Vec::new(),
        }
    }

    /// Returns the number of faces.
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.face_offsets.len().saturating_sub(1)
    }

    /// Returns the vertex indices of face `face`.
    ///
    /// # Panics
    /// If there is no such face.
    #[must_use]
    pub fn face(&self, face: usize) -> &[i64] {
        &self.face_vertices[self.face_offsets[face]..self.face_offsets[face + 1]]
    }

    /// Appends a face.
    pub fn push_face(&mut self, vertices: impl IntoIterator<Item = i64>) {
        if self.face_offsets.is_empty() {
            self.face_offsets.push(0);
        }
        self.face_vertices.extend(vertices);
        self.face_offsets.push(self.face_vertices.len());
    }
}
