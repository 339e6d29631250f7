//! Maximal cylinders: fragments of faces that no critical trajectory parts.
//!
//! # Notation
//! The *chart* of a fragment is what takes the frame of its face to the coordinates of its cylinder: a
//! translation `u` and a lift.

use std::collections::VecDeque;

use super::error::DomainError;
use super::form::ONE;
use super::levels::Critical;
use super::sheet::{Frame, Sheets};
use super::trace::{CriticalGraph, Trajectory};

/// Relative errors of sums over the rounding of some hundred faces that are not errors of ours.
const CLOSURE: f64 = 1e-9;

/// Where a fragment lies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chart {
    pub(super) cylinder: u32,
    /// Added to `u` of the frame.
    pub(super) u: f64,
    /// Turns added to `v` of the frame.
    pub(super) lift: i32,
}

/// A cylinder in real numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct RealCylinder {
    pub(super) circumference: f64,
    /// `u` where a trajectory of its bottom starts.
    pub(super) origin: f64,
    /// Positions of its bottom and its top.
    pub(super) borders: [i32; 2],
}

/// A critical trajectory between the cylinders below and above it, with the `u` where it starts in each,
/// relative to the origin there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub(super) critical: Critical,
    pub(super) length: f64,
    pub(super) below: Option<(u32, f64)>,
    pub(super) above: Option<(u32, f64)>,
}

/// Cylinders and what lies between them.
#[derive(Clone, Debug)]
pub(super) struct Cylinders {
    pub(super) cylinders: Vec<RealCylinder>,
    pub(super) links: Vec<Link>,
    /// Charts of the fragments.
    pub(super) charts: Vec<Chart>,
    /// Largest miss of a border, as a share of its circumference.
    pub(super) closure: f64,
    /// Sum of `C H` over the integral of the area form, less 1.
    pub(super) area_defect: f64,
}

impl Cylinders {
    /// Unites fragments, and checks that every border closes up. O(n).
    pub(super) fn unite(sheets: &Sheets, graph: &CriticalGraph) -> Result<Self, DomainError> {
        let (charts, count) = flood(sheets, &graph.cut_above);
        let mut links: Vec<Link> = (graph.trajectories.iter())
            .map(|run| link(sheets, &charts, run))
            .collect();
        let mut cylinders = Self {
            cylinders: borders(sheets, graph, &charts, count)?,
            links: Vec::new(),
            charts,
            closure: 0.0,
            area_defect: 0.0,
        };
        for link in &mut links {
            for (cylinder, u) in [&mut link.below, &mut link.above].into_iter().flatten() {
                let own = cylinders.cylinders[*cylinder as usize];
                *u = (*u - own.origin).rem_euclid(own.circumference);
            }
        }
        cylinders.links = links;
        cylinders.check_count(sheets)?;
        cylinders.check_closure()?;
        cylinders.check_area(sheets)?;
        Ok(cylinders)
    }

    /// The links at the bottoms or tops of all cylinders, by where they start; the first one of a
    /// bottom starts at 0.
    pub(super) fn along(&self, cylinder: u32, top: bool) -> Vec<(usize, f64)> {
        let side = |link: &Link| if top { link.below } else { link.above };
        let links = self.links.iter().enumerate();
        let mut found: Vec<(usize, f64)> = links
            .filter_map(|(index, link)| side(link).map(|(c, u)| (index, c, u)))
            .filter(|&(_, own, _)| own == cylinder)
            .map(|(index, _, u)| (index, u))
            .collect();
        found.sort_by(|a, b| a.1.total_cmp(&b.1));
        found
    }

    /// Simple zeros leave pairs of pants, each of which has three borders of cylinders.
    fn check_count(&self, sheets: &Sheets) -> Result<(), DomainError> {
        let mut borders = 0;
        for critical in &sheets.levels.critical {
            borders += match critical {
                Critical::Zero { order: 1, .. } => 3,
                Critical::Zero { order: 0, .. } => 2,
                Critical::Zero { .. } => return Ok(()),
                Critical::Loop { .. } => 1,
            };
        }
        let (found, expected) = (self.cylinders.len(), borders / 2);
        if found == expected {
            Ok(())
        } else {
            Err(DomainError::Cylinders { found, expected })
        }
    }

    fn check_closure(&mut self) -> Result<(), DomainError> {
        for cylinder in 0..self.cylinders.len() as u32 {
            let size = self.cylinders[cylinder as usize].circumference;
            for top in [false, true] {
                let along = self.along(cylinder, top);
                let starts = along.iter().skip(1).map(|found| found.1);
                let around = along.first().map(|found| found.1 + size);
                for (&(index, start), next) in along.iter().zip(starts.chain(around)) {
                    let miss = (start + self.links[index].length - next).abs() / size;
                    self.closure = self.closure.max(miss);
                    // NaN counts.
                    if miss.is_nan() || miss > CLOSURE {
                        return Err(DomainError::Closure { cylinder, miss });
                    }
                }
            }
        }
        Ok(())
    }

    fn check_area(&mut self, sheets: &Sheets) -> Result<(), DomainError> {
        let area = |c: &RealCylinder| {
            let [bottom, top] = c.borders.map(|p| sheets.levels.value(p));
            c.circumference * (top - bottom) as f64 / ONE as f64
        };
        let share = 2.0 * self.cylinders.iter().map(area).sum::<f64>() / sheets.doubled_area();
        self.area_defect = share - 1.0;
        if self.area_defect.abs() <= CLOSURE {
            Ok(())
        } else {
            Err(DomainError::Area { share })
        }
    }
}

/// Charts of all fragments, and the number of cylinders.
fn flood(sheets: &Sheets, cut_above: &[bool]) -> (Vec<Chart>, u32) {
    let mut charts: Vec<Option<Chart>> = vec![None; sheets.fragment_count()];
    let mut count = 0;
    for face in 0..sheets.mesh.face_count() as u32 {
        for (first, number) in sheets.fragments(face).enumerate() {
            if charts[number as usize].is_some() {
                continue;
            }
            charts[number as usize] = Some(Chart {
                cylinder: count,
                u: 0.0,
                lift: 0,
            });
            let band = sheets.frame(face).lowest() + 2 * first as i32;
            spread(sheets, cut_above, &mut charts, (face, number, band));
            count += 1;
        }
    }
    let known = charts.into_iter().flatten().collect();
    (known, count)
}

fn spread(
    sheets: &Sheets,
    cut_above: &[bool],
    charts: &mut [Option<Chart>],
    start: (u32, u32, i32),
) {
    let mut queue = VecDeque::from([start]);
    while let Some((face, number, band)) = queue.pop_front() {
        let Some(chart) = charts[number as usize] else {
            continue;
        };
        let frame = sheets.frame(face);
        let mut reach = |face: u32, number: u32, band: i32, chart: Chart| {
            if charts[number as usize].is_none() {
                charts[number as usize] = Some(chart);
                queue.push_back((face, number, band));
            }
        };
        let own = sheets.fragments(face);
        if !cut_above[number as usize] && number + 1 < own.end {
            reach(face, number + 1, band + 2, chart);
        }
        if number > own.start && !cut_above[number as usize - 1] {
            reach(face, number - 1, band - 2, chart);
        }
        for side in 0..3 {
            if let Some((face, number, band, chart)) =
                beside(sheets, (face, side), &frame, band, chart)
            {
                reach(face, number, band, chart);
            }
        }
    }
}

/// The fragment on the other side of an edge, if the band reaches the edge.
fn beside(
    sheets: &Sheets,
    (face, side): (u32, usize),
    frame: &Frame,
    band: i32,
    chart: Chart,
) -> Option<(u32, u32, i32, Chart)> {
    let next = (side + 1) % 3;
    let ends = [frame.positions[side], frame.positions[next]];
    if band < ends[0].min(ends[1]) || band > ends[0].max(ends[1]) {
        return None;
    }
    let (twin, beyond, shift) = sheets.over(3 * face + side as u32, frame)?;
    let number = sheets.fragment(twin / 3, &beyond, band + shift)?;
    let chart = Chart {
        cylinder: chart.cylinder,
        u: chart.u + frame.u[next] - beyond.u[twin as usize % 3],
        lift: chart.lift - shift / sheets.levels.turn(),
    };
    Some((twin / 3, number, band + shift, chart))
}

/// The charts below and above where a trajectory starts.
fn sides(sheets: &Sheets, charts: &[Chart], run: &Trajectory) -> [Option<Chart>; 2] {
    let frame = sheets.frame(run.face);
    [-1, 1].map(|step| {
        let number = sheets.fragment(run.face, &frame, run.position + step)?;
        Some(charts[number as usize])
    })
}

fn link(sheets: &Sheets, charts: &[Chart], run: &Trajectory) -> Link {
    let u = sheets.frame(run.face).u[run.corner];
    let [below, above] = sides(sheets, charts, run).map(|side| side.map(|c| (c.cylinder, c.u + u)));
    Link {
        critical: run.critical,
        length: run.length,
        below,
        above,
    }
}

/// Sizes of cylinders from the trajectories on their borders.
fn borders(
    sheets: &Sheets,
    graph: &CriticalGraph,
    charts: &[Chart],
    count: u32,
) -> Result<Vec<RealCylinder>, DomainError> {
    let mut lengths = vec![[0.0; 2]; count as usize];
    let mut found = vec![[None; 2]; count as usize];
    let mut origins = vec![0.0; count as usize];
    for run in &graph.trajectories {
        let u = sheets.frame(run.face).u[run.corner];
        let sides = sides(sheets, charts, run);
        for (border, chart) in [1, 0].into_iter().zip(sides) {
            let Some(chart) = chart else { continue };
            let position = run.position + chart.lift * sheets.levels.turn();
            let cylinder = chart.cylinder as usize;
            let known = &mut found[cylinder][border];
            if border == 0 && known.is_none() {
                origins[cylinder] = chart.u + u;
            }
            if known.is_some_and(|known| known != position) {
                let (found, expected) = (count as usize, count as usize + 1);
                return Err(DomainError::Cylinders { found, expected });
            }
            *known = Some(position);
            lengths[cylinder][border] += run.length;
        }
    }
    let sizes = lengths.into_iter().zip(found).zip(origins);
    sizes
        .zip(0..)
        .map(|(((lengths, found), origin), cylinder)| {
            let [bottom, top]: [f64; 2] = lengths;
            let miss = (bottom - top).abs() / bottom;
            let [Some(low), Some(high)] = found else {
                let miss = f64::NAN;
                return Err(DomainError::Closure { cylinder, miss });
            };
            // NaN counts.
            if miss.is_nan() || miss > CLOSURE {
                return Err(DomainError::Closure { cylinder, miss });
            }
            Ok(RealCylinder {
                circumference: bottom,
                origin,
                borders: [low, high],
            })
        })
        .collect()
}
