//! The conformal map of a closed surface of genus 0 onto the unit sphere.
//!
//! A plane harmonic map with one triangle at infinity is one-to-one but stretched far from its
//! middle; the two hemispheres then correct each other in the coordinates `z` and `1 / z`. Limbs are
//! compressed exponentially: their tips are all there, but may be 10⁻¹⁰ of the sphere wide.

mod error;
mod moebius;
mod plane;
#[cfg(test)]
mod tests;

pub use error::SphereError;

use msplines_common::linalg::Ordering;
use msplines_common::mesh::TriangleMesh;
use msplines_common::operators::intrinsic::{
    FlipRule, IntrinsicTriangulation, intrinsic_delaunay_by,
};
use msplines_common::progress::{Observer, Stages};
use nalgebra::Vector3;

use crate::extension::{bound_below, cotangent_weights, laplacian};
use crate::measure::{Distortion, area, measure_spherical, spherical_flips};
use crate::polish::polish_sphere;
use crate::untangle::untangle_sphere;

/// Edge weights are at least this, relative to the median: positive weights make the plane map
/// one-to-one, and a bound away from zero keeps that true after rounding.
const WEIGHT_FLOOR: f64 = 1e-7;

/// Stages that the observer sees: triangulation, ordering, harmonic map, two charts factored, each of
/// their sweeps, and the movement of single vertices.
const STAGES: u64 = 5 + plane::SWEEPS as u64;

/// A one-to-one map of the vertices of a closed surface onto the unit sphere.
#[derive(Clone, Debug)]
pub struct SphericalMap {
    /// The image of each vertex, a unit vector; the mean over the area of the surface is zero.
    pub points: Vec<Vector3<f64>>,
    /// The triangulation whose images are all oriented like the sphere, normals outwards.
    pub triangulation: IntrinsicTriangulation,
    /// Whether the two charts have corrected each other. On meshes of a few triangles that turns
    /// triangles over, and the map is the harmonic one with a triangle at infinity.
    pub corrected: bool,
    /// Vertices that were moved by themselves to turn triangles back.
    pub moved: usize,
    /// Triangles of the mesh itself that are turned over: slivers that the triangulation avoids.
    pub flips_of_mesh: usize,
    /// How far the map of the triangulation is from conformal; it has no flips.
    pub distortion: Distortion,
}

impl SphericalMap {
    /// Returns the stereographic coordinate of each vertex, with `pole` at infinity, the point
    /// opposite to it at zero and the circle between them at modulus 1.
    ///
    /// Faces keep their orientation except those around the pole, which are to be left out. A
    /// vertex at the pole has infinite coordinates.
    #[must_use]
    pub fn stereographic(&self, pole: Vector3<f64>) -> Vec<[f64; 2]> {
        moebius::stereographic(&self.points, pole.normalize())
    }
}

/// Returns the conformal map of a closed surface of genus 0 onto the unit sphere.
///
/// With [`FlipRule::Simplicial`] the triangulation has the faces of an ordinary mesh, and every
/// triangle of the result is oriented like the sphere. [`FlipRule::Any`] gives an error where the
/// triangulation has a face with two equal corners, whose image is an arc; that happens on necks
/// and thin limbs. Elsewhere the two are the same.
///
/// Angles converge like the mesh size. The Möbius freedom is used to centre the image; what remains
/// is a rotation, which depends on the triangle that was at infinity. Cost: one ordering and three
/// factorisations of the Laplacian. Equal input gives equal bits on any number of threads.
///
/// # Reference
/// [Tutte1963]; [Haker2000]. Deviation: the weights are those of the intrinsic Delaunay
/// triangulation, the map is corrected by alternating between two charts, and at last the corners of
/// stretched triangles move to where these are least stretched.
///
/// # Errors
/// A mesh that is not one closed surface of genus 0, and one on which triangles stay turned over;
/// the observer asks to stop.
pub fn spherical_map(
    mesh: &TriangleMesh,
    rule: FlipRule,
    observer: &mut Observer<'_>,
) -> Result<SphericalMap, SphereError> {
    error::check(mesh)?;
    let mut stages = Stages::new("domain", STAGES, observer);
    stages.enter()?;
    let triangulation = intrinsic_delaunay_by(mesh, rule)?;
    let mut weights = cotangent_weights(&triangulation);
    bound_below(&mut weights, WEIGHT_FLOOR);
    let laplacian = laplacian(mesh.vertex_count(), &triangulation, &weights);
    stages.enter()?;
    let ordering = Ordering::minimum_degree(&laplacian, |_| true)?;
    let areas = vertex_areas(mesh.vertex_count(), &triangulation);
    let chart = plane::Chart {
        laplacian: &laplacian,
        ordering: &ordering,
        triangulation: &triangulation,
        areas: &areas,
    };
    stages.enter()?;
    let z = chart.outside_a_triangle()?;
    let mut corrected = true;
    let mut points = chart.corrected(&z, &mut stages)?;
    stages.enter()?;
    let mut moved = settle(&mut points, &areas, &triangulation);
    if check_one_to_one(&triangulation.faces, &points).is_err() {
        corrected = false;
        points = chart.uncorrected(&z);
        moved = settle(&mut points, &areas, &triangulation);
        check_one_to_one(&triangulation.faces, &points)?;
    }
    let distortion = measure_spherical(&triangulation.faces, &triangulation.lengths, &points);
    Ok(SphericalMap {
        flips_of_mesh: spherical_flips(mesh.faces(), &points).len(),
        points,
        triangulation,
        corrected,
        moved,
        distortion,
    })
}

/// Centres a map, turns single triangles back and lowers the angle distortion; returns how many
/// vertices had to be moved to turn triangles back.
fn settle(
    points: &mut Vec<Vector3<f64>>,
    areas: &[f64],
    triangulation: &IntrinsicTriangulation,
) -> usize {
    moebius::centre(points, areas);
    let moved = untangle_sphere(triangulation, points);
    polish_sphere(triangulation, points);
    moebius::centre(points, areas);
    moved + untangle_sphere(triangulation, points)
}

/// Returns a third of the area of the triangles around each vertex.
fn vertex_areas(vertex_count: usize, triangulation: &IntrinsicTriangulation) -> Vec<f64> {
    let mut areas = vec![0.0; vertex_count];
    for (corners, &sides) in triangulation.faces.iter().zip(&triangulation.lengths) {
        let third = area(sides) / 3.0;
        corners.iter().for_each(|&v| areas[v as usize] += third);
    }
    areas
}

/// Checks that all triangles are oriented like the sphere and together cover it once.
fn check_one_to_one(faces: &[[u32; 3]], points: &[Vector3<f64>]) -> Result<(), SphereError> {
    let flips = spherical_flips(faces, points);
    if let Some(&first) = flips.first() {
        return Err(SphereError::Flipped {
            flips: flips.len(),
            corners: faces[first as usize],
        });
    }
    let total: f64 = faces
        .iter()
        .map(|corners| solid_angle(corners.map(|v| points[v as usize])))
        .sum();
    match (total / (4.0 * std::f64::consts::PI)).round() as i64 {
        1 => Ok(()),
        degree => Err(SphereError::Degree { degree }),
    }
}

/// Returns the area of the spherical triangle of three unit vectors, below 2π where they turn left.
fn solid_angle([a, b, c]: [Vector3<f64>; 3]) -> f64 {
    let volume = a.dot(&(b - a).cross(&(c - a)));
    2.0 * volume.atan2(1.0 + a.dot(&b) + b.dot(&c) + c.dot(&a))
}
