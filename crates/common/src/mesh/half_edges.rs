//! Half-edges of unchecked polygons, grouped by the edge they run along.

/// A half-edge of a polygon: it starts at `corner`, an index into the flat list of corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct HalfEdge {
    /// Smaller end vertex.
    pub low: u32,
    /// Larger end vertex.
    pub high: u32,
    /// Polygon.
    pub face: u32,
    /// Corner it starts from.
    pub corner: u32,
    /// Corner it ends in.
    pub next: u32,
    /// Whether it runs from the larger to the smaller vertex.
    pub reversed: bool,
}

impl HalfEdge {
    /// Returns the half-edge of `face` from `corner` at vertex `from` to `next` at vertex `to`.
    pub(super) fn new(face: u32, [corner, next]: [u32; 2], [from, to]: [u32; 2]) -> Self {
        let (low, high) = (from.min(to), from.max(to));
        Self {
            low,
            high,
            face,
            corner,
            next,
            reversed: from > to,
        }
    }

    /// Returns the corners at the smaller and the larger end.
    pub(super) fn corners(&self) -> [u32; 2] {
        if self.reversed {
            [self.next, self.corner]
        } else {
            [self.corner, self.next]
        }
    }
}

/// Half-edges sorted so that those of one edge lie together, faces ascending.
pub(super) struct EdgeTable(Vec<HalfEdge>);

impl EdgeTable {
    /// Returns the table of these half-edges.
    pub(super) fn new(mut half_edges: Vec<HalfEdge>) -> Self {
        half_edges.sort_unstable();
        Self(half_edges)
    }

    /// Returns the table of a list of triangles; corner `3 f + i` is corner `i` of face `f`.
    pub(super) fn of_triangles(faces: &[[u32; 3]]) -> Self {
        let mut half_edges = Vec::with_capacity(3 * faces.len());
        for (face, triangle) in faces.iter().enumerate() {
            for i in 0..3 {
                let j = (i + 1) % 3;
                let corners = [(3 * face + i) as u32, (3 * face + j) as u32];
                half_edges.push(HalfEdge::new(
                    face as u32,
                    corners,
                    [triangle[i], triangle[j]],
                ));
            }
        }
        Self::new(half_edges)
    }

    /// Returns the half-edges of each edge, edges in ascending order of their end vertices.
    pub(super) fn edges(&self) -> impl Iterator<Item = &[HalfEdge]> {
        self.0.chunk_by(|a, b| (a.low, a.high) == (b.low, b.high))
    }

    /// Returns the half-edges between two vertices.
    pub(super) fn edge(&self, one: u32, two: u32) -> &[HalfEdge] {
        let ends = (one.min(two), one.max(two));
        let first = self.0.partition_point(|h| (h.low, h.high) < ends);
        let count = self.0[first..].partition_point(|h| (h.low, h.high) == ends);
        &self.0[first..first + count]
    }
}
