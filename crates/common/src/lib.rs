//! Meshes, sparse linear algebra and discrete operators shared by every method.
//!
//! Data flows one way: [`mesh`] knows topology and positions but no matrices, [`linalg`] knows
//! matrices but no geometry, and the two meet in [`operators`]. [`evaluate`] holds the traits that
//! every spline implements, [`metrics`] the measures that every spline is judged by.

pub mod bspline;
pub mod evaluate;
pub mod linalg;
pub mod mesh;
pub mod metrics;
pub mod operators;
pub mod progress;

pub use nalgebra::{Point3, Vector3};
