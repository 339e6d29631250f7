//! The grid of samples: from the camera's axes to rows and columns.

use std::ops::Range;

use nalgebra::Vector3;

use super::Drawing;
use crate::camera::NEAR;
use crate::{Camera, Rect};

/// Where the samples of a picture lie. Sample (i, j) is at (i + ½, j + ½).
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// Samples in a row.
    pub(super) width: usize,
    /// Rows of samples.
    pub(super) height: usize,
    /// Samples along each side of a pixel.
    pub(super) samples: usize,
    /// Samples that the unit at depth 1 spans.
    pub(super) focal: f64,
    /// Sample coordinates of the line of sight.
    centre: [f64; 2],
    /// Half the diagonal of what is looked at, which is the unit of the camera's axes.
    pub(super) radius: f64,
    /// How much nearer curves are drawn, in that unit.
    pub(super) bias: f64,
    /// Samples per pixel of the whole picture, in which widths of lines and marks are given.
    pub(super) per_pixel: f64,
}

/// Returns the width and height in pixels of what a drawing gives.
pub(super) fn size(drawing: &Drawing) -> (usize, usize) {
    match drawing.detail {
        None => (drawing.width, drawing.height),
        Some(detail) => (
            detail.source.width.saturating_mul(detail.magnification),
            detail.source.height.saturating_mul(detail.magnification),
        ),
    }
}

impl Frame {
    /// Returns the samples of a drawing whose size has been checked.
    pub(super) fn new(camera: &Camera, drawing: &Drawing) -> Self {
        let (width, height) = size(drawing);
        let [whole_width, whole_height] = [drawing.width as f64, drawing.height as f64];
        let (corner, magnification) = match drawing.detail {
            None => (Rect::default(), 1),
            Some(detail) => (detail.source, detail.magnification),
        };
        let per_pixel = (magnification * drawing.samples) as f64;
        Self {
            width: width.saturating_mul(drawing.samples),
            height: height.saturating_mul(drawing.samples),
            samples: drawing.samples,
            focal: camera.focal(whole_width, whole_height) * per_pixel,
            centre: [
                (whole_width / 2.0 - corner.x as f64) * per_pixel,
                (whole_height / 2.0 - corner.y as f64) * per_pixel,
            ],
            radius: camera.radius(),
            bias: drawing.bias,
            per_pixel,
        }
    }

    /// Returns the sample coordinates of a point before the eye, given in the camera's axes.
    pub(super) fn project(&self, point: &Vector3<f64>) -> [f64; 2] {
        let scale = self.focal / point.z;
        [
            self.centre[0] + scale * point.x,
            self.centre[1] + scale * point.y,
        ]
    }

    /// Returns the ray through a sample, scaled to depth 1.
    pub(super) fn ray(&self, x: usize, y: usize) -> Vector3<f64> {
        Vector3::new(
            (x as f64 + 0.5 - self.centre[0]) / self.focal,
            (y as f64 + 0.5 - self.centre[1]) / self.focal,
            1.0,
        )
    }

    /// Returns the ray through the middle of a pixel, scaled to depth 1.
    pub(super) fn pixel_ray(&self, x: usize, y: usize) -> Vector3<f64> {
        let middle = |pixel: usize| (pixel as f64 + 0.5) * self.samples as f64;
        Vector3::new(
            (middle(x) - self.centre[0]) / self.focal,
            (middle(y) - self.centre[1]) / self.focal,
            1.0,
        )
    }

    /// Returns the planes `n·v >= d` that keep points before the eye, and not farther outside of
    /// the picture than its own size.
    pub(super) fn planes(&self) -> [(Vector3<f64>, f64); 5] {
        let [w, h] = [self.width as f64, self.height as f64];
        let [cx, cy] = self.centre;
        let f = self.focal;
        [
            (Vector3::z(), NEAR),
            (Vector3::new(f, 0.0, cx + w), 0.0),
            (Vector3::new(-f, 0.0, 2.0 * w - cx), 0.0),
            (Vector3::new(0.0, f, cy + h), 0.0),
            (Vector3::new(0.0, -f, 2.0 * h - cy), 0.0),
        ]
    }

    /// Returns the whole samples, clipped to `0..limit`, whose centres lie in `low..=high`.
    pub(super) fn clip(low: f64, high: f64, limit: usize) -> Range<usize> {
        // Casts saturate, so that huge values end at the limit and NaN gives nothing.
        let first = ((low - 0.5).ceil().max(0.0) as usize).min(limit);
        let end = ((high + 0.5).floor().max(0.0) as usize).min(limit);
        first..end.max(first)
    }
}

/// Returns, for each band of rows, the indices of the items that reach into it, in order.
pub(super) fn bins(
    rows: impl Iterator<Item = Range<usize>>,
    height: usize,
    bands: usize,
) -> Vec<Vec<u32>> {
    let mut bins = vec![Vec::new(); bands];
    for (index, range) in rows.enumerate().filter(|(_, range)| !range.is_empty()) {
        let last = ((range.end - 1) / height).min(bands - 1);
        for bin in &mut bins[(range.start / height).min(last)..=last] {
            bin.push(index as u32);
        }
    }
    bins
}

#[cfg(test)]
mod tests {
    use nalgebra::{Point3, Vector3};

    use super::{Frame, bins};
    use crate::draw::{Detail, Drawing};
    use crate::{Camera, Rect};

    fn camera() -> Camera {
        Camera::looking(
            Point3::new(1.0, 2.0, 9.0),
            Point3::origin(),
            Vector3::y(),
            0.6,
        )
    }

    #[test]
    fn a_ray_through_a_sample_projects_to_its_centre() {
        let frame = Frame::new(&camera(), &Drawing::default());
        let [x, y] = frame.project(&(frame.ray(123, 45) * 7.0));
        assert!((x - 123.5).abs() < 1e-9 && (y - 45.5).abs() < 1e-9);
    }

    #[test]
    fn a_detail_sees_what_the_whole_sees() {
        let drawing = Drawing {
            width: 100,
            height: 80,
            samples: 2,
            ..Drawing::default()
        };
        let source = Rect {
            x: 30,
            y: 20,
            width: 10,
            height: 12,
        };
        let detail = Some(Detail {
            source,
            magnification: 4,
        });
        let whole = Frame::new(&camera(), &drawing);
        let part = Frame::new(&camera(), &Drawing { detail, ..drawing });
        assert_eq!((part.width, part.height), (80, 96));
        let point = whole.ray(65, 43);
        let [x, y] = part.project(&point);
        // (65.5, 43.5) are samples of the whole; the source starts at (60, 40).
        assert!((x - 4.0 * 5.5).abs() < 1e-9 && (y - 4.0 * 3.5).abs() < 1e-9);
    }

    #[test]
    fn ranges_end_at_the_picture() {
        assert_eq!(Frame::clip(-1e300, f64::INFINITY, 9), 0..9);
        assert_eq!(Frame::clip(2.6, 3.4, 9), 3..3);
        assert_eq!(Frame::clip(2.5, 3.5, 9), 2..4);
        assert!(Frame::clip(f64::NAN, f64::NAN, 9).is_empty());
    }

    #[test]
    fn an_item_is_in_every_band_it_reaches() {
        let bins = bins([0..1, 3..9, 4..4, 11..12].into_iter(), 4, 3);
        assert_eq!(bins, [vec![0, 1], vec![1], vec![1, 3]]);
    }
}
