//! Vertices that are split where the texture coordinates of their corners differ.

use std::collections::BTreeMap;

/// Vertices with texture coordinates of their own: those of the surface, in order, and after them a
/// copy for each further pair of coordinates, in order of first use.
pub(crate) struct Wedges {
    /// Vertex of the surface.
    pub(crate) vertex: Vec<usize>,
    /// Texture coordinates; zero where no corner is at the vertex.
    pub(crate) texture: Vec<[f64; 2]>,
    /// Corners of each face.
    pub(crate) faces: Vec<[usize; 3]>,
}

impl Wedges {
    /// Returns the split vertices of faces whose corners, one after another, have these texture
    /// coordinates. Takes O(n log n).
    pub(crate) fn build(vertices: usize, faces: &[[u32; 3]], corners: &[[f64; 2]]) -> Self {
        let mut wedges = Self {
            vertex: (0..vertices).collect(),
            texture: vec![[0.0; 2]; vertices],
            faces: Vec::with_capacity(faces.len()),
        };
        let mut is_used = vec![false; vertices];
        let mut known = BTreeMap::new();
        let (corners, _) = corners.as_chunks::<3>();
        for (face, texture) in faces.iter().zip(corners) {
            let ids = [0, 1, 2].map(|corner| {
                let (vertex, at) = (face[corner] as usize, texture[corner]);
                // Adding zero makes -0 the same as 0.
                let key = (vertex, at.map(|x| (x + 0.0).to_bits()));
                *known.entry(key).or_insert_with(|| {
                    if std::mem::replace(&mut is_used[vertex], true) {
                        wedges.vertex.push(vertex);
                        wedges.texture.push(at);
                        return wedges.vertex.len() - 1;
                    }
                    wedges.texture[vertex] = at;
                    vertex
                })
            });
            wedges.faces.push(ids);
        }
        wedges
    }
}
