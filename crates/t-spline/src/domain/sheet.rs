//! Every face in a flat frame of its own, cut by critical levels into fragments.
//!
//! # Notation
//! In its frame a face has its first corner at `u = 0` and at the `v` of that vertex. Its fragment `b`,
//! an odd position, is what lies between the levels `b - 1` and `b + 1`.

use msplines_common::mesh::{NONE, Topology, TriangleMesh};

use super::form::{ONE, PeriodicForm, Values};
use super::levels::Levels;

/// A mesh, `u` along its half-edges, and `v` at its vertices.
#[derive(Clone, Debug)]
pub(super) struct Sheets {
    pub(super) mesh: TriangleMesh,
    /// `du` by half-edge.
    along: Vec<f64>,
    pub(super) values: Values,
    pub(super) levels: Levels,
    /// Where the fragments of each face start, and how many there are.
    starts: Vec<u32>,
}

/// One face in its frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) u: [f64; 3],
    pub(super) v: [i64; 3],
    pub(super) positions: [i32; 3],
}

impl Frame {
    /// The lowest fragment: the least odd position that a corner reaches.
    pub(super) fn lowest(&self) -> i32 {
        self.positions.into_iter().min().unwrap_or(0) | 1
    }

    fn highest(&self) -> i32 {
        (self.positions.into_iter().max().unwrap_or(0) - 1) | 1
    }

    /// Number of fragments: none if all corners lie on one level.
    fn fragments(&self) -> u32 {
        ((self.highest() - self.lowest()) / 2 + 1).max(0) as u32
    }

    /// `u` where a level crosses the side from corner `side`.
    pub(super) fn crossing(&self, side: usize, level: i64) -> f64 {
        let next = (side + 1) % 3;
        // From the lower end, so that both faces of an edge find the same share.
        let is_up = (self.v[side], self.positions[side]) <= (self.v[next], self.positions[next]);
        let [low, high] = if is_up { [side, next] } else { [next, side] };
        let rise = (self.v[high] - self.v[low]) as f64;
        let share = if rise > 0.0 {
            ((level - self.v[low]) as f64 / rise).clamp(0.0, 1.0)
        } else {
            0.5
        };
        self.u[low] + share * (self.u[high] - self.u[low])
    }
}

impl Sheets {
    pub(super) fn build(given: &PeriodicForm, values: Values, levels: Levels) -> Self {
        let mut sheets = Self {
            mesh: given.mesh.clone(),
            along: given.form.iter().map(|v| v[0]).collect(),
            values,
            levels,
            starts: vec![0],
        };
        let mut count = 0;
        for face in 0..given.mesh.face_count() as u32 {
            count += sheets.frame(face).fragments();
            sheets.starts.push(count);
        }
        sheets
    }

    pub(super) fn topology(&self) -> &Topology {
        self.mesh.topology()
    }

    pub(super) fn frame(&self, face: u32) -> Frame {
        let corners = self.mesh.faces()[face as usize];
        let side = 3 * face as usize;
        let lifts = &self.values.lifts[side..side + 3];
        let lifts = [0, lifts[0], -lifts[2]];
        let vertex = |i: usize| corners[i] as usize;
        Frame {
            u: [0.0, self.along[side], -self.along[side + 2]],
            v: [0, 1, 2].map(|i| self.values.of[vertex(i)] + i64::from(lifts[i]) * ONE),
            positions: [0, 1, 2]
                .map(|i| self.levels.position(corners[i]) + lifts[i] * self.levels.turn()),
        }
    }

    pub(super) fn fragment_count(&self) -> usize {
        self.starts[self.starts.len() - 1] as usize
    }

    /// The fragments of a face, by number.
    pub(super) fn fragments(&self, face: u32) -> std::ops::Range<u32> {
        self.starts[face as usize]..self.starts[face as usize + 1]
    }

    /// The number of a fragment, if the face has it.
    pub(super) fn fragment(&self, face: u32, frame: &Frame, band: i32) -> Option<u32> {
        let range = self.fragments(face);
        let index = (band - frame.lowest()).div_euclid(2);
        let number = range.start + u32::try_from(index).ok()?;
        range.contains(&number).then_some(number)
    }

    /// The other face of an edge: its half-edge, its frame, and what to add to positions.
    pub(super) fn over(&self, half_edge: u32, from: &Frame) -> Option<(u32, Frame, i32)> {
        let twin = self.topology().twin(half_edge);
        if twin == NONE {
            return None;
        }
        let frame = self.frame(twin / 3);
        let target = Topology::next(half_edge) as usize % 3;
        let shift = frame.positions[twin as usize % 3] - from.positions[target];
        Some((twin, frame, shift))
    }

    /// Twice the integral of the area form.
    pub(super) fn doubled_area(&self) -> f64 {
        let faces = 0..self.mesh.face_count() as u32;
        let doubled = |face: u32| {
            let Frame { u, v, .. } = self.frame(face);
            let [a, b] = [1, 2].map(|i| (v[i] - v[0]) as f64 / ONE as f64);
            u[1] * b - u[2] * a
        };
        faces.map(doubled).sum()
    }
}
