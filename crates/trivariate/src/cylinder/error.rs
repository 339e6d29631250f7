//! Why a solid has no cylindrical parameters.

use msplines_common::linalg::{FactorError, OrderingError};

use super::options::MOST_SAMPLES;
use crate::domain::boundary::BoundaryError;
use crate::domain::dirichlet::DirichletError;
use crate::error::FitError;

/// Why a solid was not given cylindrical parameters, or has no spline over them.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CylinderError {
    /// The surface is not closed, connected, finite and of genus 0.
    #[error(transparent)]
    Surface(#[from] BoundaryError),
    /// A pole is no vertex of the surface.
    #[error(
        "pole {pole} is vertex {vertex}, which is none of the {vertices} vertices of the surface; choose another"
    )]
    NoVertex {
        /// The pole, 0 or 1.
        pole: usize,
        /// The vertex given.
        vertex: u32,
        /// Number of vertices of the surface.
        vertices: usize,
    },
    /// Both poles lie on one spot.
    #[error(
        "the poles lie on one spot, at vertices {} and {}; choose two points apart from each other",
        .vertices[0], .vertices[1]
    )]
    SamePole {
        /// Their vertices.
        vertices: [u32; 2],
    },
    /// A level set of the harmonic latitude is not one loop, which only rounding can cause.
    #[error(
        "the level {level} of the latitude, around vertex {vertex}, crosses {crossed} edges, of which one loop crosses {traced}: the latitude is constant up to rounding there; place a pole at the end of that part"
    )]
    NotOneLoop {
        /// Value of the harmonic latitude.
        level: f64,
        /// A vertex of the surface at that level.
        vertex: u32,
        /// Edges that cross the level.
        crossed: usize,
        /// Edges that one loop crosses.
        traced: usize,
    },
    /// The axis has no length.
    #[error(
        "the loops of the latitude have one common centre at {centre:?}; choose poles on opposite sides of the surface"
    )]
    NoAxis {
        /// Their centre.
        centre: [f64; 3],
    },
    /// An option that means nothing.
    #[error("`{name}` is {value}; give a number from {least} to {MOST_SAMPLES}")]
    Count {
        /// The option.
        name: &'static str,
        /// Its value.
        value: usize,
        /// The least that makes sense.
        least: usize,
    },
    /// More samples than are held in memory.
    #[error(
        "{samples} samples; ask for fewer `loops`, `meridians` or `radii`, at most {MOST_SAMPLES} samples in all"
    )]
    TooManySamples {
        /// What was asked for.
        samples: usize,
    },
    /// The harmonic latitude could not be ordered.
    #[error("the harmonic latitude failed: {0}")]
    Ordering(OrderingError),
    /// The harmonic latitude has no solution.
    #[error("the harmonic latitude failed: {0}")]
    Factor(FactorError),
    /// The fit was refused.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The observer asked to stop before there was a result.
    #[error("stopped before there was a cylindrical map")]
    Stopped,
}

impl From<DirichletError> for CylinderError {
    fn from(error: DirichletError) -> Self {
        match error {
            DirichletError::Ordering(error) => Self::Ordering(error),
            DirichletError::Factor(error) => Self::Factor(error),
        }
    }
}
