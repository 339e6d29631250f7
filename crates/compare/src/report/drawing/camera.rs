//! From where the surface of a panel is seen.

use msplines_common::mesh::TriangleMesh;
use msplines_common::{Point3, Vector3};
use msplines_picture::{Axis, Camera, View};

use super::source::Source;
use crate::experiment::{Close, Panel, Show, UpAxis, ViewHint};

/// Degrees between the normal of a surface and the direction that a part is seen from: seen along the
/// normal it would have no shape.
const ASIDE: f64 = 30.0;

/// Returns the surface beside which a panel shows a spline; knots are known by their places on the
/// domain.
pub(super) fn framed<'a>(panel: &Panel, source: &'a Source) -> Result<&'a TriangleMesh, String> {
    Ok(match panel.show {
        Show::Knots => source.input(),
        // Charts lie in a plane of their own.
        Show::Charts => &source.charts()?.mesh,
        Show::Input
        | Show::Spline
        | Show::Error
        | Show::Field
        | Show::Target
        | Show::Checkers
        | Show::ControlTriangles
        | Show::Refinement
        | Show::Isophotes
        | Show::Cylinders
        | Show::ControlPoints
        | Show::Level => source.original(),
        Show::Rectangles => &source.of_t_spline(panel)?.field.mesh,
    })
}

/// Returns the camera of a panel; all pictures of a row are seen by the same one but close ones.
pub(super) fn camera(panel: &Panel, source: &Source) -> Result<Camera, String> {
    let mesh = framed(panel, source)?;
    let hint = panel.view.unwrap_or(source.view);
    let Some(Close { mark, at, radius }) = panel.close else {
        return Ok(Camera::framing(mesh.positions(), &seen_from(hint)));
    };
    let [low, high] = mesh.bounding_box();
    let place = match (at, mark.unwrap_or(0)) {
        (Some(at), _) => low + (high - low).component_mul(&Vector3::from(at)),
        (None, mark) => *source.knots.get(mark).ok_or_else(|| {
            let marks = source.knots.len();
            format!("no mark {mark} to come close to; there are {marks}")
        })?,
    };
    let reach = Vector3::repeat(radius * mesh.diagonal() / 3.0_f64.sqrt());
    let hint = panel.view.unwrap_or_else(|| above(mesh, &place, hint.up));
    let corner = |i: usize| {
        let sign = |axis: usize| if i >> axis & 1 == 0 { -1.0 } else { 1.0 };
        place + reach.component_mul(&Vector3::new(sign(0), sign(1), sign(2)))
    };
    let corners: [Point3<f64>; 8] = std::array::from_fn(corner);
    Ok(Camera::framing(&corners, &seen_from(hint)))
}

/// Returns a direction that sees the surface near a place from outside and a little aside.
fn above(mesh: &TriangleMesh, place: &Point3<f64>, up: UpAxis) -> ViewHint {
    let distance = |v: &usize| (mesh.positions()[*v] - place).norm();
    let nearest = (0..mesh.vertex_count()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
    let faces = nearest.map_or_else(Vec::new, |vertex| {
        let around = mesh.topology().outgoing(vertex as u32);
        around
            .map(|half_edge| mesh.face_normal(half_edge / 3))
            .collect()
    });
    let normal = faces.iter().sum::<Vector3<f64>>();
    let normal = normal.try_normalize(0.0).unwrap_or_else(Vector3::x);
    let axis = match up {
        UpAxis::X => 0,
        UpAxis::Y => 1,
        UpAxis::Z => 2,
    };
    let [upward, first, second] = [0, 1, 2].map(|i| normal[(axis + i) % 3]);
    let elevation = upward.clamp(-1.0, 1.0).asin().to_degrees();
    ViewHint {
        up,
        azimuth: second.atan2(first).to_degrees(),
        // From below its normal a surface is seen in the light, which comes from above.
        elevation: if elevation > ASIDE - 90.0 {
            elevation - ASIDE
        } else {
            elevation + ASIDE
        },
    }
}

fn seen_from(hint: ViewHint) -> View {
    View {
        azimuth: hint.azimuth.to_radians(),
        elevation: hint.elevation.to_radians(),
        up: match hint.up {
            UpAxis::X => Axis::X,
            UpAxis::Y => Axis::Y,
            UpAxis::Z => Axis::Z,
        },
        ..View::default()
    }
}

#[cfg(test)]
mod tests {
    use msplines_common::mesh::shapes;

    use super::*;

    #[test]
    fn a_place_is_seen_from_outside() {
        let mesh = shapes::sphere(5000);
        for up in [UpAxis::X, UpAxis::Y, UpAxis::Z] {
            for place in mesh.positions().iter().step_by(97) {
                let hint = above(&mesh, place, up);
                let reach = Vector3::repeat(0.1);
                let camera = Camera::framing(&[place - reach, place + reach], &seen_from(hint));
                let away = camera.eye() - camera.target(place);
                let towards = away.normalize().dot(&place.coords);
                // Thirty degrees aside, and what the normals of these faces are off.
                assert!(
                    (towards - ASIDE.to_radians().cos()).abs() < 0.05,
                    "{towards}"
                );
            }
        }
    }
}
