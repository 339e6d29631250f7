//! Where the surface ends on the mesh that lies on the cylinders.

use std::collections::BTreeSet;

use msplines_common::mesh::NONE;

use super::{Domain, End};

impl Domain {
    /// Returns the faces of [`Self::mesh`] that close holes, in order: cylinders run across them, and they are
    /// no part of the surface.
    #[must_use]
    pub fn outside(&self) -> &[u32] {
        &self.outside
    }

    /// Returns, for each vertex of [`Self::mesh`], whether it lies on the surface: not inside of a closed hole.
    /// O(n).
    #[must_use]
    pub fn vertices_on_surface(&self) -> Vec<bool> {
        let mut own = vec![self.outside.is_empty(); self.mesh().vertex_count()];
        let mut outside = self.outside.iter().peekable();
        for (face, corners) in (0..).zip(self.mesh().faces()) {
            if outside.next_if_eq(&&face).is_none() {
                corners.iter().for_each(|&v| own[v as usize] = true);
            }
        }
        own
    }

    /// Returns the vertices of [`Self::mesh`] at the boundary of the surface, in order: those of loops that no
    /// pole left, and those around closed holes. O(n).
    #[must_use]
    pub fn boundary_vertices(&self) -> BTreeSet<u32> {
        let topology = self.mesh().topology();
        let loops = topology.boundary_loops().into_iter().zip(&self.ends);
        let own = loops.filter(|(_, end)| **end == End::Boundary);
        let mut found: BTreeSet<u32> = (own.flat_map(|(half_edges, _)| half_edges))
            .map(|h| topology.origin(h))
            .collect();
        let is_outside = |face: u32| self.outside.binary_search(&face).is_ok();
        for half_edge in self.outside.iter().flat_map(|face| 3 * face..3 * face + 3) {
            let twin = topology.twin(half_edge);
            if twin != NONE && !is_outside(twin / 3) {
                found.extend([topology.origin(half_edge), topology.origin(twin)]);
            }
        }
        found
    }

    /// Returns the domain with other faces outside of the surface, as [`Self::outside`] has them.
    ///
    /// # Panics
    /// If they are not in order, or the mesh does not have them.
    #[must_use]
    pub fn with_outside(self, outside: Vec<u32>) -> Self {
        let faces = self.mesh().face_count();
        let is_sorted = outside.is_sorted_by(|a, b| a < b);
        let last = outside.last().is_none_or(|&face| (face as usize) < faces);
        assert!(is_sorted && last, "faces of the mesh, in order");
        Self { outside, ..self }
    }
}
