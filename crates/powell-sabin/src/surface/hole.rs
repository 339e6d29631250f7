//! A hole of the atlas and what fills it.

use super::minimal::MinimalCap;
use super::smooth::SmoothCap;

/// A hole at a zero of the form, or at its pole.
#[derive(Clone, Debug)]
pub struct Hole {
    pub(super) order: i32,
    pub(super) vertices: Vec<u32>,
    pub(super) faces: Vec<u32>,
    pub(super) cap: Cap,
}

/// What fills a hole.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Cap {
    /// Nothing.
    Open,
    /// A spline over a chart of its own, blended with the surface around.
    Smooth(Box<SmoothCap>),
    /// A surface of small area.
    Minimal(Box<MinimalCap>),
}

impl Hole {
    /// Returns the order of the zero: 1 for a simple one, -2 for a double pole.
    #[must_use]
    pub fn order(&self) -> i32 {
        self.order
    }

    /// Returns the vertices inside, ascending.
    #[must_use]
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// Returns the faces that were cut out, ascending.
    #[must_use]
    pub fn faces(&self) -> &[u32] {
        &self.faces
    }

    /// Returns what fills it.
    #[must_use]
    pub fn cap(&self) -> &Cap {
        &self.cap
    }
}
