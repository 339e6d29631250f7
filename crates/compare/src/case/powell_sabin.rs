//! Powell-Sabin splines over surfaces as runs are asked for them.

use msplines_powell_sabin::SurfaceOptions;
use serde::{Deserialize, Serialize};

use super::Form;

/// A Powell-Sabin spline through the vertices of a surface, with its options.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PowellSabinMethod {
    /// What the spline is flat over.
    pub layout: Layout,
    /// The form that lays out a surface with handles; the most even one where absent.
    pub form: Option<Form>,
    /// Vertices whose stars are removed first.
    pub puncture: Vec<u32>,
    /// The energy, and what fills the holes at the zeros.
    pub surface: SurfaceOptions,
    /// Segments along each side of a face in files of the surface; its points at the vertices of the
    /// input where absent.
    pub tessellate: Option<u32>,
    /// The basis function whose graph is made in place of a fit; only with [`Layout::Plane`].
    pub basis: Option<BasisFunction>,
    /// Middles of two charts that are laid out for pictures, in fractions of the sides of the bounding
    /// box.
    pub charts: Option<[[f64; 3]; 2]>,
    /// What is changed after the fit, in this order; only on surfaces without zeros.
    pub edits: Vec<SplineEdit>,
}

/// What a Powell-Sabin spline is flat over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Layout {
    /// A conformal atlas of the input.
    #[default]
    Atlas,
    /// The plane of the first two coordinates, over which the input is a graph.
    Plane,
}

/// A function of the normalised basis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BasisFunction {
    /// Its vertex is the nearest to this place, in fractions of the sides of the bounding box.
    pub at: [f64; 3],
    /// The corner of the Powell-Sabin triangle of that vertex: 0, 1 or 2.
    pub corner: usize,
}

/// A change of a spline at a place, which is in fractions of the sides of the bounding box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum SplineEdit {
    /// A new vertex, in the middle of the face whose middle is nearest to the place.
    Insert {
        /// The place.
        at: [f64; 3],
        /// How far the surface moves there, in fractions of the diagonal.
        #[serde(default)]
        by: [f64; 3],
        /// The normal there; that of the surface where absent.
        normal: Option<[f64; 3]>,
    },
    /// Another normal at the nearest vertex.
    Turn {
        /// The place.
        at: [f64; 3],
        /// The normal.
        normal: [f64; 3],
    },
    /// A larger or smaller control triangle of the nearest vertex.
    Scale {
        /// The place.
        at: [f64; 3],
        /// By how much it grows about the vertex.
        factor: f64,
    },
}
