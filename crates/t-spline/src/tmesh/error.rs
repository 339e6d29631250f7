//! What is wrong with base grids.

/// Grids that fit no complex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TMeshError {
    /// Not one grid per cylinder.
    #[error("{grids} base grids for {cylinders} cylinders; give one for each")]
    Grids {
        /// Number of grids.
        grids: usize,
        /// Number of cylinders.
        cylinders: usize,
    },
    /// No cells, or cells of a few units.
    #[error(
        "the base grid of cylinder {cylinder} has no cells, or cells of a few units; ask for between one cell and a few thousand per direction, and collapse cylinders and connections that are thinner than that"
    )]
    Grid {
        /// The cylinder.
        cylinder: u32,
    },
}
