//! Meshes: topology, positions, facts, and what turns one mesh into another.
//!
//! A file is read into a [`PolygonSoup`], which may hold anything. [`preflight`] lists what is
//! wrong with it; only a clean soup becomes a [`TriangleMesh`]. A mesh never changes after it is
//! built: subdivision, decimation and repair return new ones. Topology is shared, so that new
//! positions over the same connectivity cost no topology.

mod accept;
mod connectivity;
mod cover;
mod crossings;
mod decimate;
mod defect;
pub(crate) mod disjoint_sets;
mod facts;
mod flat_corners;
mod flips;
mod half_edges;
mod lattice;
mod orientation;
mod polygons;
mod preflight;
mod repair;
mod repairs;
mod sanity;
mod soup;
mod split;
mod subdivision;
mod topology;
mod triangle;

#[cfg(test)]
mod repair_tests;

pub mod curves;
pub mod polygon;
pub mod shapes;
pub mod tet;
pub mod zoo;

pub use accept::{Accepted, Policy, PreflightError, accept};
pub use cover::double_cover;
pub use crossings::self_crossings;
pub use decimate::{DecimateError, Decimated, decimate};
pub use defect::{Defect, Remedy};
pub use facts::{Facts, Range};
pub use flips::{FlipComplex, carry_flip, sides_around};
pub use lattice::Lattice;
pub use preflight::{Preflight, preflight};
pub use repairs::{Affected, Repair};
pub use soup::{PolygonSoup, VertexAttribute, vertex_normals};
pub use split::{SplitError, SplitMesh, split_at};
pub use subdivision::{
    SubdivisionMap, edge_pieces, subdivide_butterfly, subdivide_loop, subdivide_midpoint,
};
pub use topology::{NONE, Topology, TopologyError};
pub use triangle::{SurfacePoint, TriangleMesh};
