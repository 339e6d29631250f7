//! How leaves are cut into tiles that one patch each covers.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::CellOptions;
use super::error::CellError;
use super::lines::aligned;
use super::patch::{Patch, Scheme};
use super::tile::{Tile, pole_at, pole_depth};
use crate::complex::Border;
use crate::spline::TSpline;

/// How often a tile may be halved for the tolerance.
const MOST_HALVINGS: u32 = 24;
/// Tiles around a pole at first.
const SECTORS: i64 = 8;

/// Returns patches that tile the surface, leaf by leaf, then those beyond poles.
pub(super) fn patches(spline: &TSpline, options: &CellOptions) -> Result<Vec<Patch>, CellError> {
    let mesh = spline.space().mesh();
    let leaves = mesh.leaves().iter().enumerate();
    let mut tiles: Vec<Tile> = leaves
        .map(|(leaf, own)| Tile {
            cylinder: own.cylinder,
            x: own.x,
            y: own.y,
            leaf: Some(leaf as u32),
        })
        .collect();
    tiles.extend(sectors(spline));
    let scheme = Scheme::new(usize::from(options.degree));
    let work = Work {
        spline,
        scheme,
        tolerance: options.tolerance,
    };
    let found: Vec<Result<Vec<Patch>, CellError>> = tiles
        .par_iter()
        .map(|&tile| {
            let mut patches = Vec::new();
            work.cover(tile, MOST_HALVINGS, &mut patches)?;
            Ok(patches)
        })
        .collect();
    let mut patches = Vec::new();
    for found in found {
        patches.extend(found?);
    }
    let tiles: Vec<Tile> = patches.iter().map(|patch| patch.tile).collect();
    let cells = aligned(mesh.complex(), &tiles);
    for (patch, cell) in patches.iter_mut().zip(cells) {
        patch.cell = cell;
    }
    patches.retain(|patch| patch.cell.size().iter().all(|&size| size > 0));
    Ok(patches)
}

/// Returns tiles over the disks that are left beyond the ends of cylinders at poles.
fn sectors(spline: &TSpline) -> Vec<Tile> {
    let complex = spline.space().mesh().complex();
    let mut tiles = Vec::new();
    for (k, own) in complex.cylinders().iter().enumerate() {
        let cylinder = k as u32;
        let depth = pole_depth(complex, cylinder);
        for (border, y) in [
            (Border::Bottom, [-depth, 0]),
            (Border::Top, [own.height, own.height + depth]),
        ] {
            if pole_at(complex, cylinder, border).is_none() {
                continue;
            }
            let line = |k: i64| {
                (i128::from(own.circumference) * i128::from(k) / i128::from(SECTORS)) as i64
            };
            tiles.extend((0..SECTORS).map(|k| Tile {
                cylinder,
                x: [line(k), line(k + 1)],
                y,
                leaf: None,
            }));
        }
    }
    tiles
}

struct Work<'a> {
    spline: &'a TSpline,
    scheme: Scheme,
    tolerance: f64,
}

impl Work<'_> {
    /// Adds the patches of a tile, which is cut where it must be.
    fn cover(&self, tile: Tile, halvings: u32, out: &mut Vec<Patch>) -> Result<(), CellError> {
        let space = self.spline.space();
        if let Some(leaf) = tile.leaf {
            if let Some((axis, at)) = self.knot_line(&tile, leaf) {
                for half in tile.cut(axis, at) {
                    self.cover(half, halvings, out)?;
                }
                return Ok(());
            }
            let ends = |range: [i64; 2]| range.map(|end| end as f64);
            let capped = space.caps().meet(tile.cylinder, ends(tile.x), ends(tile.y));
            if !capped && let Some(patch) = Patch::exact(self.spline, tile, leaf) {
                out.push(patch);
                return Ok(());
            }
        }
        let mut deviation = f64::INFINITY;
        let [w, h] = tile.size();
        let mut axis = usize::from(h > w);
        if tile.zeros(space.mesh().complex()).len() < 2 {
            let patch = Patch::interpolated(self.spline, tile, &self.scheme);
            deviation = patch.deviation.max(2.0 * patch.aside);
            axis = patch.rough_axis();
            // Two neighbours then are no further apart than one is from the surface.
            if deviation <= self.tolerance && patch.aside <= 0.5 * self.tolerance {
                out.push(patch);
                return Ok(());
            }
        }
        let narrow = tile.size()[axis] < 2;
        if halvings == 0 || narrow {
            let tolerance = self.tolerance;
            let cylinder = tile.cylinder;
            return Err(CellError::Tolerance {
                cylinder,
                deviation,
                tolerance,
            });
        }
        for half in tile.halves(axis) {
            self.cover(half, halvings - 1, out)?;
        }
        Ok(())
    }

    /// Returns the line inside a tile at which most functions that meet it have a knot: the axis across
    /// it, and where it is.
    fn knot_line(&self, tile: &Tile, leaf: u32) -> Option<(usize, i64)> {
        let space = self.spline.space();
        let ranges = [tile.x, tile.y];
        let mut lines: BTreeMap<(usize, i64), usize> = BTreeMap::new();
        for (function, origin) in space.images_on(leaf) {
            let support = &space.functions()[function as usize];
            let knots = [support.x, support.y];
            let knot = |axis: usize, k: usize| knots[axis][k] + origin[axis] as i64;
            let meets =
                |axis: usize| knot(axis, 0) < ranges[axis][1] && ranges[axis][0] < knot(axis, 4);
            if !(meets(0) && meets(1)) {
                continue;
            }
            for (axis, range) in ranges.iter().enumerate() {
                let mut last = None;
                for at in (0..5).map(|k| knot(axis, k)) {
                    if range[0] < at && at < range[1] && last != Some(at) {
                        *lines.entry((axis, at)).or_default() += 1;
                    }
                    last = Some(at);
                }
            }
        }
        let mut best: Option<((usize, i64), usize)> = None;
        for (line, count) in lines {
            if best.is_none_or(|(_, most)| count > most) {
                best = Some((line, count));
            }
        }
        best.map(|(line, _)| line)
    }
}
