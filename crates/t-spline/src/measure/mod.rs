//! What is measured of a T-spline itself: how smooth it is, and how independent its functions are.
//!
//! # Reference
//! [He2006] §3.3.

mod continuity;
mod gram;
mod lanczos;
mod lines;
#[cfg(test)]
mod tests;

pub use continuity::{Continuity, ContinuityOptions, Jumps, continuity};
pub use gram::{Gram, GramError, gram};
