//! What is wrong with zeros and poles.

use crate::complex::Border;

/// Borders around which no cap fits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CapsError {
    /// A zero on a boundary, or one whose half disks make several disks.
    #[error(
        "the cylinders around zero {zero} do not make one disk; zeros must lie inside of the surface, each with an index of its own"
    )]
    Zero {
        /// The zero.
        zero: u32,
    },
    /// A border of which only a part is a pole, or that has zeros too.
    #[error(
        "the {border:?} of cylinder {cylinder} is a pole only in part; a pole takes a whole border without zeros"
    )]
    Pole {
        /// The cylinder.
        cylinder: u32,
        /// The border.
        border: Border,
    },
}
