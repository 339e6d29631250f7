//! Supports of functions: knots around an anchor, and where on the surface they lie.
//!
//! # Reference
//! [He2006] §3.3. Deviation: knots that would reach around a zero of the form are drawn back, so that
//! every function is single valued and C2 outside of the zeros; the paper leaves them as they are.

mod clamp;
#[cfg(test)]
mod tests;

use crate::complex::{Border, CylinderComplex, Node, Piece};
use crate::tmesh::{Direction, RayStop, TMesh};

/// The knots of a function, relative to its anchor, in whole units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Support {
    /// The anchor.
    pub node: Node,
    /// Five knots in `x`, ascending.
    pub x: [i64; 5],
    /// Five knots in `y`, ascending.
    pub y: [i64; 5],
}

impl Support {
    /// Returns the supports of the functions of an anchor: one, or two where the surface, or its
    /// cylinders, end, which complete an open knot vector.
    ///
    /// # Panics
    /// If the node is not one of the anchors of the mesh.
    #[must_use]
    pub fn of_anchor(mesh: &TMesh, node: Node) -> Vec<Self> {
        let rays = [
            [Direction::Left, Direction::Right],
            [Direction::Down, Direction::Up],
        ];
        let rays = rays.map(|pair| pair.map(|direction| mesh.ray(node, direction)));
        let [x, y] = rays.map(|[low, high]| {
            let ([a, b], [c, d]) = (low.crossings, high.crossings);
            [-b, -a, 0, c, d]
        });
        let zeros = rays.map(|pair| pair.map(|ray| ray.stop == Some(RayStop::Zero)));
        let whole = Self { node, x, y };
        let mut supports = vec![whole];
        match mesh.open_border(node) {
            Some(Border::Bottom) => supports.push(Self {
                y: [0, 0, 0, 0, y[3]],
                ..whole
            }),
            Some(Border::Top) => supports.push(Self {
                y: [y[1], 0, 0, 0, 0],
                ..whole
            }),
            None => {}
        }
        for support in &mut supports {
            support.clamp(mesh.complex(), zeros);
        }
        supports
    }

    /// Returns where the support lies: it contains no zero, so that there is one way to lay it out.
    #[must_use]
    pub fn pieces(&self, complex: &CylinderComplex) -> Vec<Piece> {
        let ends = |k: &[i64; 5]| [k[0], k[4]];
        complex
            .develop(self.node, ends(&self.x), ends(&self.y))
            .pieces
    }
}
