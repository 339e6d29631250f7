//! A perspective camera, and the one that frames given points.

use nalgebra::{Matrix3, Point3, Vector3};

/// An axis of space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axis {
    /// The first axis.
    X,
    /// The second axis.
    #[default]
    Y,
    /// The third axis.
    Z,
}

impl Axis {
    /// Returns the unit vectors of this axis and of the two that follow it cyclically.
    fn cycle(self) -> [Vector3<f64>; 3] {
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
        match self {
            Self::X => [x, y, z],
            Self::Y => [y, z, x],
            Self::Z => [z, x, y],
        }
    }
}

/// From where an object is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Angle about the up axis in radians. At 0 the eye is on the axis that follows the up axis
    /// cyclically (Z for up Y, X for up Z); it grows towards the next one.
    pub azimuth: f64,
    /// Angle above the horizon in radians, up to a quarter turn.
    pub elevation: f64,
    /// The axis that points up.
    pub up: Axis,
    /// Magnification about the middle; at 1 the object fills the picture up to a margin.
    pub zoom: f64,
    /// Width over height of the picture that the object shall fill.
    pub aspect: f64,
    /// Angle in radians that the height of the picture spans at zoom 1; below π.
    pub field_of_view: f64,
}

impl Default for View {
    fn default() -> Self {
        Self {
            azimuth: 0.5,
            elevation: 0.35,
            up: Axis::Y,
            zoom: 1.0,
            aspect: 1.0,
            field_of_view: 0.5,
        }
    }
}

/// Share of the picture's half width that stays free around a framed object.
const MARGIN: f64 = 0.05;
/// Angles of view are kept within these bounds, in radians.
const FIELD_OF_VIEW: [f64; 2] = [0.01, 3.0];
/// What lies nearer to the eye than this share of the object's radius is cut off.
pub(crate) const NEAR: f64 = 1e-3;

/// A perspective camera: where the eye is, where it looks, and how wide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: Point3<f64>,
    /// Rows: right, down, forward.
    axes: Matrix3<f64>,
    /// Tangents of half the angles that the framed rectangle spans: across and along the height.
    tangents: [f64; 2],
    /// Half the diagonal of what is looked at; unit of bias, near plane and occlusion.
    radius: f64,
}

impl Camera {
    /// Returns the camera that sees all points from the direction of `view`, as large as fits.
    ///
    /// Points that are not finite are ignored; without any other the camera looks at the origin.
    /// A box is framed through its corners. Values of `view` that make no sense (a zoom that is
    /// not positive, an angle that is not finite) are replaced by the default.
    #[must_use]
    pub fn framing(points: &[Point3<f64>], view: &View) -> Self {
        let view = sensible(view);
        let axes = directions(&view);
        let tangent = (view.field_of_view / 2.0).tan();
        let tangents = [tangent * view.aspect, tangent];
        let usable = || points.iter().filter(|p| is_usable(p));
        let (mut low, mut high) = (Vector3::repeat(f64::MAX), Vector3::repeat(f64::MIN));
        for point in usable() {
            low = low.inf(&point.coords);
            high = high.sup(&point.coords);
        }
        if low.x > high.x {
            (low, high) = (Vector3::zeros(), Vector3::zeros());
        }
        let half = (high - low).norm() / 2.0;
        let radius = if half > 0.0 { half } else { 1.0 };
        let centre = Point3::from((low + high) / 2.0);
        let offsets = usable().map(|p| axes * (p - centre));
        let eye = best_eye(offsets, tangents.map(|t| t * (1.0 - MARGIN)), radius);
        Self {
            eye: centre + axes.transpose() * eye,
            axes,
            tangents: tangents.map(|t| t / view.zoom),
            radius,
        }
    }

    /// Returns the camera at `eye` that looks at `target`; the distance between the two is the
    /// scale of what is seen.
    ///
    /// `field_of_view` is the angle in radians that the shorter side of the picture spans. `up` is
    /// replaced by another direction where it is parallel to the line of sight.
    #[must_use]
    pub fn looking(
        eye: Point3<f64>,
        target: Point3<f64>,
        up: Vector3<f64>,
        field_of_view: f64,
    ) -> Self {
        let line = target - eye;
        let forward = line.try_normalize(0.0).unwrap_or_else(|| -Vector3::z());
        let across = |up: Vector3<f64>| forward.cross(&up).try_normalize(1e-9 * up.norm());
        let right = across(up)
            .or_else(|| across(Vector3::y()))
            .or_else(|| across(Vector3::x()))
            .unwrap_or_else(Vector3::x);
        let down = forward.cross(&right);
        let radius = line.norm();
        let angle = field_of_view.clamp(FIELD_OF_VIEW[0], FIELD_OF_VIEW[1]);
        Self {
            eye,
            axes: Matrix3::from_rows(&[right.transpose(), down.transpose(), forward.transpose()]),
            tangents: [(angle / 2.0).tan(); 2],
            radius: if radius > 0.0 { radius } else { 1.0 },
        }
    }

    /// Returns the position of the eye.
    #[must_use]
    pub fn eye(&self) -> Point3<f64> {
        self.eye
    }

    /// Returns the point in the middle of the picture that is as far away as `place`: what a view
    /// of the same object turns around.
    #[must_use]
    pub fn target(&self, place: &Point3<f64>) -> Point3<f64> {
        let forward = self.axes.row(2).transpose();
        self.eye + forward * forward.dot(&(place - self.eye))
    }

    /// Returns the direction that is up in the picture, of length one.
    #[must_use]
    pub fn up(&self) -> Vector3<f64> {
        -self.axes.row(1).transpose()
    }

    /// Returns the angle that the height of the framed rectangle spans, in radians.
    #[must_use]
    pub fn field_of_view(&self) -> f64 {
        2.0 * self.tangents[1].atan()
    }

    /// Returns half the diagonal of the box around what is framed.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns a point in the camera's axes: right, down and forward from the eye, in units of the
    /// radius, so that single precision is enough for depths of objects of any size.
    pub(crate) fn to_view(self, point: &Point3<f64>) -> Vector3<f64> {
        self.axes * (point - self.eye) / self.radius
    }

    /// Returns a direction in the camera's axes.
    pub(crate) fn turned(self, direction: &Vector3<f64>) -> Vector3<f64> {
        self.axes * direction
    }

    /// Returns how many pixels the unit at distance 1 spans in a picture of this size.
    pub(crate) fn focal(&self, width: f64, height: f64) -> f64 {
        (width / 2.0 / self.tangents[0]).min(height / 2.0 / self.tangents[1])
    }
}

/// Returns whether a point is finite, and small enough for its square to be.
fn is_usable(point: &Point3<f64>) -> bool {
    point.iter().all(|c| c.abs() < 1e150)
}

fn sensible(view: &View) -> View {
    let standard = View::default();
    let angle = |angle: f64, other: f64| if angle.is_finite() { angle } else { other };
    let positive = |value: f64| {
        if value.is_finite() && value > 0.0 {
            value
        } else {
            1.0
        }
    };
    let quarter = std::f64::consts::FRAC_PI_2;
    View {
        azimuth: angle(view.azimuth, standard.azimuth),
        elevation: angle(view.elevation, standard.elevation).clamp(-quarter, quarter),
        up: view.up,
        zoom: positive(view.zoom),
        aspect: positive(view.aspect),
        field_of_view: angle(view.field_of_view, standard.field_of_view)
            .clamp(FIELD_OF_VIEW[0], FIELD_OF_VIEW[1]),
    }
}

/// Returns the rows right, down and forward of a view.
fn directions(view: &View) -> Matrix3<f64> {
    let [up, first, second] = view.up.cycle();
    let (sin, cos) = view.azimuth.sin_cos();
    let (rise, level) = view.elevation.sin_cos();
    let back = (first * cos + second * sin) * level + up * rise;
    let right = second * cos - first * sin;
    let down = right.cross(&back);
    Matrix3::from_rows(&[right.transpose(), down.transpose(), -back.transpose()])
}

/// Returns where the eye must be so that all points fit between the four planes of the view.
///
/// A point p is inside the planes left and right of an eye e if `|p.x - e.x| <= t (p.z - e.z)`, so
/// the largest `p.x - t p.z` and the smallest `p.x + t p.z` decide; likewise for the height.
fn best_eye(
    points: impl Iterator<Item = Vector3<f64>>,
    tangents: [f64; 2],
    radius: f64,
) -> Vector3<f64> {
    let mut most = [f64::MIN; 2];
    let mut least = [f64::MAX; 2];
    let mut nearest = f64::MAX;
    for point in points {
        nearest = nearest.min(point.z);
        for (i, tangent) in tangents.into_iter().enumerate() {
            most[i] = most[i].max(point[i] - tangent * point.z);
            least[i] = least[i].min(point[i] + tangent * point.z);
        }
    }
    if nearest == f64::MAX {
        return Vector3::new(0.0, 0.0, -radius / tangents[1]);
    }
    let depth = |i: usize| (least[i] - most[i]) / (2.0 * tangents[i]);
    // A flat object seen from the edge must not come right up to the eye.
    let back = depth(0).min(depth(1)).min(nearest - radius / 10.0);
    Vector3::new((most[0] + least[0]) / 2.0, (most[1] + least[1]) / 2.0, back)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use nalgebra::{Point3, Vector3};
    use proptest::prelude::*;

    use super::{Axis, Camera, NEAR, View};

    #[test]
    fn azimuth_and_elevation_say_where_the_eye_is() {
        let origin = [Point3::origin()];
        let eye = |azimuth, elevation, up| {
            let view = View {
                azimuth,
                elevation,
                up,
                ..View::default()
            };
            Camera::framing(&origin, &view).eye().coords.normalize()
        };
        assert!((eye(0.0, 0.0, Axis::Y) - Vector3::z()).norm() < 1e-12);
        assert!((eye(FRAC_PI_2, 0.0, Axis::Y) - Vector3::x()).norm() < 1e-12);
        assert!((eye(0.0, 0.0, Axis::Z) - Vector3::x()).norm() < 1e-12);
        assert!((eye(1.0, FRAC_PI_2, Axis::Z) - Vector3::z()).norm() < 1e-12);
    }

    #[test]
    fn the_target_is_in_the_middle_and_as_far_as_the_place() {
        let box_corners = [Point3::new(-1.0, 2.0, 0.5), Point3::new(3.0, 3.0, 2.0)];
        let camera = Camera::framing(&box_corners, &View::default());
        let place = nalgebra::center(&box_corners[0], &box_corners[1]);
        let (seen, target) = (camera.to_view(&place), camera.target(&place));
        let middle = camera.to_view(&target);
        assert!(middle.xy().norm() < 1e-12 && (middle.z - seen.z).abs() < 1e-12);
        assert!(camera.up().dot(&(target - camera.eye())).abs() < 1e-12);
    }

    #[test]
    fn the_axes_are_a_rotation() {
        for up in [Axis::X, Axis::Y, Axis::Z] {
            let view = View {
                up,
                azimuth: 2.0,
                elevation: -1.0,
                ..View::default()
            };
            let axes = Camera::framing(&[], &view).axes;
            assert!((axes.determinant() - 1.0).abs() < 1e-12);
        }
        let looking = Camera::looking(Point3::origin(), Point3::origin(), Vector3::z(), f64::NAN);
        assert!((looking.axes.determinant() - 1.0).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn framed_points_lie_inside_and_touch_the_margin(
            coordinates in prop::collection::vec(-5.0..5.0_f64, 12..60),
            azimuth in -7.0..7.0_f64,
            elevation in -1.5..1.5_f64,
            aspect in 0.3..3.0_f64,
        ) {
            let points: Vec<_> =
                coordinates.chunks_exact(3).map(|c| Point3::new(c[0], c[1], c[2])).collect();
            let view = View { azimuth, elevation, aspect, ..View::default() };
            let camera = Camera::framing(&points, &view);
            let mut largest = 0.0_f64;
            for point in &points {
                let seen = camera.to_view(point);
                prop_assert!(seen.z > NEAR);
                for i in 0..2 {
                    largest = largest.max((seen[i] / seen.z / camera.tangents[i]).abs());
                }
            }
            prop_assert!((0.5..0.95 + 1e-9).contains(&largest), "{}", largest);
        }
    }

    #[test]
    fn what_is_not_finite_is_ignored() {
        let wild = [
            Point3::new(f64::NAN, 0.0, 0.0),
            Point3::new(0.0, 1e300, 0.0),
            Point3::origin(),
        ];
        let wrong = View {
            zoom: -1.0,
            azimuth: f64::NAN,
            aspect: 0.0,
            ..View::default()
        };
        let camera = Camera::framing(&wild, &wrong);
        assert_eq!(
            camera,
            Camera::framing(&[Point3::origin()], &View::default())
        );
        assert!(camera.eye().iter().all(|c| c.is_finite()));
    }
}
