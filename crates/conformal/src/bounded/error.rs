//! Why a bounded surface has no conformal form.

use msplines_common::linalg::{FactorError, OrderingError};
use msplines_common::mesh::TriangleMesh;
use msplines_common::operators::intrinsic::IntrinsicError;
use msplines_common::progress::Stopped;

/// Why a bounded surface has no conformal form.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BoundedError {
    /// The surface falls into parts.
    #[error("the surface has {components} components; take each of them by itself")]
    Components {
        /// Number of components.
        components: u32,
    },
    /// There are fewer than two boundary loops.
    #[error(
        "the surface has {loops} boundary loops, and a harmonic function between loops needs two; \
         remove the stars of vertices to make some"
    )]
    Loops {
        /// Number of boundary loops.
        loops: usize,
    },
    /// The surface has handles.
    #[error(
        "the surface has {loops} boundary loops and genus {genus}, and only genus 0 is handled; \
         fill the loops and use the forms of closed surfaces"
    )]
    Genus {
        /// Number of handles.
        genus: i64,
        /// Number of boundary loops.
        loops: usize,
    },
    /// Another number of levels than of boundary loops.
    #[error("{levels} levels are given for {loops} boundary loops; give one for each")]
    LevelCount {
        /// Levels given.
        levels: usize,
        /// Boundary loops.
        loops: usize,
    },
    /// A level is NaN or infinite.
    #[error("the level of boundary loop {boundary} is {level}; give finite levels")]
    LevelNotFinite {
        /// The boundary loop.
        boundary: usize,
        /// Its level.
        level: f64,
    },
    /// All levels are equal.
    #[error(
        "all boundary loops have level {level}; give at least one of them another, such as 0 and 1"
    )]
    EqualLevels {
        /// The level.
        level: f64,
    },
    /// The observer asked to stop before there was a map.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// No intrinsic triangulation.
    #[error(transparent)]
    Intrinsic(#[from] IntrinsicError),
    /// The Laplacian could not be ordered.
    #[error("the Laplacian cannot be ordered: {0}")]
    Ordering(#[from] OrderingError),
    /// The Laplacian could not be factored.
    #[error("the Laplacian cannot be factored: {0}")]
    Factor(#[from] FactorError),
}

/// Checks that a mesh is one surface of genus 0 with two or more boundary loops, and the levels.
pub(super) fn check(mesh: &TriangleMesh, levels: &[f64]) -> Result<(), BoundedError> {
    let topology = mesh.topology();
    let (_, components) = topology.components();
    if components > 1 {
        return Err(BoundedError::Components { components });
    }
    let loops = topology.boundary_loops().len();
    if loops < 2 {
        return Err(BoundedError::Loops { loops });
    }
    let genus = (2 - topology.euler_characteristic() - loops as i64) / 2;
    if genus > 0 {
        return Err(BoundedError::Genus { genus, loops });
    }
    if levels.len() != loops {
        let levels = levels.len();
        return Err(BoundedError::LevelCount { levels, loops });
    }
    if let Some(boundary) = levels.iter().position(|level| !level.is_finite()) {
        let level = levels[boundary];
        return Err(BoundedError::LevelNotFinite { boundary, level });
    }
    if levels.iter().all(|&level| level == levels[0]) {
        return Err(BoundedError::EqualLevels { level: levels[0] });
    }
    Ok(())
}
