//! The parts of a solid.

use msplines_common::mesh::NONE;

use super::tetrahedra::Tetrahedra;

/// The parts of a solid that no face connects.
pub(super) struct Labels {
    /// The part of each cell, numbered by first cell.
    cells: Vec<u32>,
    /// Number of cells of each part.
    sizes: Vec<usize>,
}

impl Labels {
    /// Returns the parts of a solid whose boundary nowhere touches itself, so that cells with a
    /// common vertex are in one part.
    pub(super) fn build(solid: &Tetrahedra) -> Self {
        let mut parents: Vec<u32> = (0..solid.positions.len() as u32).collect();
        let root = |parents: &mut [u32], mut vertex: u32| {
            while parents[vertex as usize] != vertex {
                let above = parents[vertex as usize];
                parents[vertex as usize] = parents[above as usize];
                vertex = above;
            }
            vertex
        };
        for &[first, ref rest @ ..] in &solid.cells {
            for &other in rest {
                let (one, two) = (root(&mut parents, first), root(&mut parents, other));
                parents[one.max(two) as usize] = one.min(two);
            }
        }
        let mut numbers = vec![NONE; solid.positions.len()];
        let (mut cells, mut sizes) = (Vec::with_capacity(solid.cells.len()), Vec::new());
        for cell in &solid.cells {
            let number = &mut numbers[root(&mut parents, cell[0]) as usize];
            if *number == NONE {
                *number = sizes.len() as u32;
                sizes.push(0);
            }
            cells.push(*number);
            sizes[*number as usize] += 1;
        }
        Self { cells, sizes }
    }

    /// Returns the number of parts.
    pub(super) fn count(&self) -> u32 {
        self.sizes.len() as u32
    }

    /// Returns a vertex of the part of fewest cells.
    pub(super) fn in_smallest(&self, solid: &Tetrahedra) -> u32 {
        let smallest = (0..self.sizes.len()).min_by_key(|&part| self.sizes[part]);
        let cell = self
            .cells
            .iter()
            .position(|&part| Some(part as usize) == smallest);
        cell.map_or(0, |cell| solid.cells[cell][0])
    }

    /// Returns the part of most cells, the first of several, its vertices numbered anew.
    pub(super) fn largest(&self, solid: &Tetrahedra) -> Tetrahedra {
        let largest = (0..self.sizes.len())
            .rev()
            .max_by_key(|&part| self.sizes[part]);
        let mut ids = vec![NONE; solid.positions.len()];
        let mut kept = Tetrahedra {
            positions: Vec::new(),
            origins: Vec::new(),
            cells: Vec::new(),
        };
        for (cell, &part) in solid.cells.iter().zip(&self.cells) {
            if Some(part as usize) != largest {
                continue;
            }
            kept.cells.push(cell.map(|vertex| {
                let id = &mut ids[vertex as usize];
                if *id == NONE {
                    *id = kept.positions.len() as u32;
                    kept.positions.push(solid.positions[vertex as usize]);
                    kept.origins.push(solid.origins[vertex as usize]);
                }
                *id
            }));
        }
        kept
    }
}
