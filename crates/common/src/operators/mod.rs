//! Discrete differential operators of a triangle mesh: where geometry meets matrices.

pub mod intrinsic;
mod laplacian;

pub use laplacian::{Operators, assemble, mesh_operators};
