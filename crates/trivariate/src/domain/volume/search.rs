//! Corners and paths tried, the best first.

use msplines_common::mesh::tet::TetMesh;
use msplines_common::progress::unobserved;
use rayon::prelude::*;

use super::error::VolumeError;
use super::laplacian::solid_laplacian;
use super::measure::{Quality, measure};
use super::options::{Search, VolumeOptions};
use crate::domain::boundary::{self, BoundaryError, BoundaryMap, Frame, find_corners};
use crate::domain::dirichlet::Dirichlet;

/// What a share of one split edge or flipped cell adds to the score: a layout that needs many is
/// worse than any distortion.
const SHARE_WEIGHT: f64 = 20.0;

/// A way to lay corners and paths, mapped harmonically to be judged.
#[derive(Clone, Debug)]
pub struct Trial {
    /// How the corners were found.
    pub frame: Frame,
    /// How much longer concave ground counted for paths.
    pub avoid_concave: f64,
    /// The map of the boundary, whose surface may have more vertices than the solid's.
    pub boundary: BoundaryMap,
    /// The harmonic map: the parameter of each vertex of the solid.
    pub parameters: Vec<[f64; 3]>,
    /// Its folds and distortion.
    pub quality: Quality,
}

impl Trial {
    /// Returns the score that decides where no other is given; less is better.
    ///
    /// It adds the logarithm of the energy of the boundary against an isometry, the mean distortion
    /// of volumes, and a penalty for split edges and flipped cells.
    #[must_use]
    pub fn default_score(&self) -> f64 {
        let report = &self.boundary.report;
        let energy = report.energy.map_or(0.0, |energy| (energy / 4.0).ln());
        let split = report.corridor_splits as f64 / self.boundary.surface.vertex_count() as f64;
        let folded = report.folded as f64 / self.boundary.surface.face_count() as f64;
        let logarithm = self.quality.distortion;
        let flipped = self.quality.flipped as f64 / self.parameters.len() as f64;
        energy + logarithm + SHARE_WEIGHT * (split + folded + flipped)
    }
}

/// Returns all trials that have a map of the boundary, in the order of the search.
pub(super) fn trials(
    mesh: &TetMesh,
    search: &Search,
    options: &VolumeOptions,
) -> Result<Vec<Trial>, VolumeError> {
    let surface = mesh.boundary();
    let vertices = surface.vertex_count();
    if vertices < 8 {
        return Err(BoundaryError::TooSmall { vertices }.into());
    }
    let mut kinds = Vec::new();
    for &turn in &search.turns {
        for &evenness in &search.evenness {
            let frame = Frame { turn, evenness };
            let corners = find_corners(&surface, frame);
            kinds.extend(
                search
                    .avoid_concave
                    .iter()
                    .map(|&avoid| (frame, corners, avoid)),
            );
        }
    }
    let maps: Vec<Result<Trial, BoundaryError>> = kinds
        .into_par_iter()
        .map(|(frame, corners, avoid_concave)| {
            let mut options = options.boundary;
            options.routing.avoid_concave = avoid_concave;
            let boundary = boundary::map(&surface, &corners, &options, &mut unobserved())?;
            let mut parameters = vec![[0.5; 3]; mesh.vertex_count()];
            let outside = mesh.topology().boundary_vertices();
            for (&vertex, &parameter) in outside.iter().zip(&boundary.parameters) {
                parameters[vertex as usize] = parameter;
            }
            let quality = Quality::default();
            Ok(Trial {
                frame,
                avoid_concave,
                boundary,
                parameters,
                quality,
            })
        })
        .collect();
    let mut refused = None;
    let mut trials = Vec::new();
    for map in maps {
        match map {
            Ok(trial) => trials.push(trial),
            Err(error) => refused = refused.or(Some(error)),
        }
    }
    if let (true, Some(error)) = (trials.is_empty(), refused) {
        return Err(error.into());
    }
    judge(mesh, &mut trials, options)?;
    Ok(trials)
}

/// Maps the inside for all trials with one factorisation, and measures them.
fn judge(mesh: &TetMesh, trials: &mut [Trial], options: &VolumeOptions) -> Result<(), VolumeError> {
    let laplacian = solid_laplacian(mesh, options.weights);
    let given = super::on_boundary(mesh);
    let mut maps: Vec<&mut [[f64; 3]]> = trials
        .iter_mut()
        .map(|trial| trial.parameters.as_mut_slice())
        .collect();
    Dirichlet::factor(&laplacian, &given)?.solve(&mut maps);
    trials
        .par_iter_mut()
        .for_each(|trial| trial.quality = measure(mesh, &trial.parameters));
    Ok(())
}
