//! T-meshes: boxes that tile the cylinders of a complex.
//!
//! # Notation
//! Every cylinder carries a tree of boxes in whole units; its leaves are the faces of the T-mesh. There
//! are no edges and no neighbours to keep: where a line of the mesh goes on is found by [`TMesh::ray`]
//! from leaf to leaf, over borders too, and a split is a branch more in a tree.
//!
//! # Reference
//! [He2006] §3.2. Deviation: the paper's T-mesh is a graph of quads; here it is implied by the boxes.

mod anchors;
mod error;
mod grading;
mod grid;
mod junctions;
mod ray;
#[cfg(test)]
pub(crate) mod tests;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

pub use error::TMeshError;
pub use grading::Grading;
pub use grid::Grid;
pub use ray::{Direction, Ray, RayStop};

use crate::complex::{CylinderComplex, Point};

/// Leaves narrower than twice this many units are not split: halves of intervals must stay whole.
const NARROWEST: i64 = 8;
/// Most cells of a base grid: twice as many as a fit may have control points.
const MOST_CELLS: usize = 4_000_000;

/// The direction in which a leaf is halved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// By a vertical line.
    X,
    /// By a horizontal line.
    Y,
    /// By both.
    Both,
}

/// Which of two boxes holds what they share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The one of smaller coordinates.
    Low,
    /// The one of larger coordinates.
    High,
}

/// A face of the T-mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leaf {
    /// Its cylinder.
    pub cylinder: u32,
    /// Extent in `x`, within `[0, C]`.
    pub x: [i64; 2],
    /// Extent in `y`, within `[0, H]`.
    pub y: [i64; 2],
    /// How often a face of the base grid was halved in `x` and in `y`.
    pub level: [u8; 2],
    branch: u32,
}

impl Leaf {
    /// Returns its extents.
    #[must_use]
    pub fn size(&self) -> [i64; 2] {
        [self.x[1] - self.x[0], self.y[1] - self.y[0]]
    }
}

/// A node of a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Branch {
    Leaf(u32),
    /// Below `at` along an axis is the first child, above it the second.
    Split {
        axis: u8,
        at: i64,
        children: [u32; 2],
    },
}

/// A T-mesh over a complex.
///
/// It is defined by its base grids and its splits, which are kept in order: a mesh is written as these
/// and read by repeating them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TMesh {
    complex: Arc<CylinderComplex>,
    grids: Vec<Grid>,
    splits: Vec<(u32, Axis)>,
    branches: Vec<Branch>,
    roots: Vec<u32>,
    leaves: Vec<Leaf>,
}

impl TMesh {
    /// Lays a base grid over every cylinder.
    ///
    /// # Errors
    /// Another number of grids than cylinders; a grid without cells, or with cells too small to split.
    pub fn build(complex: &Arc<CylinderComplex>, grids: &[Grid]) -> Result<Self, TMeshError> {
        let cylinders = complex.cylinders().len();
        if grids.len() != cylinders {
            return Err(TMeshError::Grids {
                grids: grids.len(),
                cylinders,
            });
        }
        let mut mesh = Self {
            complex: Arc::clone(complex),
            grids: grids.to_vec(),
            splits: Vec::new(),
            branches: Vec::new(),
            roots: Vec::new(),
            leaves: Vec::new(),
        };
        for (index, grid) in grids.iter().enumerate() {
            let cylinder = index as u32;
            if grid.columns.saturating_mul(grid.rows) > MOST_CELLS {
                return Err(TMeshError::Grid { cylinder });
            }
            let (xs, ys) = grid.lines(&complex.cylinders()[index]);
            let fine = |lines: &[i64]| lines.windows(2).any(|w| w[1] - w[0] < NARROWEST);
            if grid.columns == 0 || grid.rows == 0 || fine(&xs) || fine(&ys) {
                return Err(TMeshError::Grid { cylinder });
            }
            let root = mesh.grow(cylinder, &xs, &ys);
            mesh.roots.push(root);
        }
        Ok(mesh)
    }

    /// Adds the balanced tree of a grid, and returns its root.
    fn grow(&mut self, cylinder: u32, xs: &[i64], ys: &[i64]) -> u32 {
        let own = self.branches.len() as u32;
        if xs.len() == 2 && ys.len() == 2 {
            self.branches.push(Branch::Leaf(self.leaves.len() as u32));
            self.leaves.push(Leaf {
                cylinder,
                x: [xs[0], xs[1]],
                y: [ys[0], ys[1]],
                level: [0, 0],
                branch: own,
            });
            return own;
        }
        let axis = u8::from(ys.len() > xs.len());
        let lines = if axis == 0 { xs } else { ys };
        let middle = lines.len() / 2;
        let (low, high) = (&lines[..=middle], &lines[middle..]);
        let at = lines[middle];
        let children = [u32::MAX; 2];
        self.branches.push(Branch::Split { axis, at, children });
        let children = [low, high].map(|half| match axis {
            0 => self.grow(cylinder, half, ys),
            _ => self.grow(cylinder, xs, half),
        });
        self.branches[own as usize] = Branch::Split { axis, at, children };
        own
    }

    /// Returns the complex.
    #[must_use]
    pub fn complex(&self) -> &Arc<CylinderComplex> {
        &self.complex
    }

    /// Returns the faces.
    #[must_use]
    pub fn leaves(&self) -> &[Leaf] {
        &self.leaves
    }

    /// Returns the base grids.
    #[must_use]
    pub fn grids(&self) -> &[Grid] {
        &self.grids
    }

    /// Returns all splits in order, `Both` as single ones.
    #[must_use]
    pub fn splits(&self) -> &[(u32, Axis)] {
        &self.splits
    }

    /// Halves a leaf; the halves that are not the lowest are added at the end of the leaves. Returns
    /// false, and does nothing along an axis in which the leaf is too narrow, a few units.
    ///
    /// # Panics
    /// If there is no such leaf.
    pub fn split(&mut self, leaf: u32, axis: Axis) -> bool {
        match axis {
            Axis::X => self.halve(leaf, 0),
            Axis::Y => self.halve(leaf, 1),
            Axis::Both => {
                let other = self.leaves.len() as u32;
                let x = self.halve(leaf, 0);
                let y = self.halve(leaf, 1);
                if x && y {
                    self.halve(other, 1);
                }
                x && y
            }
        }
    }

    fn halve(&mut self, leaf: u32, axis: usize) -> bool {
        let mut low = self.leaves[leaf as usize];
        if low.size()[axis] < 2 * NARROWEST || low.level[axis] == u8::MAX {
            return false;
        }
        low.level[axis] += 1;
        let mut high = low;
        let at = if axis == 0 {
            let own = low.cylinder as usize;
            let cylinder = &self.complex.cylinders()[own];
            self.grids[own].middle(cylinder, low.x, low.level[0] - 1)
        } else {
            low.y[0] + (low.y[1] - low.y[0]) / 2
        };
        if axis == 0 {
            (low.x[1], high.x[0]) = (at, at);
        } else {
            (low.y[1], high.y[0]) = (at, at);
        }
        let (own, new) = (low.branch, self.leaves.len() as u32);
        low.branch = self.branches.len() as u32;
        high.branch = low.branch + 1;
        self.branches.push(Branch::Leaf(leaf));
        self.branches.push(Branch::Leaf(new));
        self.branches[own as usize] = Branch::Split {
            axis: axis as u8,
            at,
            children: [low.branch, high.branch],
        };
        self.leaves[leaf as usize] = low;
        self.leaves.push(high);
        let axis = if axis == 0 { Axis::X } else { Axis::Y };
        self.splits.push((leaf, axis));
        true
    }

    /// Returns the leaf at `(x, y)` of a cylinder, `0 <= y <= H`; `sides` say which one if several meet
    /// there, as far as there are leaves of this cylinder on these sides.
    ///
    /// # Panics
    /// If there is no such cylinder.
    #[must_use]
    pub fn locate(&self, cylinder: u32, [x, y]: [i64; 2], sides: [Side; 2]) -> u32 {
        let size = self.complex.cylinders()[cylinder as usize].circumference;
        let at = [wrap(x, size, sides[0]), y];
        self.descend(cylinder, |axis, line| {
            at[axis] > line || at[axis] == line && sides[axis] == Side::High
        })
    }

    /// Returns the leaf that holds a point; the one to the right and above, where several do.
    ///
    /// # Panics
    /// If there is no such cylinder.
    #[must_use]
    pub fn leaf_of(&self, point: Point) -> u32 {
        let at = [point.x, point.y];
        self.descend(point.cylinder, |axis, line| at[axis] >= line as f64)
    }

    fn descend(&self, cylinder: u32, high: impl Fn(usize, i64) -> bool) -> u32 {
        let mut branch = self.roots[cylinder as usize];
        loop {
            match self.branches[branch as usize] {
                Branch::Leaf(leaf) => return leaf,
                Branch::Split { axis, at, children } => {
                    branch = children[usize::from(high(usize::from(axis), at))];
                }
            }
        }
    }

    /// Calls back for every leaf that shares an area with the box `x` by `y` of a cylinder, which is not
    /// wrapped.
    pub(crate) fn leaves_in(
        &self,
        cylinder: u32,
        x: [i64; 2],
        y: [i64; 2],
        found: &mut impl FnMut(u32),
    ) {
        let ranges = [x, y];
        let mut stack = vec![self.roots[cylinder as usize]];
        while let Some(branch) = stack.pop() {
            match self.branches[branch as usize] {
                Branch::Leaf(leaf) => found(leaf),
                Branch::Split { axis, at, children } => {
                    let range = ranges[usize::from(axis)];
                    if range[1] > at {
                        stack.push(children[1]);
                    }
                    if range[0] < at {
                        stack.push(children[0]);
                    }
                }
            }
        }
    }
}

/// Returns `x` in `[0, size)`, or `(0, size]` where a point belongs to what is on its low side.
fn wrap(x: i64, size: i64, side: Side) -> i64 {
    let x = x.rem_euclid(size);
    if x == 0 && side == Side::Low { size } else { x }
}
