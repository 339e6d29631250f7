//! Lines of tiles that rounding keeps apart become one.
//!
//! Lines are whole units. What is one line of the surface is rounded in several ways: down where a tile is
//! halved, once where a column of the T-mesh is, towards its anchor where a knot is drawn back from a zero. Where
//! these meet, in a cylinder or over a border, lines lie a unit apart that should be one, and between
//! them tiles and edges that are none.
//!
//! # Notation
//! Every line has a shift `d`. Two lines that are one, the second `m` units beyond the first, ask for
//! `d_1 - d_2 = m`. Exact meetings are asked for first, so that they stay exact, then the nearest: a forest of
//! such differences, in which what would close a ring is left out. Ends of cylinders, `x = 0` and
//! lines through zeros are not shifted.

use std::collections::{BTreeMap, BTreeSet};

use super::tile::{Tile, pole_depth};
use crate::complex::{Border, CylinderComplex};

/// Lines this near are one, in units: leaves are wider, and a halving adds a third of a unit to what
/// rounding parts at most.
const ROUNDING: i64 = 7;

/// A line across an axis: cylinder, axis and coordinate, `x` in `[0, C)`.
type Line = (u32, usize, i64);

/// Returns tiles with lines that are one where rounding had parted them; those that were between have no
/// extent.
///
/// Tiles stay as they are if order would be lost, which needs lines a few units apart that go around the surface.
///
/// Cost: `O(n log n)` for `n` tiles.
pub(super) fn aligned(complex: &CylinderComplex, tiles: &[Tile]) -> Vec<Tile> {
    let lines: BTreeSet<Line> = tiles.iter().flat_map(|t| lines_of(complex, t)).collect();
    let lines: Vec<Line> = lines.into_iter().collect();
    let mut links = fixed(complex, &lines);
    links.extend(neighbours(complex, &lines));
    links.extend(over_borders(complex, tiles, &lines));
    links.sort_unstable_by_key(|link| (link.apart.abs(), link.lines));
    let mut forest = Forest::of(lines.len() + 1);
    for link in links {
        forest.join(link);
    }
    let shifts = forest.shifts();
    if !keeps_order(complex, &lines, &shifts) {
        return tiles.to_vec();
    }
    let shift = |line: Line| lines.binary_search(&line).map_or(0, |at| shifts[at]);
    let moved = |tile: &Tile| {
        let [left, right, low, high] = lines_of(complex, tile).map(shift);
        Tile {
            x: [tile.x[0] + left, tile.x[1] + right],
            y: [tile.y[0] + low, tile.y[1] + high],
            ..*tile
        }
    };
    tiles.iter().map(moved).collect()
}

/// The lines of the sides of a tile: left, right, low, high.
fn lines_of(complex: &CylinderComplex, tile: &Tile) -> [Line; 4] {
    let k = tile.cylinder;
    let size = complex.cylinders()[k as usize].circumference;
    let [left, right] = tile.x.map(|x| (k, 0, x.rem_euclid(size)));
    let [low, high] = tile.y.map(|y| (k, 1, y));
    [left, right, low, high]
}

/// That the shift of the first of two lines less that of the second is so many units.
#[derive(Clone, Copy, Debug)]
struct Link {
    apart: i64,
    lines: [usize; 2],
}

/// Links lines that stay to the one after the last, which is no line.
fn fixed(complex: &CylinderComplex, lines: &[Line]) -> Vec<Link> {
    let stays = |&(k, axis, at): &Line| {
        let own = &complex.cylinders()[k as usize];
        if axis == 1 {
            let depth = pole_depth(complex, k);
            return [-depth, 0, own.height, own.height + depth].contains(&at);
        }
        let zero = |border| complex.zero_at(k, border, at).is_some();
        at == 0 || zero(Border::Bottom) || zero(Border::Top)
    };
    let found = lines.iter().enumerate().filter(|(_, line)| stays(line));
    let link = |(at, _): (usize, &Line)| Link {
        apart: 0,
        lines: [at, lines.len()],
    };
    found.map(link).collect()
}

/// Links lines beside each other in a cylinder.
fn neighbours(complex: &CylinderComplex, lines: &[Line]) -> Vec<Link> {
    let mut links = Vec::new();
    for (at, &(k, axis, from)) in lines.iter().enumerate() {
        let next = lines.get(at + 1).filter(|n| (n.0, n.1) == (k, axis));
        let end = complex.cylinders()[k as usize].circumference;
        let (other, to) = match next {
            Some(next) => (at + 1, next.2),
            None if axis == 0 => match lines.binary_search(&(k, 0, 0)) {
                Ok(first) => (first, end),
                Err(_) => continue,
            },
            None => continue,
        };
        if to - from <= ROUNDING {
            links.push(Link {
                apart: to - from,
                lines: [at, other],
            });
        }
    }
    links
}

/// Links lines that end near each other on the two sides of a border.
fn over_borders(complex: &CylinderComplex, tiles: &[Tile], lines: &[Line]) -> Vec<Link> {
    let mut ends: [BTreeMap<u32, BTreeSet<i64>>; 2] = Default::default();
    for tile in tiles {
        let own = &complex.cylinders()[tile.cylinder as usize];
        for (y, side) in [(0, 0), (own.height, 1)] {
            if tile.y.contains(&y) {
                let xs = tile.x.map(|x| x.rem_euclid(own.circumference));
                ends[side].entry(tile.cylinder).or_default().extend(xs);
            }
        }
    }
    let [bottoms, tops] = ends;
    let place = |k: u32, x: i64| lines.binary_search(&(k, 0, x)).ok();
    let mut links = Vec::new();
    for (&k, x) in tops
        .iter()
        .flat_map(|(k, xs)| xs.iter().map(move |x| (k, *x)))
    {
        let Ok(there) = complex.across(k, Border::Top, x) else {
            continue;
        };
        let Some(others) = bottoms.get(&there.cylinder) else {
            continue;
        };
        let size = complex.cylinders()[there.cylinder as usize].circumference;
        for turn in [-size, 0, size] {
            let middle = there.x + turn;
            for &other in others.range(middle - ROUNDING..=middle + ROUNDING) {
                if let (Some(one), Some(two)) = (place(k, x), place(there.cylinder, other)) {
                    links.push(Link {
                        apart: other - middle,
                        lines: [one, two],
                    });
                }
            }
        }
    }
    links
}

/// Returns whether lines of a cylinder are in order when they are shifted.
fn keeps_order(complex: &CylinderComplex, lines: &[Line], shifts: &[i64]) -> bool {
    let moved: Vec<Line> = lines
        .iter()
        .zip(shifts)
        .map(|(&(k, axis, at), shift)| (k, axis, at + shift))
        .collect();
    let end =
        |&(k, axis, at): &Line| axis == 1 || at <= complex.cylinders()[k as usize].circumference;
    moved.is_sorted() && moved.iter().all(end)
}

/// Classes of lines whose shifts differ by what is known.
struct Forest {
    parents: Vec<usize>,
    /// Over those of the parents.
    shifts: Vec<i64>,
}

impl Forest {
    fn of(count: usize) -> Self {
        Self {
            parents: (0..count).collect(),
            shifts: vec![0; count],
        }
    }

    /// Returns the root of a line, and its shift over that of the root.
    fn root(&mut self, line: usize) -> (usize, i64) {
        let mut path = Vec::new();
        let mut at = line;
        while self.parents[at] != at {
            path.push(at);
            at = self.parents[at];
        }
        let mut sum = 0;
        for &step in path.iter().rev() {
            sum += self.shifts[step];
            (self.parents[step], self.shifts[step]) = (at, sum);
        }
        (at, sum)
    }

    /// Joins two classes; a link within one is left out.
    fn join(&mut self, link: Link) {
        let [(one, first), (other, second)] = link.lines.map(|line| self.root(line));
        if one != other {
            self.parents[one] = other;
            self.shifts[one] = link.apart + second - first;
        }
    }

    /// Returns the shifts of all lines but the last, which is not shifted; nor are the first ones of
    /// classes without it.
    fn shifts(mut self) -> Vec<i64> {
        let last = self.parents.len() - 1;
        let mut bases: Vec<Option<i64>> = vec![None; last + 1];
        let (root, shift) = self.root(last);
        bases[root] = Some(shift);
        let mut shift_of = |line| {
            let (root, shift) = self.root(line);
            shift - *bases[root].get_or_insert(shift)
        };
        (0..last).map(&mut shift_of).collect()
    }
}
