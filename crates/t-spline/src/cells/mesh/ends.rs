//! Where sides break: at the ends of boxes on both sides of a line, over borders too.

use std::collections::BTreeMap;

use crate::cells::tile::{Tile, pole_at, pole_depth, zero_at};
use crate::complex::{Border, CylinderComplex, Node};

/// What a vertex is: zeros and poles have several coordinates or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Spot {
    Node(Node),
    Zero(u32),
    Pole(u32),
}

/// Ends of boxes on lines: by cylinder and the coordinate across.
type Lines = BTreeMap<(u32, i64), Vec<i64>>;

/// A part of a side before vertices and edges have numbers.
pub(super) struct Part {
    /// Its lower end in the cylinder it belongs to, and its axis.
    pub(super) edge: (Node, u8),
    pub(super) ends: [Spot; 2],
    pub(super) range: [i64; 2],
}

/// Ends of boxes on the lines of a complex.
pub(super) struct Ends {
    horizontal: Lines,
    vertical: Lines,
}

impl Ends {
    pub(super) fn of(complex: &CylinderComplex, tiles: &[Tile]) -> Self {
        let mut ends = Self {
            horizontal: Lines::new(),
            vertical: Lines::new(),
        };
        for tile in tiles {
            let own = &complex.cylinders()[tile.cylinder as usize];
            for (x, y) in tile.x.into_iter().flat_map(|x| tile.y.map(|y| (x, y))) {
                let x = x.rem_euclid(own.circumference);
                let k = tile.cylinder;
                ends.vertical.entry((k, x)).or_default().push(y);
                ends.horizontal.entry((k, y)).or_default().push(x);
                // Both sides of a border break where either does.
                let borders = [(0, Border::Bottom), (own.height, Border::Top)];
                for (_, border) in borders.into_iter().filter(|b| b.0 == y) {
                    if let Ok(there) = complex.across(k, border, x) {
                        let key = (there.cylinder, there.y);
                        ends.horizontal.entry(key).or_default().push(there.x);
                    }
                }
            }
        }
        for line in ends
            .horizontal
            .values_mut()
            .chain(ends.vertical.values_mut())
        {
            line.sort_unstable();
            line.dedup();
        }
        ends
    }

    /// Returns the parts of a side, ascending; none if it is a pole.
    pub(super) fn parts(&self, complex: &CylinderComplex, tile: &Tile, side: usize) -> Vec<Part> {
        let own = &complex.cylinders()[tile.cylinder as usize];
        let high = usize::from(side == 1 || side == 2);
        let axis = side % 2;
        let (range, line) = if axis == 0 {
            let y = tile.y[high];
            let depth = pole_depth(complex, tile.cylinder);
            if tile.leaf.is_none() && (y == -depth || y == own.height + depth) {
                return Vec::new();
            }
            (tile.x, self.horizontal.get(&(tile.cylinder, y)))
        } else {
            let x = tile.x[high].rem_euclid(own.circumference);
            (tile.y, self.vertical.get(&(tile.cylinder, x)))
        };
        let line = line.map_or(&[][..], Vec::as_slice);
        let inside =
            line.partition_point(|&c| c <= range[0])..line.partition_point(|&c| c < range[1]);
        let mut breaks = vec![range[0]];
        breaks.extend(line.get(inside).unwrap_or(&[]));
        breaks.push(range[1]);
        let at = |c: i64| {
            if axis == 0 {
                [c, tile.y[high]]
            } else {
                [tile.x[high], c]
            }
        };
        breaks
            .windows(2)
            .map(|pair| Part {
                edge: (
                    canonical(complex, tile.cylinder, at(pair[0]), axis),
                    axis as u8,
                ),
                ends: [pair[0], pair[1]].map(|c| spot(complex, tile.cylinder, at(c))),
                range: [pair[0], pair[1]],
            })
            .collect()
    }
}

/// Returns the lower end of an edge in the cylinder that it belongs to: the one above it, if it lies on a
/// border between two.
fn canonical(complex: &CylinderComplex, cylinder: u32, [x, y]: [i64; 2], axis: usize) -> Node {
    let own = &complex.cylinders()[cylinder as usize];
    if axis == 0 && y == own.height {
        return complex.node(cylinder, x, y);
    }
    let x = x.rem_euclid(own.circumference);
    Node { cylinder, x, y }
}

pub(super) fn spot(complex: &CylinderComplex, cylinder: u32, at: [i64; 2]) -> Spot {
    let own = &complex.cylinders()[cylinder as usize];
    let depth = pole_depth(complex, cylinder);
    if let Some(zero) = zero_at(complex, cylinder, at) {
        return Spot::Zero(zero);
    }
    for (y, border) in [(-depth, Border::Bottom), (own.height + depth, Border::Top)] {
        if at[1] == y
            && let Some(pole) = pole_at(complex, cylinder, border)
        {
            return Spot::Pole(pole);
        }
    }
    if (0..=own.height).contains(&at[1]) {
        return Spot::Node(complex.node(cylinder, at[0], at[1]));
    }
    Spot::Node(Node {
        cylinder,
        x: at[0].rem_euclid(own.circumference),
        y: at[1],
    })
}
