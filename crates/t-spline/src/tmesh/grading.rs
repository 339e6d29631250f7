//! Splits that keep sizes of neighbours and shapes within bounds.

use serde::{Deserialize, Serialize};

use super::{Axis, TMesh};
use crate::complex::Node;

/// Bounds that a refinement keeps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Grading {
    /// Largest difference, in each direction, of the numbers of halvings of two leaves with a common edge.
    pub levels: Option<u8>,
    /// Largest ratio of the longer to the shorter side of a leaf that a split makes worse.
    pub aspect: f64,
}

impl Default for Grading {
    fn default() -> Self {
        Self {
            levels: None,
            aspect: 8.0,
        }
    }
}

impl TMesh {
    /// Splits leaves, and whatever the bounds then demand. Leaves that are asked for but too narrow, a few
    /// units, stay. Returns how many leaves there are more.
    ///
    /// # Panics
    /// If there is no such leaf.
    pub fn refine(&mut self, marked: &[(u32, Axis)], grading: &Grading) -> usize {
        let before = self.leaves.len();
        let mut pending = Vec::new();
        for &(leaf, axis) in marked {
            self.split_in_shape(leaf, axis, grading, &mut pending);
        }
        let Some(levels) = grading.levels else {
            return self.leaves.len() - before;
        };
        while let Some(fine) = pending.pop() {
            let level = self.leaves[fine as usize].level;
            for coarse in self.neighbours(fine) {
                let own = self.leaves[coarse as usize].level;
                let lags = [0, 1].map(|a| level[a] > own[a].saturating_add(levels));
                let axis = match lags {
                    [true, true] => Axis::Both,
                    [true, false] => Axis::X,
                    [false, true] => Axis::Y,
                    [false, false] => continue,
                };
                // Its halves may still lag, so that the fine one looks again.
                let count = self.leaves.len();
                self.split_in_shape(coarse, axis, grading, &mut pending);
                if self.leaves.len() > count {
                    pending.push(fine);
                }
            }
        }
        self.leaves.len() - before
    }

    /// Splits a leaf, along the other axis too where its shape would become too long.
    fn split_in_shape(&mut self, leaf: u32, axis: Axis, grading: &Grading, new: &mut Vec<u32>) {
        let [width, height] = self.leaves[leaf as usize].size().map(|s| s as f64);
        let axis = match axis {
            Axis::X if height > grading.aspect * width / 2.0 => Axis::Both,
            Axis::Y if width > grading.aspect * height / 2.0 => Axis::Both,
            axis => axis,
        };
        let first = self.leaves.len() as u32;
        self.split(leaf, axis);
        new.push(leaf);
        new.extend(first..self.leaves.len() as u32);
    }

    /// Returns the leaves with which a leaf shares an edge, over borders too, ascending.
    ///
    /// # Panics
    /// If there is no such leaf.
    #[must_use]
    pub fn neighbours(&self, leaf: u32) -> Vec<u32> {
        let own = self.leaves[leaf as usize];
        let corner = Node {
            cylinder: own.cylinder,
            x: own.x[0],
            y: own.y[0],
        };
        let [w, h] = own.size();
        let mut found = Vec::new();
        for [x, y] in [[[-1, w + 1], [0, h]], [[0, w], [-1, h + 1]]] {
            for piece in self.complex.develop(corner, x, y).pieces {
                let mut add = |leaf| found.push(leaf);
                self.leaves_in(piece.cylinder, piece.x, piece.y, &mut add);
            }
        }
        found.sort_unstable();
        found.dedup();
        found.retain(|&other| other != leaf);
        found
    }
}
