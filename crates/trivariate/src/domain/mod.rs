//! From a solid to the unit cube: its mesh, its map, and points with their parameters.
//!
//! A closed surface is filled with tetrahedra ([`mesher`]), which are mapped to the cube
//! ([`boundary`], [`volume`]). The boundary of those tetrahedra is only near to the surface: points of
//! the surface take the parameter of the boundary's point closest to them, so that a spline is fitted to
//! the surface itself.

pub mod boundary;
pub mod cube;
mod descent;
pub(crate) mod dirichlet;
pub mod mesher;
mod sampling;
mod split;
#[cfg(test)]
mod tests;
pub mod volume;

use msplines_common::Point3;
use msplines_common::mesh::TriangleMesh;
use msplines_common::mesh::tet::TetMesh;
use msplines_common::metrics::SurfaceTree;
use msplines_common::progress::{Observer, unobserved};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use self::mesher::{Filled, MesherError, MesherReport};
use self::sampling::{Draw, Sample, Sampler};
use self::volume::{Corners, CubeMap, Trial, VolumeError};
use crate::error::FitError;
use crate::fit::least_squares;
use crate::measure::degenerate;
use crate::options::MOST_SAMPLES;
pub use crate::options::{Domain as DomainOptions, Sampling};
use crate::samples::VolumeSamples;
use crate::spline::TrivariateSpline;

/// Points by which a spline is measured that it was not fitted to, on the surface and inside.
const HELD_OUT: usize = 100_000;

/// A solid as it is given.
#[derive(Clone, Copy, Debug)]
pub enum Solid<'a> {
    /// By its closed surface.
    Surface(&'a TriangleMesh),
    /// By tetrahedra, whose boundary is its surface.
    Cells(&'a TetMesh),
}

/// Why a solid has no map to the cube.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DomainError {
    /// The surface could not be filled.
    #[error(transparent)]
    Mesher(#[from] MesherError),
    /// The tetrahedra could not be mapped.
    #[error(transparent)]
    Volume(#[from] VolumeError),
    /// A corner that does not exist.
    #[error("corner {corner} is vertex {vertex}, but the surface has {vertices}")]
    NoVertex {
        /// The corner of the cube.
        corner: usize,
        /// The vertex given.
        vertex: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// Two corners whose nearest points of the lattice are one.
    #[error(
        "corners {first} and {second}, vertices {vertices:?}, are nearer to each other than the lattice resolves; choose them farther apart, or a finer lattice"
    )]
    CloseCorners {
        /// A corner of the cube.
        first: usize,
        /// The other.
        second: usize,
        /// The vertices given.
        vertices: [u32; 2],
    },
}

/// A solid mapped to the cube, and the surface that a spline of it shall have.
#[derive(Clone, Debug)]
pub struct Domain {
    map: CubeMap,
    filled: Option<MesherReport>,
    surface: TriangleMesh,
    to_surface: SurfaceTree,
    diagonal: f64,
}

/// Distances of a spline from points that it was not fitted to, at their parameters, as fractions of the
/// diagonal of the solid's box. A point of the spline may be nearer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Deviation {
    /// Root of the mean square at points that are even on the surface by area.
    pub surface_rms: f64,
    /// The largest of them.
    pub surface_max: f64,
    /// Root of the mean square inside, half by volume of the solid and half by that of the cube.
    pub interior_rms: f64,
    /// The largest of them.
    pub interior_max: f64,
}

impl Domain {
    /// Returns a solid with its map to the cube.
    ///
    /// Ways to lay corners and paths are judged by the error of a coarse spline and its degenerate
    /// elements. Corners that are given name vertices of the surface or of the tetrahedra; a filled surface
    /// takes the nearest vertices of its boundary. Cost: that of [`mesher::fill`], of
    /// [`volume::map`], and of a least-squares fit of 8 spans for each way.
    ///
    /// # Reference
    /// [Kim2014] §4. Deviation: a mesher of its own; several corners and paths are tried.
    ///
    /// # Errors
    /// A surface that cannot be filled, a solid that cannot be mapped, corners that do not exist or are too
    /// near to each other.
    pub fn build(
        solid: Solid<'_>,
        options: &DomainOptions,
        observer: &mut Observer<'_>,
    ) -> Result<Self, DomainError> {
        let mut volume = options.volume.clone();
        let (mesh, filled, surface) = match solid {
            Solid::Surface(surface) => {
                let Filled { mesh, report } = mesher::fill(surface, &options.mesher, observer)?;
                if let Corners::Given(corners) = &mut volume.corners {
                    *corners = nearest_vertices(surface, &mesh, corners)?;
                }
                (mesh, Some(report), surface.clone())
            }
            Solid::Cells(mesh) => (mesh.clone(), None, mesh.boundary()),
        };
        let to_surface = SurfaceTree::build(&surface);
        let diagonal = surface.diagonal();
        let mut score = |trial: &Trial| {
            let sampler = Sampler::new(&mesh, &trial.parameters, (&surface, &to_surface));
            score(trial, &sampler, diagonal)
        };
        let map = volume::map_scored(&mesh, &volume, &mut score, observer)?;
        Ok(Self {
            map,
            filled,
            surface,
            to_surface,
            diagonal,
        })
    }

    /// The map to the cube.
    #[must_use]
    pub fn map(&self) -> &CubeMap {
        &self.map
    }

    /// How the surface was filled, if it was.
    #[must_use]
    pub fn filled(&self) -> Option<&MesherReport> {
        self.filled.as_ref()
    }

    /// The surface that a spline shall have: the one given, or the boundary of the tetrahedra given.
    #[must_use]
    pub fn surface(&self) -> &TriangleMesh {
        &self.surface
    }

    /// Diagonal of the box of the surface.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// Returns samples for a fit.
    ///
    /// # Errors
    /// A weight that is negative or not finite; no samples, or too many.
    pub fn samples(&self, sampling: &Sampling) -> Result<VolumeSamples, FitError> {
        match *sampling {
            Sampling::Vertices => {
                let clamped = |p: &[f64; 3]| p.map(|t| t.clamp(0.0, 1.0));
                let parameters = self.map.parameters.iter().map(clamped).collect();
                VolumeSamples::build(parameters, self.map.mesh.positions().to_vec())
            }
            Sampling::Even {
                interior,
                surface,
                surface_weight,
            } => {
                let samples = interior.saturating_add(surface);
                if samples > MOST_SAMPLES {
                    return Err(FitError::TooManySamples { samples });
                }
                let sampler = self.sampler();
                let inside = sampler.interior(interior, Draw::Fitted);
                let outside = sampler.surface(surface, Draw::Fitted);
                weighted(inside, outside, surface_weight)
            }
        }
    }

    /// Returns the parameters of points of the surface, each that of the closest point of the boundary.
    #[must_use]
    pub fn surface_parameters(&self, points: &[Point3<f64>]) -> Vec<[f64; 3]> {
        let sampler = self.sampler();
        points
            .par_iter()
            .map(|point| sampler.parameter(point).unwrap_or([0.0; 3]))
            .collect()
    }

    /// Returns how far a spline is from points that no fit has seen.
    #[must_use]
    pub fn deviation(&self, spline: &TrivariateSpline) -> Deviation {
        let sampler = self.sampler();
        let surface = sampler.by_area(HELD_OUT, Draw::HeldOut);
        let interior = sampler.interior(HELD_OUT, Draw::HeldOut);
        let [surface, interior] = [surface, interior].map(|samples| distances(spline, &samples));
        Deviation {
            surface_rms: surface.0 / self.diagonal,
            surface_max: surface.1 / self.diagonal,
            interior_rms: interior.0 / self.diagonal,
            interior_max: interior.1 / self.diagonal,
        }
    }

    fn sampler(&self) -> Sampler<'_> {
        let surface = (&self.surface, &self.to_surface);
        Sampler::new(&self.map.mesh, &self.map.parameters, surface)
    }
}

/// Samples of the inside of total weight 1, and of the surface of total weight `surface_weight`.
fn weighted(
    inside: Vec<Sample>,
    outside: Vec<Sample>,
    surface_weight: f64,
) -> Result<VolumeSamples, FitError> {
    let each = [
        1.0 / inside.len().max(1) as f64,
        surface_weight / outside.len().max(1) as f64,
    ];
    let counts = [inside.len(), outside.len()];
    let weights = [0, 1].map(|set| vec![each[set]; counts[set]]).concat();
    let (parameters, points) = inside.into_iter().chain(outside).unzip();
    VolumeSamples::weighted(parameters, points, weights)
}

/// Root mean square and maximum of the distances of samples.
fn distances(spline: &TrivariateSpline, samples: &[Sample]) -> (f64, f64) {
    let squares: Vec<f64> = samples
        .par_iter()
        .map(|(parameter, point)| (spline.position(*parameter) - point).norm_squared())
        .collect();
    let mean = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
    let max = squares.iter().copied().fold(0.0, f64::max);
    (mean.sqrt(), max.sqrt())
}

/// Spans of the spline that judges a way to lay corners and paths.
const TRIAL_SPANS: usize = 8;
/// Samples inside and on the surface for it.
const TRIAL_SAMPLES: [usize; 2] = [24_000, 12_000];

/// Root mean square error of a coarse spline on the surface, raised by its degenerate elements and
/// by splits and folds of the map.
fn score(trial: &Trial, sampler: &Sampler<'_>, diagonal: f64) -> f64 {
    let inside = sampler.interior(TRIAL_SAMPLES[0], Draw::Fitted);
    let outside = sampler.surface(TRIAL_SAMPLES[1], Draw::Fitted);
    let Ok(samples) = weighted(inside, outside.clone(), 1.0) else {
        return f64::INFINITY;
    };
    let options = least_squares::Options {
        finest: TRIAL_SPANS,
        ..least_squares::Options::default()
    };
    let Ok(fit) = least_squares::fit(&samples, &options, &mut unobserved()) else {
        return f64::INFINITY;
    };
    let (rms, _) = distances(&fit.spline, &outside);
    let elements = 24.0 * 20f64.powi(3);
    let share = degenerate(&fit.spline, 20) as f64 / elements;
    (rms / diagonal).ln() + 100.0 * share + trial.default_score()
}

/// The vertices of the boundary of `mesh` that are nearest to corners of the surface.
fn nearest_vertices(
    surface: &TriangleMesh,
    mesh: &TetMesh,
    corners: &[u32; 8],
) -> Result<[u32; 8], DomainError> {
    let mut found = [0; 8];
    for (corner, &vertex) in corners.iter().enumerate() {
        let Some(place) = surface.positions().get(vertex as usize) else {
            let vertices = surface.vertex_count();
            return Err(DomainError::NoVertex {
                corner,
                vertex,
                vertices,
            });
        };
        let distance = |&v: &u32| (mesh.positions()[v as usize] - place).norm_squared();
        let outside = mesh.topology().boundary_vertices().iter().copied();
        let nearest = outside.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        found[corner] = nearest.unwrap_or(0);
        if let Some(first) = (0..corner).find(|&first| found[first] == found[corner]) {
            return Err(DomainError::CloseCorners {
                first,
                second: corner,
                vertices: [corners[first], vertex],
            });
        }
    }
    Ok(found)
}
