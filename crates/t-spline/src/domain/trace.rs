//! Critical trajectories, from zero to zero and from face to face.
//!
//! On a face the way on is decided by whether the corner ahead lies above or below the level: positions
//! are compared, not coordinates. A trajectory ends where the corner ahead is the zero it came from,
//! because no two zeros share a level.
//!
//! # Reference
//! [He2006] §3.2, the critical graph.

use std::cmp::Ordering;

use msplines_common::mesh::Topology;

use super::error::DomainError;
use super::levels::Critical;
use super::sheet::Sheets;

/// The trajectory that leaves a zero to the right, or a boundary loop.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trajectory {
    /// What it lies on the level of.
    pub(super) critical: Critical,
    /// Face and corner that it starts from.
    pub(super) face: u32,
    pub(super) corner: usize,
    /// Its position in the frame of that face.
    pub(super) position: i32,
    /// Its length.
    pub(super) length: f64,
}

/// All critical trajectories, and the fragments above which one runs.
#[derive(Clone, Debug)]
pub(super) struct CriticalGraph {
    pub(super) trajectories: Vec<Trajectory>,
    pub(super) cut_above: Vec<bool>,
}

impl CriticalGraph {
    /// Traces all critical trajectories, in the order of their levels. O(n) for each.
    pub(super) fn trace(sheets: &Sheets) -> Result<Self, DomainError> {
        let mut graph = Self {
            trajectories: Vec::new(),
            cut_above: vec![false; sheets.fragment_count()],
        };
        for &critical in &sheets.levels.critical {
            match critical {
                Critical::Zero { vertex, .. } => graph.leave(sheets, critical, vertex)?,
                Critical::Loop { boundary, above } => {
                    let run = follow(sheets, critical, boundary, above);
                    graph.trajectories.push(run);
                }
            }
        }
        match graph
            .trajectories
            .iter()
            .find(|run| run.length.is_nan() || run.length <= 0.0)
        {
            Some(run) => Err(DomainError::Trajectory {
                vertex: sheets.mesh.faces()[run.face as usize][run.corner],
                length: run.length,
            }),
            None => Ok(graph),
        }
    }

    /// Traces what leaves a zero between a corner below and one above it, counter-clockwise.
    fn leave(
        &mut self,
        sheets: &Sheets,
        critical: Critical,
        vertex: u32,
    ) -> Result<(), DomainError> {
        for half_edge in sheets.topology().outgoing(vertex) {
            let (face, corner) = (half_edge / 3, half_edge as usize % 3);
            let positions = sheets.frame(face).positions;
            let position = positions[corner];
            let [right, left] = [1, 2].map(|i| positions[(corner + i) % 3]);
            if right < position && position < left {
                let length = self.run(sheets, half_edge).ok_or(DomainError::Trajectory {
                    vertex,
                    length: f64::NAN,
                })?;
                self.trajectories.push(Trajectory {
                    critical,
                    face,
                    corner,
                    position,
                    length,
                });
            }
        }
        Ok(())
    }

    /// The length of the trajectory that leaves the origin of a half-edge over the opposite side;
    /// nothing if it does not come back.
    fn run(&mut self, sheets: &Sheets, start: u32) -> Option<f64> {
        let (mut face, corner) = (start / 3, start as usize % 3);
        let mut frame = sheets.frame(face);
        let mut position = frame.positions[corner];
        let mut exit = Topology::next(start);
        let mut level = frame.v[corner];
        let mut length = frame.crossing(exit as usize % 3, level) - frame.u[corner];
        self.cut(sheets.fragment(face, &frame, position - 1)?);
        for _ in 0..sheets.fragment_count() {
            let (twin, beyond, shift) = sheets.over(exit, &frame)?;
            (face, frame, position) = (twin / 3, beyond, position + shift);
            level = sheets.levels.value(position);
            self.cut(sheets.fragment(face, &frame, position - 1)?);
            let entered = frame.crossing(twin as usize % 3, level);
            let ahead = Topology::previous(twin);
            exit = match frame.positions[ahead as usize % 3].cmp(&position) {
                Ordering::Equal => return Some(length + frame.u[ahead as usize % 3] - entered),
                Ordering::Greater => Topology::next(twin),
                Ordering::Less => ahead,
            };
            length += frame.crossing(exit as usize % 3, level) - entered;
        }
        None
    }

    fn cut(&mut self, below: u32) {
        self.cut_above[below as usize] = true;
    }
}

/// A boundary loop as a trajectory.
fn follow(sheets: &Sheets, critical: Critical, boundary: u32, above: bool) -> Trajectory {
    let half_edges = &sheets.values.loops[boundary as usize];
    let along = |&half_edge: &u32| {
        let (frame, side) = (sheets.frame(half_edge / 3), half_edge as usize % 3);
        frame.u[(side + 1) % 3] - frame.u[side]
    };
    // With the surface on its left a loop runs to the right below it.
    let sum: f64 = half_edges.iter().map(along).sum();
    let (face, corner) = (half_edges[0] / 3, half_edges[0] as usize % 3);
    Trajectory {
        critical,
        face,
        corner,
        position: sheets.frame(face).positions[corner],
        length: if above { sum } else { -sum },
    }
}
