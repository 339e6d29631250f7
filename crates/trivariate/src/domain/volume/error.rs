//! Why a solid has no map to the cube.

use msplines_common::linalg::{FactorError, OrderingError};
use msplines_common::mesh::tet::NotSphere;

use crate::domain::boundary::BoundaryError;
use crate::domain::dirichlet::DirichletError;

/// Why a solid was not mapped to the cube.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VolumeError {
    /// The boundary is not one sphere.
    #[error(transparent)]
    NotSphere(#[from] NotSphere),
    /// Cells of the solid are inverted or flat.
    #[error(
        "{count} tetrahedra are inverted or flat, the first is {first}; mesh the solid again, or put corners in order with --repair"
    )]
    NotPositive {
        /// Number of cells.
        count: usize,
        /// The first.
        first: u32,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not finite; repair the solid first")]
    NotFinite {
        /// The vertex.
        vertex: u32,
    },
    /// A corner is not on the boundary.
    #[error("corner {corner} is vertex {vertex}, which is not on the boundary; choose one that is")]
    CornerInside {
        /// The corner of the cube.
        corner: usize,
        /// The vertex given.
        vertex: u32,
    },
    /// The boundary has no map.
    #[error(transparent)]
    Boundary(#[from] BoundaryError),
    /// The system of equations of the harmonic map has no solution.
    #[error(
        "the harmonic map of the solid failed: {0}; with weights that are not `linear` this may be their fault"
    )]
    Factor(FactorError),
    /// The system of equations could not be ordered.
    #[error("the harmonic map of the solid failed: {0}")]
    Ordering(OrderingError),
    /// An option that means nothing.
    #[error("`{name}` is {value}; give a number {range}")]
    Number {
        /// The option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        range: &'static str,
    },
    /// The observer asked to stop before there was a map.
    #[error("stopped before there was a map of the solid; allow more time")]
    Stopped,
}

impl From<DirichletError> for VolumeError {
    fn from(error: DirichletError) -> Self {
        match error {
            DirichletError::Ordering(error) => Self::Ordering(error),
            DirichletError::Factor(error) => Self::Factor(error),
        }
    }
}
