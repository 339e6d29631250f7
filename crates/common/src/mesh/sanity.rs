//! A check of everything that connectivity promises.

use super::topology::{NONE, Topology};

impl Topology {
    /// Checks every invariant of the arrays.
    ///
    /// # Panics
    /// If one does not hold: for tests of what makes meshes.
    pub fn sanity_check(&self) {
        for half_edge in 0..3 * self.face_count() as u32 {
            let twin = self.twin(half_edge);
            if twin != NONE {
                assert_ne!(twin, half_edge);
                assert_eq!(self.twin(twin), half_edge);
                assert_eq!(self.origin(twin), self.target(half_edge));
                assert_eq!(self.edge(twin), self.edge(half_edge));
            }
            let first = self.edge_half_edge(self.edge(half_edge));
            assert!(first == half_edge || first == twin);
        }
        let mut corners = 0;
        for vertex in 0..self.vertex_count() as u32 {
            let fan: Vec<u32> = self.outgoing(vertex).collect();
            assert!(fan.iter().all(|&h| self.origin(h) == vertex));
            let mut neighbours: Vec<u32> = self.neighbours(vertex).collect();
            assert_eq!(
                neighbours.len(),
                fan.len() + usize::from(self.is_boundary_vertex(vertex))
            );
            neighbours.sort_unstable();
            assert!(neighbours.windows(2).all(|pair| pair[0] < pair[1]));
            corners += fan.len();
        }
        assert_eq!(
            corners,
            (3 * self.face_count()),
            "the fans cover every corner once"
        );
        let half_edges = 0..3 * self.face_count() as u32;
        let boundary = half_edges.filter(|&h| self.twin(h) == NONE).count();
        assert_eq!(
            self.boundary_loops().iter().map(Vec::len).sum::<usize>(),
            boundary
        );
    }
}
