//! Triangles on the grid of samples.
//!
//! Corners are rounded to 1/256 of a sample and sides are tested in whole numbers, so that two
//! faces that share an edge leave no gap along it and cover no sample twice.

use std::ops::Range;

use nalgebra::Vector3;

use super::frame::Frame;

/// A triangle on the grid, within the guard band around the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    /// Columns of the corners, in parts of a sample.
    x: [i32; 3],
    /// Rows of the corners, in parts of a sample.
    y: [i32; 3],
    /// Inverse depths of the corners.
    inverse: [f32; 3],
    /// Number of the face in the scene.
    pub(super) id: u32,
}

/// Parts of a sample to which corners are rounded.
const PARTS: i64 = 256;

/// Adds the triangles that a face gives: one, or more where the edge of sight cuts it, or none
/// where it covers no sample. `corners` are in the camera's axes.
pub(super) fn add(corners: [Vector3<f64>; 3], id: u32, frame: &Frame, to: &mut Vec<Triangle>) {
    let planes = frame.planes();
    let inside = |v: &Vector3<f64>| planes.iter().all(|(n, d)| n.dot(v) >= *d);
    if corners.iter().all(inside) {
        to.extend(Triangle::snap(&corners, id, frame));
        return;
    }
    if planes
        .iter()
        .any(|(n, d)| corners.iter().all(|v| n.dot(v) < *d))
    {
        return;
    }
    let polygon = planes
        .iter()
        .fold(corners.to_vec(), |polygon, (n, d)| clip(&polygon, n, *d));
    for i in 2..polygon.len() {
        let part = [polygon[0], polygon[i - 1], polygon[i]];
        to.extend(Triangle::snap(&part, id, frame));
    }
}

/// Returns the part of a convex polygon with `n·v >= d`.
fn clip(polygon: &[Vector3<f64>], n: &Vector3<f64>, d: f64) -> Vec<Vector3<f64>> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, to) in polygon.iter().enumerate() {
        let from = &polygon[(i + polygon.len() - 1) % polygon.len()];
        let [a, b] = [n.dot(from) - d, n.dot(to) - d];
        if (a >= 0.0) != (b >= 0.0) {
            kept.push(from + (to - from) * (a / (a - b)));
        }
        if b >= 0.0 {
            kept.push(*to);
        }
    }
    kept
}

impl Triangle {
    /// Returns the rounded triangle; `None` if it covers no sample.
    fn snap(corners: &[Vector3<f64>; 3], id: u32, frame: &Frame) -> Option<Self> {
        let projected = corners.map(|corner| frame.project(&corner));
        // Coordinates whose squares overflow come here as NaN.
        if !projected.iter().flatten().all(|value| value.is_finite()) {
            return None;
        }
        let part = |value: f64| (value * PARTS as f64).round() as i32;
        let mut triangle = Self {
            x: projected.map(|p| part(p[0])),
            y: projected.map(|p| part(p[1])),
            inverse: corners.map(|corner| (1.0 / corner.z) as f32),
            id,
        };
        let area = triangle.area();
        if area < 0 {
            triangle.x.swap(1, 2);
            triangle.y.swap(1, 2);
            triangle.inverse.swap(1, 2);
        }
        let empty = triangle.rows(frame).is_empty() || triangle.columns(frame).is_empty();
        (area != 0 && !empty).then_some(triangle)
    }

    /// Returns twice the area in squared parts, positive if the corners run clockwise as seen.
    fn area(&self) -> i64 {
        let [x, y] = [self.x.map(i64::from), self.y.map(i64::from)];
        (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
    }

    /// Returns the rows of samples it may cover.
    pub(super) fn rows(&self, frame: &Frame) -> Range<usize> {
        span(self.y, frame.height)
    }

    fn columns(&self, frame: &Frame) -> Range<usize> {
        span(self.x, frame.width)
    }

    /// Calls `put` with the place in the band and the inverse depth of every sample it covers in
    /// these rows.
    pub(super) fn cover(&self, frame: &Frame, band: Range<usize>, mut put: impl FnMut(usize, f32)) {
        let rows = self.rows(frame);
        let columns = self.columns(frame);
        let [x, y] = [self.x.map(i64::from), self.y.map(i64::from)];
        let centre = |index: usize| index as i64 * PARTS + PARTS / 2;
        // Side i is opposite of corner i; it grows to the inside.
        let step = [0, 1, 2].map(|i| {
            let [a, b] = [(i + 1) % 3, (i + 2) % 3];
            [y[a] - y[b], x[b] - x[a]]
        });
        // A sample right on a side belongs to one of the two faces that share it.
        let rim = step.map(|[across, down]| i64::from(!(across > 0 || (across == 0 && down > 0))));
        let area = self.area() as f64;
        let weigh = |side: [f64; 3]| -> f64 {
            (0..3)
                .map(|i| side[i] * f64::from(self.inverse[i]))
                .sum::<f64>()
                / area
        };
        let slope = weigh(step.map(|[across, _]| (across * PARTS) as f64));
        for row in rows.start.max(band.start)..rows.end.min(band.end) {
            let mut side = [0, 1, 2].map(|i| {
                let a = (i + 1) % 3;
                step[i][0] * (centre(columns.start) - x[a]) + step[i][1] * (centre(row) - y[a])
            });
            let start = weigh(side.map(|s| s as f64));
            let place = (row - band.start) * frame.width;
            for column in columns.clone() {
                if side[0] >= rim[0] && side[1] >= rim[1] && side[2] >= rim[2] {
                    let along = (column - columns.start) as f64;
                    put(place + column, (start + slope * along) as f32);
                }
                for i in 0..3 {
                    side[i] += step[i][0] * PARTS;
                }
            }
        }
    }
}

/// Returns the samples whose centres lie between the least and the greatest of three coordinates.
fn span(parts: [i32; 3], limit: usize) -> Range<usize> {
    let [low, high] =
        [parts.iter().min(), parts.iter().max()].map(|part| i64::from(*part.unwrap_or(&0)));
    let first = (low - PARTS / 2 + PARTS - 1).div_euclid(PARTS);
    let end = (high - PARTS / 2).div_euclid(PARTS) + 1;
    let limit = limit as i64;
    let first = first.clamp(0, limit) as usize;
    first..(end.clamp(0, limit) as usize).max(first)
}

#[cfg(test)]
mod tests {
    use nalgebra::{Point3, Vector3};
    use proptest::prelude::*;

    use super::{Triangle, add};
    use crate::Camera;
    use crate::draw::Drawing;
    use crate::draw::frame::Frame;

    fn frame() -> Frame {
        let camera = Camera::looking(
            Point3::origin(),
            Point3::new(0.0, 0.0, 1.0),
            Vector3::y(),
            1.0,
        );
        Frame::new(
            &camera,
            &Drawing {
                width: 40,
                height: 40,
                samples: 1,
                ..Drawing::default()
            },
        )
    }

    fn counts(triangles: &[Triangle], frame: &Frame) -> Vec<u32> {
        let mut counts = vec![0; frame.width * frame.height];
        for triangle in triangles {
            triangle.cover(frame, 0..frame.height, |at, _| counts[at] += 1);
        }
        counts
    }

    proptest! {
        #[test]
        fn a_fan_around_a_point_covers_every_sample_once(
            x in -0.4..0.4_f64,
            y in -0.4..0.4_f64,
            corners in 3..9_usize,
        ) {
            let frame = frame();
            let middle = Vector3::new(x, y, 1.0);
            let rim = |i: usize| {
                let angle = std::f64::consts::TAU * (i % corners) as f64 / corners as f64;
                Vector3::new(9.0 * angle.cos(), 9.0 * angle.sin(), 1.0)
            };
            let mut triangles = Vec::new();
            for i in 0..corners {
                // Half of the faces are seen from behind.
                let face = [middle, rim(i), rim(i + 1)];
                let turned = [face[0], face[2], face[1]];
                add(if i % 2 == 0 { face } else { turned }, 0, &frame, &mut triangles);
            }
            prop_assert!(counts(&triangles, &frame).iter().all(|count| *count == 1));
        }
    }

    #[test]
    fn a_face_through_the_eye_is_cut_and_one_behind_it_gone() {
        let frame = frame();
        let mut triangles = Vec::new();
        let [a, b] = [Vector3::new(-9.0, 0.5, 2.0), Vector3::new(9.0, 0.5, 2.0)];
        add(
            [a, b, Vector3::new(0.0, 0.5, -5.0)],
            0,
            &frame,
            &mut triangles,
        );
        let below = counts(&triangles, &frame);
        assert!(below[..20 * 40].iter().all(|count| *count == 0));
        assert!(below[39 * 40..].iter().all(|count| *count == 1));
        let behind = [a, b, Vector3::new(0.0, 9.0, 2.0)].map(|v| v - Vector3::z() * 5.0);
        triangles.clear();
        add(behind, 0, &frame, &mut triangles);
        assert!(triangles.is_empty());
    }
}
