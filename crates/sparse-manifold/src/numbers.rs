//! Numbers of the points of grids that faces share along their edges.

use msplines_common::mesh::polygon::PolygonTopology;

/// Numbers of grid points: vertices, points on edges, points inside of faces.
pub(crate) struct Numbers<'a> {
    /// The quads.
    pub topology: &'a PolygonTopology,
    /// Cells along the side of a face.
    pub cells: u32,
}

impl Numbers<'_> {
    /// Returns the number of points.
    pub(crate) fn count(&self) -> usize {
        let inner = self.cells as usize - 1;
        self.topology.vertex_count()
            + self.topology.edge_count() * inner
            + self.topology.face_count() * inner * inner
    }

    /// Returns the ids of a face's grid, along its first edge first, then up.
    pub(crate) fn grid(&self, face: u32) -> Vec<u32> {
        let n = self.cells;
        let side = (n + 1) as usize;
        let mut ids = vec![0; side * side];
        for i in 0..=n {
            for (corner, at) in [(0, [i, 0]), (1, [n, i]), (2, [n - i, n]), (3, [0, n - i])] {
                ids[at[1] as usize * side + at[0] as usize] = self.on_edge(4 * face + corner, i);
            }
        }
        let (vertices, edges) = (self.topology.vertex_count(), self.topology.edge_count());
        let inner = n - 1;
        let first = (vertices + edges * inner as usize) as u32 + face * inner * inner;
        for row in 1..n {
            for column in 1..n {
                ids[row as usize * side + column as usize] = first + (row - 1) * inner + column - 1;
            }
        }
        ids
    }

    /// Returns the id of a point so many steps along a half-edge.
    pub(crate) fn on_edge(&self, h: u32, step: u32) -> u32 {
        if step == 0 {
            return self.topology.origin(h);
        }
        if step == self.cells {
            return self.topology.target(h);
        }
        let edge = self.topology.edge(h);
        let forward = self.topology.edge_half_edge(edge) == h;
        let step = if forward { step } else { self.cells - step };
        self.topology.vertex_count() as u32 + edge * (self.cells - 1) + step - 1
    }
}
