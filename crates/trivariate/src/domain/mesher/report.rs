//! How a mesh of a solid came about.

use serde::{Deserialize, Serialize};

use super::error::Shortfall;

/// All lattices tried by [`fill`](super::fill).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MesherReport {
    /// In the order tried, finer and finer; the last one gave the mesh.
    pub attempts: Vec<Attempt>,
}

/// One lattice and what came of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Attempt {
    /// Distance of lattice points.
    pub spacing: f64,
    /// Number of lattice points.
    pub lattice_points: usize,
    /// Number of tetrahedra.
    pub cells: usize,
    /// Number of vertices.
    pub vertices: usize,
    /// Number of faces of the boundary.
    pub boundary_faces: usize,
    /// Euler characteristic of the boundary.
    pub euler_characteristic: i64,
    /// Number of parts of the solid, before any were dropped.
    pub parts: u32,
    /// Rounds in which contacts of the boundary with itself were undone.
    pub repair_rounds: u32,
    /// Lattice points that kept their place for that.
    pub unmoved_points: usize,
    /// Smallest dihedral angle, in radians.
    pub smallest_angle: f64,
    /// Largest dihedral angle, in radians.
    pub largest_angle: f64,
    /// Largest distance of the surface from the boundary, as a fraction of the surface's diagonal.
    pub farthest: f64,
    /// Root of the mean square of those distances, at vertices and points of long edges and large
    /// faces, as a fraction of the surface's diagonal.
    pub rms: f64,
    /// What was wrong, if the mesh was not taken.
    pub shortfall: Option<Shortfall>,
}
