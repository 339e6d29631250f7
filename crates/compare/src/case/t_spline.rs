//! T-splines over surfaces as runs are asked for them.

use msplines_t_spline::FitOptions;
use msplines_t_spline::domain::SnapOptions;
use serde::{Deserialize, Serialize};

use super::Form;

/// A T-spline that approximates a surface, with its options.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TSplineMethod {
    /// The form that cuts a closed surface with handles into cylinders; [`Form::Integer`] where absent.
    pub form: Option<Form>,
    /// Vertices that become poles. Where absent, a surface that needs some gets those farthest from each
    /// other along edges.
    pub puncture: Vec<u32>,
    /// What counts as thin and near when cylinders are cut.
    pub snap: SnapOptions,
    /// The fit. A tolerance is a fraction of the longest side of the bounding box here.
    pub fit: FitOptions,
    /// Samples inside of faces.
    pub face_samples: FaceSamples,
    /// Segments along each side of a face in files of the surface; its points at the vertices of the
    /// input where absent.
    pub tessellate: Option<u32>,
    /// Whether everything that pictures show is kept: cylinders, control points, surfaces on the way.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub pictures: bool,
}

/// How many samples a surface should have; faces too large for that are sampled inside.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FaceSamples {
    /// Samples per control point of the budget; at least the vertices are taken, and with a tolerance
    /// they set how dense samples are.
    pub per_control_point: f64,
}

impl Default for FaceSamples {
    fn default() -> Self {
        Self {
            per_control_point: 8.0,
        }
    }
}
