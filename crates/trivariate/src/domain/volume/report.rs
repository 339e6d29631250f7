//! How a map of a solid came about.

use msplines_common::progress::Outcome;
use serde::{Deserialize, Serialize};

use super::measure::Quality;
use super::options::VolumeOptions;
use crate::domain::boundary::{BoundaryReport, Frame};

/// How a map of a solid came about.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VolumeReport {
    /// How the map of the boundary came about.
    pub boundary: BoundaryReport,
    /// Ways to lay corners and paths that were judged; 0 if corners were given.
    pub trials: usize,
    /// How the corners were found, if they were.
    pub frame: Option<Frame>,
    /// How much longer concave ground counted for paths.
    pub avoid_concave: f64,
    /// Edges split because their ends lie on one face of the cube.
    pub split_edges: usize,
    /// Faces split because their sides do.
    pub split_faces: usize,
    /// The harmonic map.
    pub harmonic: Quality,
    /// The map without folds.
    pub unfolded: Quality,
    /// The map in the end.
    pub quality: Quality,
    /// Rounds of unfolding.
    pub rounds: u32,
    /// Evaluations of energies for unfolding, each of a part of the solid.
    pub unfolding_evaluations: u64,
    /// The same as evaluations of the whole solid.
    pub unfolding_equivalent: f64,
    /// Sweeps in which squeezed cells were given room, vertex by vertex.
    pub lifting_sweeps: u32,
    /// Evaluations for lower distortion.
    pub smoothing_evaluations: u32,
    /// Triangles of the boundary that are inverted or flat in their face of the cube.
    pub folded: usize,
    /// Whether the map is free of folds ([`Outcome::Converged`]), or unfolding ended before.
    pub outcome: Outcome,
}

impl VolumeReport {
    /// Returns the report of a map whose boundary alone is mapped.
    pub(super) fn of(boundary: &BoundaryReport, options: &VolumeOptions) -> Self {
        Self {
            boundary: boundary.clone(),
            trials: 0,
            frame: None,
            avoid_concave: options.boundary.routing.avoid_concave,
            split_edges: 0,
            split_faces: 0,
            harmonic: Quality::default(),
            unfolded: Quality::default(),
            quality: Quality::default(),
            rounds: 0,
            unfolding_evaluations: 0,
            unfolding_equivalent: 0.0,
            lifting_sweeps: 0,
            smoothing_evaluations: 0,
            folded: 0,
            outcome: Outcome::Stalled,
        }
    }
}
