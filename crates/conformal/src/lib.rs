//! Conformal structure of triangle meshes: holomorphic 1-forms, affine atlases, spherical maps.

mod extension;
mod polish;
mod untangle;

pub mod bounded;
pub mod disk;
pub mod measure;
pub mod sphere;
