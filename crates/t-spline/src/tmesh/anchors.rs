//! Anchors: nodes of the mesh that carry functions.

use super::TMesh;
use crate::complex::{Beyond, Border, Node};

impl TMesh {
    /// Returns the corners of all leaves, each once and in the cylinder it belongs to, ascending; without
    /// the zeros of the form, at which there is no pair of directions.
    #[must_use]
    pub fn anchors(&self) -> Vec<Node> {
        let mut nodes = Vec::with_capacity(4 * self.leaves.len());
        for leaf in &self.leaves {
            for (x, y) in leaf.x.into_iter().flat_map(|x| leaf.y.map(|y| (x, y))) {
                nodes.push(self.complex.node(leaf.cylinder, x, y));
            }
        }
        nodes.sort_unstable();
        nodes.dedup();
        nodes.retain(|&n| {
            let zero = |border| self.complex.zero_at(n.cylinder, border, n.x);
            n.y != 0 || zero(Border::Bottom).is_none()
        });
        nodes
    }

    /// Returns the border on which a node lies if the surface, or its cylinders, end there.
    #[must_use]
    pub fn open_border(&self, node: Node) -> Option<Border> {
        let height = self.complex.cylinders()[node.cylinder as usize].height;
        let open = |border| {
            let segment = self.complex.segment(node.cylinder, border, node.x);
            !matches!(segment.beyond, Beyond::Cylinder { .. })
        };
        if node.y == 0 && open(Border::Bottom) {
            Some(Border::Bottom)
        } else if node.y == height && open(Border::Top) {
            Some(Border::Top)
        } else {
            None
        }
    }
}
