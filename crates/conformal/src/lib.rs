//! Conformal structure of triangle meshes: holomorphic 1-forms, affine atlases, spherical maps.

mod atlas;
mod basis;
mod choice;
mod descent;
mod error;
mod flat;
mod homology;
mod potentials;
mod uniformity;
mod zeros;

pub use atlas::{Atlas, ClosedAtlas};
pub use basis::HolomorphicBasis;
pub use choice::{FormChoice, HolomorphicForm};
pub use error::ConformalError;
pub use homology::{Cocycle, Homology};
pub use zeros::Zero;
