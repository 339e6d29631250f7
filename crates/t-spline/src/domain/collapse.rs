//! Collapse of cylinders too thin to carry a row, and twists rounded to none.
//!
//! Two zeros at nearly the same level leave a cylinder much thinner than its circumference. Its top
//! is laid on its bottom: every pair of a joint below and a joint above it that overlap becomes one
//! joint. All that hangs on the critical graph of its top moves down, or that of its bottom up, or each
//! half way; the sum of `C H` stays the same.
//!
//! # Reference
//! [He2006] §3.2, Fig. 2. Deviation: the paper's two-hole torus has both zeros at one level by symmetry;
//! here levels are made equal where they nearly are.

use serde::{Deserialize, Serialize};

use super::tables::{Joint, Tables};

/// What counts as thin and near, each as a share of the root of the area of the complex: a grid of 2500
/// square cells has cells of 0.02 of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SnapOptions {
    /// Height below which a cylinder is collapsed.
    pub thin: f64,
    /// Length of a joint below which a collapse is not made, if that is also less than half of the height that
    /// vanishes: it would bring two zeros much nearer to each other.
    pub sliver: f64,
    /// Distance in `u` of a zero on the top from one on the bottom below which the cylinder is twisted
    /// so that it vanishes; a cylinder is never sheared by more than a quarter.
    pub twist: f64,
    /// Length of a boundary loop below which its hole is closed, here as a share of the root of the area of the
    /// surface: half of it is the rim of a disk of a fiftieth of the area.
    pub hole: f64,
}

/// Largest turn of a top over the height.
const SHEAR: f64 = 0.25;

/// Least distance of two zeros on one level, over the height that they lay apart before: at 0.1 their caps
/// become too narrow, at more fewer cylinders are collapsed, and on a surface of genus 22 errors at vertices grow
/// by a twentieth from 0.25 to 1.
const NEARER: f64 = 0.5;

impl Default for SnapOptions {
    fn default() -> Self {
        Self {
            thin: 0.01,
            sliver: 0.01,
            twist: 0.01,
            hole: 0.5,
        }
    }
}

/// A part of a collapsed cylinder, and where it lies on the bottom of another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Row {
    pub(super) start: i64,
    pub(super) length: i64,
    pub(super) cylinder: u32,
    pub(super) there: i64,
}

/// What became of the cylinders.
#[derive(Clone, Debug)]
pub(super) struct Snapped {
    pub(super) tables: Tables,
    /// Parts of the cylinders that were collapsed; the others they lie on may be collapsed as well.
    pub(super) collapsed: Vec<Option<Vec<Row>>>,
    /// How far the top of each cylinder was turned.
    pub(super) shears: Vec<i64>,
}

/// Collapses thin cylinders, thinnest first, and then snaps twists.
pub(super) fn snap(tables: Tables, options: &SnapOptions) -> Snapped {
    let count = tables.heights.len();
    let mut snapped = Snapped {
        tables,
        collapsed: vec![None; count],
        shears: vec![0; count],
    };
    let areas = snapped
        .tables
        .heights
        .iter()
        .zip(&snapped.tables.circumferences);
    let area: f64 = areas.map(|(&h, &c)| h as f64 * c as f64).sum();
    let least = |share: f64| share * area.sqrt();
    let mut refused = vec![false; count];
    while let Some(cylinder) = snapped.thinnest(&refused, least(options.thin)) {
        refused[cylinder as usize] = !snapped.collapse(cylinder, least(options.sliver));
    }
    for cylinder in 0..count as u32 {
        snapped.straighten(cylinder, least(options.twist));
    }
    snapped
}

impl Snapped {
    fn thinnest(&self, refused: &[bool], thin: f64) -> Option<u32> {
        let heights = &self.tables.heights;
        let is_thin =
            |&c: &usize| self.collapsed[c].is_none() && !refused[c] && (heights[c] as f64) < thin;
        let thin = (0..heights.len()).filter(is_thin);
        thin.min_by_key(|&c| (heights[c], c)).map(|c| c as u32)
    }

    /// Collapses a cylinder, with those that lie beside it between the same two graphs; returns whether
    /// that was possible.
    fn collapse(&mut self, cylinder: u32, sliver: f64) -> bool {
        let graphs = self.graphs();
        let [bottom, top] = graphs[cylinder as usize];
        let is_end = |top: bool| {
            let mut joints = self.tables.along(cylinder, top);
            joints.any(|(joint, _)| self.tables.joints[joint].end.is_some())
        };
        if bottom == top || is_end(false) || is_end(true) {
            return false;
        }
        let heights = self.moved(cylinder, &graphs);
        let left = |c: &u32| self.collapsed[*c as usize].is_none();
        let gone: Vec<u32> = (0..heights.len() as u32)
            .filter(left)
            .filter(|&c| heights[c as usize] <= 0)
            .collect();
        let mut tables = self.tables.clone();
        tables.heights = heights;
        let mut collapsed = self.collapsed.clone();
        for gone in gone {
            let is_beside = graphs[gone as usize] == [bottom, top];
            if !is_beside || tables.heights[gone as usize] < 0 {
                return false;
            }
            let sliver = sliver.min(NEARER * self.tables.heights[cylinder as usize] as f64);
            let Some(rows) = overlay(&mut tables, gone, sliver) else {
                return false;
            };
            collapsed[gone as usize] = Some(rows);
        }
        (self.tables, self.collapsed) = (tables, collapsed);
        true
    }

    /// Heights after the graph at the top of a cylinder met that at its bottom: where it leaves the other
    /// cylinders most alike.
    fn moved(&self, cylinder: u32, graphs: &[[u32; 2]]) -> Vec<i64> {
        let [bottom, top] = graphs[cylinder as usize];
        let heights = &self.tables.heights;
        let gone = heights[cylinder as usize];
        let moved = |down: i64| -> Vec<i64> {
            let rise = |graph: u32| match graph {
                graph if graph == top => -down,
                graph if graph == bottom => gone - down,
                _ => 0,
            };
            let own = heights.iter().zip(graphs);
            own.map(|(height, own)| height + rise(own[1]) - rise(own[0]))
                .collect()
        };
        let likeness = |after: &[i64]| {
            let is_other = |c: &usize| self.collapsed[*c].is_none() && graphs[*c] != [bottom, top];
            let shares = (0..heights.len()).filter(is_other).map(|c| {
                let [before, after] = [heights[c], after[c]].map(|h| h.max(0) as f64);
                before.min(after) / before.max(after).max(1.0)
            });
            shares.fold(1.0, f64::min)
        };
        let ways = [gone, 0, gone / 2].map(|down| {
            let after = moved(down);
            (likeness(&after), after)
        });
        let [first, ways @ ..] = ways;
        // The first one of equals.
        ways.into_iter()
            .fold(first, |best, way| if way.0 > best.0 { way } else { best })
            .1
    }

    /// For each cylinder the critical graphs of its bottom and top: borders that joints connect.
    fn graphs(&self) -> Vec<[u32; 2]> {
        let count = self.tables.heights.len() as u32;
        let mut graphs: Vec<[u32; 2]> = (0..count).map(|c| [2 * c, 2 * c + 1]).collect();
        loop {
            let mut changed = false;
            for joint in &self.tables.joints {
                let (Some((below, _)), Some((above, _))) = (joint.below, joint.above) else {
                    continue;
                };
                let pair = [graphs[below as usize][1], graphs[above as usize][0]];
                let least = pair[0].min(pair[1]);
                changed |= pair[0] != pair[1];
                graphs[below as usize][1] = least;
                graphs[above as usize][0] = least;
            }
            if !changed {
                return graphs;
            }
        }
    }

    /// Turns the top of a cylinder so that its zero nearest to one of the bottom lies above it.
    fn straighten(&mut self, cylinder: u32, near: f64) {
        let size = self.tables.circumferences[cylinder as usize];
        let zeros = |top: bool| {
            let along = self.tables.along(cylinder, top);
            along
                .filter(|(joint, _)| self.tables.joints[*joint].zero.is_some())
                .map(|(_, start)| start)
        };
        let away = |from: i64, to: i64| (to - from + size / 2).rem_euclid(size) - size / 2;
        let pairs = zeros(true).flat_map(|from| zeros(false).map(move |to| away(from, to)));
        let Some(turn) = pairs.min_by_key(|turn| (turn.abs(), *turn)) else {
            return;
        };
        let is_glued = |joint: &Joint| joint.below.is_some_and(|below| below.0 == cylinder);
        if self.collapsed[cylinder as usize].is_some()
            || turn == 0
            || turn.abs() as f64 >= near.min(SHEAR * self.tables.heights[cylinder as usize] as f64)
        {
            return;
        }
        self.shears[cylinder as usize] = turn;
        for joint in self
            .tables
            .joints
            .iter_mut()
            .filter(|joint| is_glued(joint))
        {
            joint.below = joint
                .below
                .map(|(c, start)| (c, (start + turn).rem_euclid(size)));
        }
    }
}

/// Lays the top of a cylinder on its bottom; nothing if that leaves a sliver between two zeros.
fn overlay(tables: &mut Tables, cylinder: u32, sliver: f64) -> Option<Vec<Row>> {
    let size = tables.circumferences[cylinder as usize];
    let (mut rows, mut joined) = (Vec::new(), Vec::new());
    for (low, low_start) in tables.along(cylinder, false) {
        for (high, high_start) in tables.along(cylinder, true) {
            let (below, above) = (tables.joints[low], tables.joints[high]);
            for turn in [-size, 0, size] {
                let high_start = high_start + turn;
                let start = low_start.max(high_start);
                let end = (low_start + below.length).min(high_start + above.length);
                if end <= start {
                    continue;
                }
                if low_start == high_start || ((end - start) as f64) < sliver {
                    return None;
                }
                let (from, from_start) = below.below?;
                let (to, to_start) = above.above?;
                let within = |c: u32, x: i64| x.rem_euclid(tables.circumferences[c as usize]);
                let there = within(to, to_start + start - high_start);
                let length = end - start;
                joined.push(Joint {
                    below: Some((from, within(from, from_start + start - low_start))),
                    above: Some((to, there)),
                    length,
                    zero: if start == low_start {
                        below.zero
                    } else {
                        above.zero
                    },
                    end: None,
                });
                rows.push(Row {
                    start: within(cylinder, start),
                    length,
                    cylinder: to,
                    there,
                });
            }
        }
    }
    let touches = |joint: &Joint| {
        let sides = [joint.below, joint.above];
        sides.iter().flatten().any(|side| side.0 == cylinder)
    };
    tables.joints.retain(|joint| !touches(joint));
    tables.joints.extend(joined);
    Some(rows)
}
