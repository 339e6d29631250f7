//! Tetrahedral meshes of solids.
//!
//! A file is read into a [`TetSoup`], which may hold anything. [`preflight`] lists what is wrong with
//! it; [`accept`] turns a clean soup into a [`TetMesh`]. Connectivity ([`TetTopology`]) is shared and
//! apart from positions, so that a map of the solid costs no topology. Whether a cell is inverted or
//! flat is decided exactly ([`orientation`]).

mod accept;
mod cell;
mod connectivity;
mod defect;
mod facts;
mod mesh;
mod orientation;
mod preflight;
mod soup;
mod topology;

#[cfg(test)]
mod tests;

pub use accept::{TetAccepted, TetPreflightError, TetRepair, accept};
pub use cell::{CELL_EDGES, CELL_FACES, dihedral_angles, signed_volume};
pub use defect::TetDefect;
pub use facts::TetFacts;
pub use mesh::{NotSphere, TetMesh};
pub use orientation::{Orientation, orientation};
pub use preflight::{TetPreflight, preflight};
pub use soup::TetSoup;
pub use topology::{TetTopology, TetTopologyError};
