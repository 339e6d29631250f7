//! Why a surface cannot be given as cells.

use msplines_common::bspline::{CellsError, ShellError};

/// What stands in the way of cells.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CellError {
    /// A tolerance that is no length, or a degree that cannot be had.
    #[error(
        "a tolerance of {tolerance:e} and degree {degree}; give a positive length and a degree from 3 to 9"
    )]
    Options {
        /// The tolerance.
        tolerance: f64,
        /// The degree.
        degree: u8,
    },
    /// Halved as often as they may be, patches in a cap are still too far from the surface.
    #[error(
        "a patch in a cap beside cylinder {cylinder} is {deviation:e} from the surface however fine it is \
         cut, more than {tolerance:e}; allow more"
    )]
    Tolerance {
        /// The cylinder.
        cylinder: u32,
        /// How far it is, or twice that on its sides.
        deviation: f64,
        /// How far it may be.
        tolerance: f64,
    },
    /// Points that are no cells: coordinates of the spline that are not finite.
    #[error(transparent)]
    Cells(#[from] CellsError),
    /// Patches that are no shell.
    #[error(transparent)]
    Shell(#[from] ShellError),
}
