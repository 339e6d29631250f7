//! Polygon meshes: control meshes of subdivision surfaces and of manifolds over quads.
//!
//! [`PolygonMesh`] holds polygons of any size; [`Sharpness`] says along which edges and at which
//! vertices its Catmull-Clark surface is not smooth. [`catmull_clark`] refines both, and
//! [`limit_stencils`] takes every point of the control mesh to its place on the limit surface. What
//! depends on connectivity and tags only comes as [`Stencils`], so that moved control points cost
//! one sparse product.

mod catmull_clark;
mod eigen;
mod limit;
mod mesh;
mod ring;
mod sharpness;
mod stencils;
mod topology;

#[cfg(test)]
mod tests;

pub use catmull_clark::{Refined, catmull_clark, face_grids};
pub use limit::{limit_stencils, limit_tangent_stencils};
pub use mesh::{ControlMeshError, PolygonMesh};
pub use sharpness::{
    BoundaryCorners, CreaseRule, CreaseTag, INFINITELY_SHARP, Rules, Sharpness, SharpnessError,
};
pub use stencils::Stencils;
pub use topology::PolygonTopology;
