//! The angle of a solid along the twelve edges of the cube.

use serde::{Deserialize, Serialize};

use crate::spline::TrivariateSpline;

/// Points of an edge at which its angle is measured, for each span.
const POINTS: usize = 8;

/// Dihedral angles inside of a solid along the images of the twelve edges of the cube, in radians: π/2
/// for a box, π where two faces join smoothly.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Creases {
    /// Smallest angle.
    pub least: f64,
    /// Mean over regular parameters of all edges.
    pub mean: f64,
    /// Largest angle; π or more where the determinant is not positive.
    pub greatest: f64,
}

/// Returns the angles between the faces of a solid along its edges.
#[must_use]
pub fn creases(spline: &TrivariateSpline) -> Creases {
    let steps = POINTS * spline.spans();
    let mut creases = Creases {
        least: f64::INFINITY,
        mean: 0.0,
        greatest: f64::NEG_INFINITY,
    };
    for edge in 0..12 {
        let (axis, ends) = (edge / 4, [edge & 1, edge >> 1 & 1]);
        for step in 0..=steps {
            let angle = angle(spline, axis, ends, step as f64 / steps as f64);
            creases.least = creases.least.min(angle);
            creases.greatest = creases.greatest.max(angle);
            creases.mean += angle / (12 * (steps + 1)) as f64;
        }
    }
    creases
}

/// The angle from one face to the other around an edge along `axis`.
fn angle(spline: &TrivariateSpline, axis: usize, ends: [usize; 2], t: f64) -> f64 {
    let others = [(axis + 1) % 3, (axis + 2) % 3];
    let mut at = [t; 3];
    at[others[0]] = ends[0] as f64;
    at[others[1]] = ends[1] as f64;
    let jet = spline.jet(at);
    let tangent = jet.first[axis];
    // Directions into the two faces, without their share along the edge.
    let inward = [0, 1].map(|d| {
        let derivative = jet.first[others[d]] * if ends[d] == 0 { 1.0 } else { -1.0 };
        let along = tangent.dot(&derivative) / tangent.norm_squared().max(f64::MIN_POSITIVE);
        derivative - tangent * along
    });
    let handed = if ends[0] == ends[1] { 1.0 } else { -1.0 };
    let sine = handed * tangent.dot(&inward[0].cross(&inward[1])) / tangent.norm();
    let angle = sine.atan2(inward[0].dot(&inward[1]));
    if angle < 0.0 {
        angle + std::f64::consts::TAU
    } else {
        angle
    }
}
