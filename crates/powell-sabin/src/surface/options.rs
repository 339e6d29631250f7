//! What can be chosen about a surface.

use serde::{Deserialize, Serialize};

use crate::options::Options;

/// Options of [`fit_surface`](crate::fit_surface).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SurfaceOptions {
    /// How the spline away from the zeros is fitted, and that inside of smooth caps.
    pub spline: Options,
    /// What is done with the holes at the zeros of the form.
    pub fill: Fill,
}

/// How the holes at zeros of the form are filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fill {
    /// They stay open.
    Open,
    /// By minimal surfaces, which meet the spline along its rim but not its tangent planes, and pass
    /// through no vertex inside.
    Minimal,
    /// By splines over a chart in which the zero is a regular point, blended with the surface around:
    /// C1 everywhere, through all vertices, with their normals.
    #[default]
    Smooth,
}

impl SurfaceOptions {
    /// The energy and the fill of the paper.
    ///
    /// # Reference
    /// [He2005] Eq. (9), §3.3.
    pub const PAPER: Self = Self {
        spline: Options::PAPER,
        fill: Fill::Minimal,
    };
}
