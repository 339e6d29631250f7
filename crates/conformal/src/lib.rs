//! Conformal structure of triangle meshes: holomorphic 1-forms, affine atlases, spherical maps.
//!
//! [`Atlas::of_surface`] lays out any connected surface that it can: a closed one of genus >= 1 by a
//! holomorphic form ([`HolomorphicBasis`], [`FormChoice`]), a sphere by its conformal map to the round
//! one ([`sphere`]), a disk by flattening it ([`disk`]), a sphere with several holes by a harmonic
//! function and its conjugate ([`bounded`]). [`Atlas::with_poles`] lets forms leave through the tips
//! of limbs ([`poles`]); a [`CircleMap`] tells the imaginary part of forms with integer periods.

mod atlas;
mod basis;
mod choice;
mod circle;
mod classes;
mod closed;
mod descent;
mod develop;
mod error;
mod extension;
mod flat;
mod homology;
mod lattice;
mod polish;
mod potentials;
mod surface;
#[cfg(test)]
mod tests;
mod uniformity;
mod untangle;
mod zeros;

pub mod bounded;
pub mod disk;
pub mod measure;
pub mod poles;
pub mod sphere;

pub use atlas::Atlas;
pub use basis::HolomorphicBasis;
pub use choice::{FormChoice, HolomorphicForm};
pub use circle::CircleMap;
pub use classes::ClassObjective;
pub use closed::ClosedAtlas;
pub use error::ConformalError;
pub use homology::{Cocycle, Homology};
pub use lattice::Lattice;
pub use surface::{AtlasOptions, AtlasReport, Structure, SurfaceAtlas};
pub use uniformity::Uniformity;
pub use zeros::Zero;
