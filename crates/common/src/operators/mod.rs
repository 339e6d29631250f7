//! Discrete differential operators of a triangle mesh: where geometry meets matrices.

pub mod intrinsic;
mod laplacian;
mod poisson;

#[cfg(test)]
mod tests;

pub use laplacian::{Operators, assemble, half_cotangents, mesh_operators, triangle_area};
pub use poisson::{Poisson, PoissonError};
