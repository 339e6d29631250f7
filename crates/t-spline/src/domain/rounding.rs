//! From real lengths to whole units that add up exactly.
//!
//! The lengths of trajectories are a flow over the cylinders: what enters a cylinder over its bottom
//! leaves it over its top. The lengths off a spanning tree are rounded, those on it follow, and both
//! borders of every cylinder have the same whole length. Heights are differences of rounded levels.

use crate::complex::UNITS;

use super::cylinders::{Cylinders, Link};
use super::error::DomainError;
use super::form::ONE;
use super::levels::Critical;
use super::sheet::Sheets;
use super::tables::{Joint, Tables};

/// Rounds all lengths, starts and levels.
pub(super) fn round(sheets: &Sheets, real: &Cylinders) -> Result<Tables, DomainError> {
    let lengths = flow(real);
    let mut circumferences = vec![0; real.cylinders.len()];
    for (link, length) in real.links.iter().zip(&lengths) {
        if let Some((cylinder, _)) = link.above {
            circumferences[cylinder as usize] += length;
        }
    }
    let whole = |position: i32| {
        let per_unit = ONE / UNITS as i64;
        (sheets.levels.value(position) + per_unit / 2).div_euclid(per_unit)
    };
    let heights = (real.cylinders.iter()).map(|c| whole(c.borders[1]) - whole(c.borders[0]));
    let mut tables = Tables {
        circumferences,
        heights: heights.collect(),
        joints: joints(real, &lengths),
    };
    place(real, &mut tables);
    tables.check_sizes()?;
    Ok(tables)
}

/// Joints of whole lengths whose starts are not yet known.
fn joints(real: &Cylinders, lengths: &[i64]) -> Vec<Joint> {
    let mut zeros = 0;
    let mut before = None;
    let joint = |(link, &length): (&Link, &i64)| {
        let (zero, end) = match link.critical {
            Critical::Zero { order: 0, .. } => (None, None),
            Critical::Zero { .. } => {
                zeros += u32::from(before != Some(link.critical));
                (Some(zeros - 1), None)
            }
            Critical::Loop { boundary, .. } => (None, Some(boundary)),
        };
        before = Some(link.critical);
        Joint {
            below: link.below.map(|(cylinder, _)| (cylinder, 0)),
            above: link.above.map(|(cylinder, _)| (cylinder, 0)),
            length,
            zero,
            end,
        }
    };
    real.links.iter().zip(lengths).map(joint).collect()
}

/// Puts joints side by side along every border, from one rounded start.
fn place(real: &Cylinders, tables: &mut Tables) {
    for cylinder in 0..real.cylinders.len() as u32 {
        let size = tables.circumferences[cylinder as usize];
        let scale = size as f64 / real.cylinders[cylinder as usize].circumference;
        for top in [false, true] {
            let along = real.along(cylinder, top);
            let mut start = along
                .first()
                .map_or(0, |first| (first.1 * scale).round() as i64);
            for (joint, _) in along {
                let joint = &mut tables.joints[joint];
                let side = if top {
                    &mut joint.below
                } else {
                    &mut joint.above
                };
                *side = Some((cylinder, start.rem_euclid(size)));
                start += joint.length;
            }
        }
    }
}

/// Whole lengths of the links, near the real ones.
fn flow(real: &Cylinders) -> Vec<i64> {
    // What lies beyond all boundaries is one more node.
    let outside = real.cylinders.len();
    let node = |side: Option<(u32, f64)>| side.map_or(outside, |(c, _)| c as usize);
    let ends: Vec<[usize; 2]> = (real.links.iter())
        .map(|link| [node(link.below), node(link.above)])
        .collect();
    let mut lengths: Vec<i64> = (real.links.iter())
        .map(|link| (link.length * UNITS).round() as i64)
        .collect();
    let (order, parents) = tree(real, &ends);
    for &here in order.iter().rev() {
        let Some(parent) = parents[here] else {
            continue;
        };
        let mut excess = 0;
        for (&[below, above], length) in ends.iter().zip(&lengths) {
            excess += length * (i64::from(above == here) - i64::from(below == here));
        }
        // The parent's own length is in the sum, with its sign.
        lengths[parent] += if ends[parent][0] == here {
            excess
        } else {
            -excess
        };
    }
    lengths
}

/// A spanning tree of the longest links: nodes from the root on, and the link to the parent of each.
fn tree(real: &Cylinders, ends: &[[usize; 2]]) -> (Vec<usize>, Vec<Option<usize>>) {
    let mut parents = vec![None; real.cylinders.len() + 1];
    let mut order = vec![0];
    loop {
        let reaches =
            |&[below, above]: &[usize; 2]| order.contains(&below) != order.contains(&above);
        let longest = (0..ends.len())
            .filter(|&link| reaches(&ends[link]))
            .max_by(|&a, &b| real.links[a].length.total_cmp(&real.links[b].length));
        let Some(link) = longest else {
            return (order, parents);
        };
        let [below, above] = ends[link];
        let new = if order.contains(&below) { above } else { below };
        parents[new] = Some(link);
        order.push(new);
    }
}
