//! Maps of a closed surface of genus 0 to the surface of the cube.
//!
//! Eight vertices become the corners. Twelve disjoint paths between them become the edges and cut
//! the surface into six patches, each of which is mapped harmonically to its face.
//!
//! # Reference
//! [Kim2014] §4.1. Deviation: paths that cannot block each other, borders of patches fixed by
//! arc length, where no triangle can fold; the paper's map is [`Border::Free`].

mod corners;
mod distortion;
mod error;
mod free;
mod ground;
mod options;
mod patches;
mod planar;
mod route;
#[cfg(test)]
mod tests;
mod ways;

use std::ops::ControlFlow;

use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::{Observer, Progress};
use nalgebra::Point3;
use serde::{Deserialize, Serialize};

pub use corners::{Frame, find_corners};
pub use error::BoundaryError;
pub use options::{Border, BoundaryOptions, PatchWeights, RoutingOptions};

pub(crate) use corners::principal_axes;
pub(crate) use planar::is_positive;

use crate::domain::split::split_surface;
use distortion::Distortion;

/// A map of a closed surface to the surface of the cube.
#[derive(Clone, Debug)]
pub struct BoundaryMap {
    /// The surface; edges may have been split for the paths. Its first vertices are those given.
    pub surface: TriangleMesh,
    /// The edges split, in this order; each has got the next vertex number for its midpoint.
    pub splits: Vec<[u32; 2]>,
    /// The vertex of each corner of the cube.
    pub corners: [u32; 8],
    /// The vertices along each of [`EDGES`](crate::domain::cube::EDGES).
    pub paths: [Vec<u32>; 12],
    /// The faces of the cube that each vertex must stay on.
    pub masks: Vec<u8>,
    /// The face of the cube of each triangle.
    pub labels: Vec<u8>,
    /// The parameter of each vertex.
    pub parameters: Vec<[f64; 3]>,
    /// How it came about.
    pub report: BoundaryReport,
}

/// How a map of a surface came about.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BoundaryReport {
    /// Edges split because paths had no way between others.
    pub corridor_splits: usize,
    /// Edges split because they joined two vertices of one path.
    pub chord_splits: usize,
    /// Faces of the cube whose patch got positive weights, because cotangents folded it: a mask.
    pub convex_patches: u8,
    /// Triangles that are inverted or flat, decided exactly: 0 unless borders are free.
    pub folded: usize,
    /// Mean of `|J|² + |J⁻¹|²` with the areas of surface and cube made equal: 4 for an isometry;
    /// `None` if triangles fold or straddle edges of the cube.
    pub energy: Option<f64>,
    /// Evaluations of that energy to lower it.
    pub evaluations: u32,
}

/// Returns a map of a surface to that of the cube, with the vertices of the eight corners given.
///
/// Bit `d` of a corner's number is its coordinate along axis `d`; corners that are numbered as on a
/// mirrored cube give twisted patches. Cost: O(n log n) for the paths and a sparse factorisation.
///
/// # Errors
/// The surface is not closed, connected and of genus 0; corners coincide; no disjoint paths are
/// found; a patch is so squeezed that rounding folds it; an option means nothing.
pub fn map(
    surface: &TriangleMesh,
    corners: &[u32; 8],
    options: &BoundaryOptions,
    observer: &mut Observer<'_>,
) -> Result<BoundaryMap, BoundaryError> {
    options.check()?;
    check_surface(surface)?;
    check_corners(surface, corners)?;
    if let ControlFlow::Break(()) = observer(&Progress::new("domain", 0, 2)) {
        return Err(BoundaryError::Stopped);
    }
    let ground = ground::concavity(surface, options.routing.avoid_concave);
    let routed = route::route(surface, corners, ground, &options.routing)?;
    if let ControlFlow::Break(()) = observer(&Progress::new("domain", 1, 2)) {
        return Err(BoundaryError::Stopped);
    }
    place(routed, corners, options)
}

impl BoundaryMap {
    /// Returns the map of the same surface with other positions and the same paths.
    ///
    /// # Errors
    /// A patch is so squeezed that rounding folds it.
    pub(crate) fn moved(
        &self,
        positions: Vec<Point3<f64>>,
        options: &BoundaryOptions,
    ) -> Result<Self, BoundaryError> {
        let routed = route::Routed {
            surface: self.surface.with_positions(positions),
            splits: self.splits.clone(),
            paths: self.paths.clone(),
        };
        let map = place(routed, &self.corners, options)?;
        let report = BoundaryReport {
            corridor_splits: self.report.corridor_splits,
            chord_splits: self.report.chord_splits,
            ..map.report
        };
        Ok(Self { report, ..map })
    }
}

fn place(
    routed: route::Routed,
    corners: &[u32; 8],
    options: &BoundaryOptions,
) -> Result<BoundaryMap, BoundaryError> {
    let route::Routed {
        mut surface,
        mut splits,
        paths,
    } = routed;
    let mut report = BoundaryReport {
        corridor_splits: splits.len(),
        ..BoundaryReport::default()
    };
    let chords = patches::chords(surface.topology(), &paths);
    if !chords.is_empty() {
        surface = split_surface(&surface, &chords);
        report.chord_splits = chords.len();
        splits.extend(chords);
    }
    let labels = patches::label(surface.topology(), &paths)?;
    let mut masks = patches::masks(surface.topology(), &labels, corners, &paths);
    let mut parameters = vec![[0.5; 3]; surface.vertex_count()];
    if options.border == Border::Free {
        let free = free::solve(&surface, &labels, &masks, corners)?;
        parameters = free.parameters;
        report.folded = free.folded;
        for (mask, chart) in masks.iter_mut().zip(free.charts) {
            *mask = if mask.count_ones() == 3 {
                *mask
            } else {
                1 << chart
            };
        }
    } else {
        planar::place_paths(&surface, &paths, &mut parameters);
        report.convex_patches =
            planar::place_patches(&surface, &labels, &masks, options.weights, &mut parameters)?;
        let distortion = Distortion::new(&surface, &labels);
        if let Border::Sliding { evaluations } = options.border {
            report.evaluations = distortion.relax(&masks, &mut parameters, evaluations);
        }
        report.energy = Some(distortion.energy(&parameters)).filter(|energy| energy.is_finite());
        report.folded = planar::folded(&surface, &labels, &parameters).len();
    }
    let corners = *corners;
    Ok(BoundaryMap {
        surface,
        splits,
        corners,
        paths,
        masks,
        labels,
        parameters,
        report,
    })
}

/// Refuses a surface that is not closed, connected, finite and of genus 0.
pub(crate) fn check_surface(surface: &TriangleMesh) -> Result<(), BoundaryError> {
    let finite = |p: &Point3<f64>| p.iter().all(|x| x.is_finite());
    if let Some(vertex) = surface.positions().iter().position(|p| !finite(p)) {
        return Err(BoundaryError::NotFinite {
            vertex: vertex as u32,
        });
    }
    let vertices = surface.vertex_count();
    if vertices < 8 {
        return Err(BoundaryError::TooSmall { vertices });
    }
    let topology = surface.topology();
    let loops = topology.boundary_loops();
    if let Some(first) = loops.first() {
        let vertex = topology.origin(first[0]);
        return Err(BoundaryError::Open {
            loops: loops.len(),
            vertex,
        });
    }
    let (labels, pieces) = topology.components();
    if pieces != 1 {
        let vertex = labels.iter().position(|&label| label == 1).unwrap_or(0) as u32;
        return Err(BoundaryError::SeveralSurfaces { pieces, vertex });
    }
    match (2 - topology.euler_characteristic()) / 2 {
        0 => Ok(()),
        genus => Err(BoundaryError::Genus {
            genus: genus as u32,
        }),
    }
}

fn check_corners(surface: &TriangleMesh, corners: &[u32; 8]) -> Result<(), BoundaryError> {
    let vertices = surface.vertex_count();
    for (corner, &vertex) in corners.iter().enumerate() {
        if vertex as usize >= vertices {
            return Err(BoundaryError::NoVertex {
                corner,
                vertex,
                vertices,
            });
        }
        let position = |v: u32| surface.positions()[v as usize];
        if let Some(other) = (0..corner).find(|&other| position(corners[other]) == position(vertex))
        {
            let corners_here = [other, corner];
            let vertices = corners_here.map(|corner| corners[corner]);
            return Err(BoundaryError::SameSpot {
                corners: corners_here,
                vertices,
            });
        }
    }
    Ok(())
}
