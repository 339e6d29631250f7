//! What is wrong with a complex of cylinders.

use super::Border;

/// Tables that are no glued surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ComplexError {
    /// A cylinder without extent.
    #[error("cylinder {cylinder} has no circumference or no height")]
    Size {
        /// The cylinder.
        cylinder: u32,
    },
    /// Segments that leave a gap, overlap, or do not sum to the circumference.
    #[error(
        "segment {segment} of the {border:?} of cylinder {cylinder} does not start where the one before it ends"
    )]
    Tiling {
        /// The cylinder.
        cylinder: u32,
        /// The border.
        border: Border,
        /// The segment; their number if the last ends short of the circumference.
        segment: usize,
    },
    /// A segment whose counterpart is glued elsewhere, or has another zero at its start.
    #[error(
        "segment {segment} of the {border:?} of cylinder {cylinder} is not glued back by its counterpart"
    )]
    Gluing {
        /// The cylinder.
        cylinder: u32,
        /// The border.
        border: Border,
        /// The segment.
        segment: usize,
    },
}
