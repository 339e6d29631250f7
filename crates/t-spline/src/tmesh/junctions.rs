//! T-junctions.

use super::{Side, TMesh};
use crate::complex::{Border, Node};

impl TMesh {
    /// Returns the corners of leaves that lie inside of the side of another, ascending.
    ///
    /// Cost: `O(n log n)` for `n` leaves.
    #[must_use]
    pub fn t_junctions(&self) -> Vec<Node> {
        let mut nodes = self.anchors();
        nodes.retain(|node| self.is_t_junction(node));
        nodes
    }

    fn is_t_junction(&self, node: &Node) -> bool {
        let height = self.complex.cylinders()[node.cylinder as usize].height;
        let above = node.y < height && self.is_inside(node, Side::High);
        if above || node.y > 0 {
            return above || self.is_inside(node, Side::Low);
        }
        let below = self.complex.across(node.cylinder, Border::Bottom, node.x);
        below.is_ok_and(|below| self.is_inside(&below, Side::Low))
    }

    /// Whether a node lies inside of a side of a leaf above or below it.
    fn is_inside(&self, at: &Node, side_y: Side) -> bool {
        [Side::Low, Side::High].into_iter().any(|side_x| {
            let leaf = self.locate(at.cylinder, [at.x, at.y], [side_x, side_y]);
            let leaf = self.leaves[leaf as usize];
            leaf.x[0] < at.x && at.x < leaf.x[1] || leaf.y[0] < at.y && at.y < leaf.y[1]
        })
    }
}
