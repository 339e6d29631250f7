//! Powell-Sabin splines over surfaces as runs are asked for them.

use msplines_powell_sabin::SurfaceOptions;
use serde::{Deserialize, Serialize};

use super::Form;

/// A Powell-Sabin spline through the vertices of a surface, with its options.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PowellSabinMethod {
    /// The form that lays out a surface with handles; the most even one where absent.
    pub form: Option<Form>,
    /// Vertices whose stars are removed first.
    pub puncture: Vec<u32>,
    /// The energy, and what fills the holes at the zeros.
    pub surface: SurfaceOptions,
    /// Segments along each side of a face in files of the surface; its points at the vertices of the
    /// input where absent.
    pub tessellate: Option<u32>,
}
