//! Discrete differential operators of a triangle mesh: where geometry meets matrices.

mod laplacian;

pub use laplacian::{Operators, assemble, mesh_operators};
