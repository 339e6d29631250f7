//! Discrete differential operators of a triangle mesh: where geometry meets matrices.

pub mod intrinsic;
mod laplacian;
mod poisson;

pub use laplacian::{Operators, assemble, mesh_operators};
pub use poisson::{Poisson, PoissonError};
