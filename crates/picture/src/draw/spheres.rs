//! Spheres as the rays see them, without triangles.

use std::ops::Range;

use nalgebra::Vector3;

use super::frame::Frame;
use crate::Radius;
use crate::camera::NEAR;
use crate::colour::Linear;

/// A sphere in the camera's axes that does not hold the eye.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    centre: Vector3<f64>,
    radius: f64,
    /// Colour in linear light.
    pub(super) colour: Linear,
}

impl Ball {
    /// Returns the sphere about a centre in the camera's axes; `None` where none can be seen.
    pub(super) fn new(
        centre: Vector3<f64>,
        radius: Radius,
        colour: Linear,
        frame: &Frame,
    ) -> Option<Self> {
        let radius = match radius {
            Radius::World(radius) => radius / frame.radius,
            Radius::Pixels(pixels) => pixels * frame.per_pixel * centre.z / frame.focal,
        };
        let seen = centre.z + radius > NEAR && centre.norm() > radius && radius > 0.0;
        seen.then_some(Self {
            centre,
            radius,
            colour,
        })
    }

    /// Returns the rows of samples it may cover.
    pub(super) fn rows(&self, frame: &Frame) -> Range<usize> {
        let [low, high] = self.slopes(self.centre.y);
        let at = |slope| frame.project(&Vector3::new(0.0, slope, 1.0))[1];
        Frame::clip(at(low), at(high), frame.height)
    }

    fn columns(&self, frame: &Frame) -> Range<usize> {
        let [low, high] = self.slopes(self.centre.x);
        let at = |slope| frame.project(&Vector3::new(slope, 0.0, 1.0))[0];
        Frame::clip(at(low), at(high), frame.width)
    }

    /// Returns the least and the greatest quotient of a coordinate and the depth on the sphere:
    /// the slopes of the two tangents from the eye to the circle seen along the third axis.
    fn slopes(&self, across: f64) -> [f64; 2] {
        let (z, r) = (self.centre.z, self.radius);
        let depth = z * z - r * r;
        if z <= r || depth <= 0.0 {
            return [f64::NEG_INFINITY, f64::INFINITY];
        }
        let root = r * (across * across + depth).max(0.0).sqrt();
        [(across * z - root) / depth, (across * z + root) / depth]
    }

    /// Calls `put` with the place in the band and the inverse depth of every sample it covers.
    pub(super) fn cover(&self, frame: &Frame, band: Range<usize>, mut put: impl FnMut(usize, f32)) {
        let (rows, columns) = (self.rows(frame), self.columns(frame));
        for row in rows.start.max(band.start)..rows.end.min(band.end) {
            for column in columns.clone() {
                if let Some(depth) = self.depth(&frame.ray(column, row)) {
                    let place = (row - band.start) * frame.width + column;
                    put(place, (1.0 / depth) as f32);
                }
            }
        }
    }

    /// Returns the depth at which a ray of depth 1 meets the sphere.
    fn depth(&self, ray: &Vector3<f64>) -> Option<f64> {
        // The point of the ray nearest to the centre; forming the distance there keeps the
        // digits of small, far spheres.
        let square = ray.norm_squared();
        let middle = ray.dot(&self.centre) / square;
        let inside = self.radius * self.radius - (ray * middle - self.centre).norm_squared();
        let depth = middle - (inside.max(0.0) / square).sqrt();
        (inside >= 0.0 && depth > NEAR).then_some(depth)
    }

    /// Returns the unit normal where a ray meets the sphere, or nearly meets it.
    pub(super) fn normal(&self, ray: &Vector3<f64>) -> Vector3<f32> {
        let square = ray.norm_squared();
        let middle = ray.dot(&self.centre) / square;
        let inside = self.radius * self.radius - (ray * middle - self.centre).norm_squared();
        let depth = middle - (inside.max(0.0) / square).sqrt();
        let normal = (ray * depth - self.centre).try_normalize(0.0);
        normal.unwrap_or_else(|| -Vector3::z()).cast()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Point3, Vector3};

    use super::Ball;
    use crate::draw::Drawing;
    use crate::draw::frame::Frame;
    use crate::{Camera, Radius};

    #[test]
    fn the_bounds_hold_exactly_the_covered_samples() {
        let camera = Camera::looking(
            Point3::origin(),
            Point3::new(0.0, 0.0, 1.0),
            Vector3::y(),
            1.0,
        );
        let drawing = Drawing {
            width: 300,
            height: 300,
            samples: 1,
            ..Drawing::default()
        };
        let frame = Frame::new(&camera, &drawing);
        let centre = Vector3::new(0.6, -0.4, 2.0);
        let ball = Ball::new(centre, Radius::World(0.3), [0.0; 3], &frame).expect("in sight");
        let hits = |x: usize, y: usize| ball.depth(&frame.ray(x, y)).is_some();
        let columns: Vec<_> = (0..300).filter(|x| (0..300).any(|y| hits(*x, y))).collect();
        let rows: Vec<_> = (0..300).filter(|y| (0..300).any(|x| hits(x, *y))).collect();
        // The tangent point need not lie on a sample, so a bound may be one sample wider.
        for (bound, found) in [(ball.columns(&frame), columns), (ball.rows(&frame), rows)] {
            assert!(found[0] - bound.start <= 1 && bound.end - 1 - found[found.len() - 1] <= 1);
        }
        assert!(Ball::new(Vector3::z(), Radius::World(2.0), [0.0; 3], &frame).is_none());
    }
}
