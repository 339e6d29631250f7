//! Faces and positions as a file holds them, with nothing promised about them.

use nalgebra::{Point3, Vector3};

/// Per-vertex data that came with a mesh, such as colours.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexAttribute {
    /// Name in the file, such as `red` or `quality`.
    pub name: String,
    /// One value per vertex.
    pub values: Vec<f64>,
}

/// Returns the unit normals that came with a mesh as the attributes `nx`, `ny` and `nz`; `None` if one of
/// them is missing or they differ in length.
///
/// A vertex to which the file gives no direction, a zero vector or one that is not finite, has a zero
/// vector here.
#[must_use]
pub fn vertex_normals(attributes: &[VertexAttribute]) -> Option<Vec<Vector3<f64>>> {
    let find = |name: &str| attributes.iter().find(|attribute| attribute.name == name);
    let [x, y, z] = [find("nx")?, find("ny")?, find("nz")?].map(|axis| axis.values.as_slice());
    if x.len() != y.len() || y.len() != z.len() {
        return None;
    }
    let unit = |vertex: usize| {
        let normal = Vector3::new(x[vertex], y[vertex], z[vertex]);
        // Divided first, so that no square overflows or vanishes.
        let largest = normal.amax();
        let is_direction = normal.iter().all(|x| x.is_finite()) && largest > 0.0;
        if is_direction {
            (normal / largest).normalize()
        } else {
            Vector3::zeros()
        }
    };
    Some((0..x.len()).map(unit).collect())
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

#[cfg(test)]
mod tests {
    use super::*;

    fn attributes(values: [&[f64]; 3]) -> Vec<VertexAttribute> {
        let named = ["nx", "ny", "nz"].into_iter().zip(values);
        let attribute = |(name, values): (&str, &[f64])| VertexAttribute {
            name: name.to_owned(),
            values: values.to_vec(),
        };
        named.map(attribute).collect()
    }

    #[test]
    fn normals_are_units_or_zero() {
        let (huge, tiny) = (3e300, 4e-320);
        let found = vertex_normals(&attributes([
            &[huge, 0.0, 0.0, f64::NAN, 1.0],
            &[0.0, -tiny, 0.0, 1.0, f64::INFINITY],
            &[4e300, 0.0, 0.0, 0.0, 0.0],
        ]))
        .expect("normals");
        assert!((found[0] - Vector3::new(0.6, 0.0, 0.8)).norm() < 1e-15);
        assert_eq!(found[1], -Vector3::y());
        assert_eq!(found[2..], [Vector3::zeros(); 3]);
    }

    #[test]
    fn normals_that_are_not_whole_are_none() {
        assert_eq!(vertex_normals(&attributes([&[1.0], &[0.0], &[]])), None);
        assert_eq!(vertex_normals(&attributes([&[1.0]; 3])[..2]), None);
    }
}
