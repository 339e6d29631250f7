//! Segments of curves as strokes with round ends.
//!
//! A stroke keeps its width even where it lies in a surface that slopes away from the eye: what
//! counts is whether its middle line is in sight; at the sample itself only what is clearly nearer
//! hides it.

use std::ops::Range;

use nalgebra::Vector3;

use super::frame::Frame;
use crate::Curves;
use crate::camera::NEAR;
use crate::colour::Linear;

/// A segment on the grid of samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    /// Sample coordinates of the ends.
    ends: [[f64; 2]; 2],
    /// Inverse depths of the ends.
    inverse: [f64; 2],
    /// Half the width in samples.
    half: f64,
    /// Colour in linear light.
    pub(super) colour: Linear,
    /// Share of the samples it covers fully that it replaces.
    opacity: f64,
    /// Number of the object it belongs to, whose strokes together cover a sample once.
    pub(super) object: u32,
}

/// A sample hides a stroke beside its middle line if it is nearer by this many half widths.
const SLOPE: f64 = 4.0;

impl Stroke {
    /// Returns the stroke between two points in the camera's axes; `None` behind the eye.
    pub(super) fn new(
        mut ends: [Vector3<f64>; 2],
        curves: &Curves<'_>,
        object: u32,
        frame: &Frame,
    ) -> Option<Self> {
        for i in 0..2 {
            let [here, there] = [ends[i], ends[1 - i]];
            if here.z < NEAR {
                if there.z <= NEAR {
                    return None;
                }
                ends[i] = here + (there - here) * ((NEAR - here.z) / (there.z - here.z));
            }
        }
        let projected = ends.map(|end| frame.project(&end));
        let finite = projected.iter().flatten().all(|value| value.is_finite());
        let visible = finite && curves.width > 0.0 && curves.opacity > 0.0;
        visible.then(|| Self {
            ends: projected,
            inverse: ends.map(|end| 1.0 / end.z),
            half: curves.width * frame.per_pixel / 2.0,
            colour: curves.colour.to_linear(),
            opacity: curves.opacity,
            object,
        })
    }

    /// Half the width, with the soft rim.
    fn reach(&self) -> f64 {
        self.half + 0.5
    }

    /// Returns the rows of samples it may cover.
    pub(super) fn rows(&self, frame: &Frame) -> Range<usize> {
        let [a, b] = self.ends.map(|end| end[1]);
        Frame::clip(
            a.min(b) - self.reach(),
            a.max(b) + self.reach(),
            frame.height,
        )
    }

    /// Returns the columns of a row it may cover.
    fn columns(&self, y: f64, frame: &Frame) -> Range<usize> {
        let [[ax, ay], [bx, by]] = self.ends;
        let rise = by - ay;
        // The part of the segment within reach of the row, as shares of its length.
        let at = |y: f64| {
            if rise == 0.0 {
                f64::NAN
            } else {
                (y - ay) / rise
            }
        };
        let [s, t] = [at(y - self.reach()), at(y + self.reach())];
        let [s, t] = if s.is_nan() {
            [0.0, 1.0]
        } else {
            [s.min(t).clamp(0.0, 1.0), s.max(t).clamp(0.0, 1.0)]
        };
        let [from, to] = [s, t].map(|share| ax + share * (bx - ax));
        Frame::clip(
            from.min(to) - self.reach(),
            from.max(to) + self.reach(),
            frame.width,
        )
    }

    /// Calls `put` with the place in the band, the inverse depth and the share it covers, of every
    /// sample where the stroke is in sight. `near` holds the inverse depths of the whole picture.
    pub(super) fn cover(
        &self,
        frame: &Frame,
        near: &[f32],
        band: Range<usize>,
        mut put: impl FnMut(usize, f32, f32),
    ) {
        let rows = self.rows(frame);
        let [a, b] = self.ends;
        let along = [b[0] - a[0], b[1] - a[1]];
        let square = along[0] * along[0] + along[1] * along[1];
        for row in rows.start.max(band.start)..rows.end.min(band.end) {
            let y = row as f64 + 0.5;
            for column in self.columns(y, frame) {
                let p = [column as f64 + 0.5 - a[0], y - a[1]];
                let share = (p[0] * along[0] + p[1] * along[1]) / square;
                let share = if share.is_nan() {
                    0.0
                } else {
                    share.clamp(0.0, 1.0)
                };
                let foot = [share * along[0], share * along[1]];
                let off = [p[0] - foot[0], p[1] - foot[1]];
                let distance = (off[0] * off[0] + off[1] * off[1]).sqrt();
                let cover = (self.reach() - distance).clamp(0.0, 1.0);
                if cover <= 0.0 {
                    continue;
                }
                let inverse = self.inverse[0] + share * (self.inverse[1] - self.inverse[0]);
                let depth = 1.0 / inverse;
                let lifted = (depth - frame.bias).max(NEAR);
                let slope = SLOPE * self.half * depth / frame.focal;
                let middle = farthest(frame, near, [a[0] + foot[0], a[1] + foot[1]]);
                let here = near[row * frame.width + column];
                let hidden = |other: f32, depth: f64| f64::from(other) > 1.0 / depth;
                if hidden(middle, lifted) || hidden(here, (lifted - slope).max(NEAR)) {
                    continue;
                }
                let place = (row - band.start) * frame.width + column;
                put(place, (1.0 / lifted) as f32, (cover * self.opacity) as f32);
            }
        }
    }
}

/// Returns the inverse depth of the farthest thing seen at the samples around a point; 0 beside the
/// picture.
///
/// Where a surface turns away, depths differ much from one sample to the next; asking one alone
/// would cut a line along the outline into beads.
fn farthest(frame: &Frame, near: &[f32], point: [f64; 2]) -> f32 {
    let [x, y] = point;
    let inside =
        x >= 1.0 && y >= 1.0 && x < frame.width as f64 - 1.0 && y < frame.height as f64 - 1.0;
    if !inside {
        return 0.0;
    }
    let (x, y) = (x as usize, y as usize);
    let rows = [y - 1, y, y + 1].map(|row| &near[row * frame.width + x - 1..][..3]);
    rows.into_iter()
        .flatten()
        .fold(f32::MAX, |least, inverse| least.min(*inverse))
}
