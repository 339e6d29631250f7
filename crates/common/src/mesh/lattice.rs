//! Meshes cut evenly: every edge into as many segments, every face into the square of that.

use super::{NONE, SurfacePoint, Topology};

/// The points of a tessellation: vertices, then those inside of edges, then those inside of faces.
#[derive(Clone, Debug)]
pub struct Lattice<'a> {
    topology: &'a Topology,
    segments: u32,
    /// Where they are.
    pub points: Vec<SurfacePoint>,
}

impl<'a> Lattice<'a> {
    /// Lays so many segments along every edge.
    ///
    /// # Panics
    /// If there are none.
    #[must_use]
    pub fn new(topology: &'a Topology, segments: u32) -> Self {
        assert!(segments > 0, "at least one segment per edge");
        let mut points = Vec::new();
        let mut push = |face: u32, counts: [u32; 3]| {
            let at = counts.map(|c| f64::from(c) / f64::from(segments));
            points.push(SurfacePoint { face, at });
        };
        for vertex in 0..topology.vertex_count() as u32 {
            let h = topology.vertex_half_edge(vertex);
            let mut counts = [0; 3];
            counts[(h % 3) as usize] = segments;
            push(h / 3, counts);
        }
        for edge in 0..topology.edge_count() as u32 {
            let h = topology.edge_half_edge(edge);
            for step in 1..segments {
                let mut counts = [0; 3];
                counts[(h % 3) as usize] = segments - step;
                counts[((h + 1) % 3) as usize] = 0;
                counts[(Topology::next(h) % 3) as usize] = step;
                push(h / 3, counts);
            }
        }
        for face in 0..topology.face_count() as u32 {
            for second in 1..segments {
                for third in 1..segments - second {
                    push(face, [segments - second - third, second, third]);
                }
            }
        }
        Self {
            topology,
            segments,
            points,
        }
    }

    /// Returns the point of a face with these steps from the corners.
    #[must_use]
    pub fn index(&self, face: u32, counts: [u32; 3]) -> u32 {
        let (n, topology) = (self.segments, self.topology);
        let inner = n - 1;
        let edges = topology.vertex_count() as u32;
        if let Some(i) = (0..3).find(|&i| counts[i as usize] == n) {
            return topology.origin(3 * face + i);
        }
        if let Some(opposite) = (0..3).find(|&i| counts[i as usize] == 0) {
            let h = 3 * face + (opposite + 1) % 3;
            let step = counts[((opposite + 2) % 3) as usize];
            let edge = topology.edge(h);
            let forward = topology.edge_half_edge(edge) == h || topology.twin(h) == NONE;
            let step = if forward { step } else { n - step };
            return edges + edge * inner + step - 1;
        }
        let per_face = inner * n.saturating_sub(2) / 2;
        let faces = edges + topology.edge_count() as u32 * inner;
        // Rows of second = 1, 2, ... hold n - 2, n - 3, ... points.
        let row = counts[1] - 1;
        let before = row * (n - 2) - row * row.saturating_sub(1) / 2;
        faces + face * per_face + before + counts[2] - 1
    }

    /// Returns the triangles of the first `count` faces, `segments²` each, face by face.
    #[must_use]
    pub fn faces(&self, count: u32) -> Vec<[u32; 3]> {
        let n = self.segments;
        let mut faces = Vec::with_capacity((count * n * n) as usize);
        for face in 0..count {
            let at =
                |second: u32, third: u32| self.index(face, [n - second - third, second, third]);
            for second in 0..n {
                for third in 0..n - second {
                    let (right, up) = (at(second + 1, third), at(second, third + 1));
                    faces.push([at(second, third), right, up]);
                    if second + third + 2 <= n {
                        faces.push([right, at(second + 1, third + 1), up]);
                    }
                }
            }
        }
        faces
    }
}
