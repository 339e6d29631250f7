//! Flattening of a disk with free boundary, conformal and of least area distortion.
//!
//! # Notation
//! `u` is the log conformal factor, `Ω` the angle defect of an inner vertex, `k` the exterior angle
//! of a boundary vertex, and `L` the positive Laplacian.

use std::f64::consts::{PI, TAU};

use msplines_common::linalg::{FactorError, Mat, Ordering, OrderingError, SymmetricMatrix};
use msplines_common::mesh::{NONE, TriangleMesh};
use msplines_common::operators::intrinsic::{
    FlipRule, IntrinsicError, IntrinsicTriangulation, intrinsic_delaunay_by,
};
use msplines_common::progress::{Observer, Stages, Stopped};

use crate::extension::{Extension, bound_below, cotangent_weights, ends, laplacian};
use crate::measure::{Distortion, area, measure_planar, planar_flips};
use crate::untangle::untangle_plane;

/// Edge weights of the convex map are at least this, relative to the median.
const WEIGHT_FLOOR: f64 = 1e-7;

/// Why a mesh has no flattening.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DiskError {
    /// The surface falls into parts.
    #[error("the surface has {components} components; flatten each of them by itself")]
    Components {
        /// Number of components.
        components: u32,
    },
    /// The surface has not exactly one boundary loop.
    #[error(
        "the surface has {loops} boundary loops, and a disk has one; close the others, \
         or cut a closed surface open"
    )]
    Loops {
        /// Number of boundary loops.
        loops: usize,
    },
    /// The surface has handles.
    #[error("the surface has genus {genus}, and a disk has genus 0; cut its handles open")]
    Genus {
        /// Number of handles.
        genus: i64,
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
    /// Even the convex map is not one-to-one after rounding.
    #[error(
        "{flips} triangles of the convex map are turned over, the first of them {corners:?}; \
         subdivide the mesh there"
    )]
    Flipped {
        /// Number of such triangles.
        flips: usize,
        /// Corners of the first one.
        corners: [u32; 3],
    },
}

/// How a flattening was reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// Boundary first, without any flip.
    BoundaryFirst,
    /// Boundary first, then this many inner vertices were moved to turn triangles back.
    Repaired {
        /// Number of vertices.
        moved: usize,
    },
    /// Triangles of the first map stayed turned over: the boundary is a circle instead.
    Convex,
}

/// Stages that the observer sees: triangulation, ordering, the map, and the other one if it folds.
const STAGES: u64 = 4;

/// A locally one-to-one map of the vertices of a disk into the plane.
#[derive(Clone, Debug)]
pub struct DiskMap {
    /// The image of each vertex, in the unit of length of the mesh.
    pub points: Vec<[f64; 2]>,
    /// The triangulation whose images all turn left; it has the faces of an ordinary mesh.
    pub triangulation: IntrinsicTriangulation,
    /// How the map was reached.
    pub route: Route,
    /// Triangles of the mesh itself that are turned over.
    pub flips_of_mesh: usize,
    /// How far the map of the triangulation is from conformal; it has no flips.
    pub distortion: Distortion,
}

/// Returns the flattening of a disk that leaves its boundary as long as it is.
///
/// Of all conformal maps the one with factor 1 along the boundary has least area distortion. The
/// image is locally one-to-one; its boundary may cross itself. Where the discrete map turns
/// triangles over, inner vertices are moved, and failing that the boundary becomes a circle; the
/// result says which. Cost: one ordering and one factorisation of the Laplacian, two in the last
/// case. Equal input gives equal bits on any number of threads.
///
/// # Reference
/// [Sawhney2017]. Deviation: both coordinates are extended harmonically, on the intrinsic
/// Delaunay triangulation.
///
/// # Errors
/// A mesh that is not one disk; the observer asks to stop.
pub fn flatten_disk(
    mesh: &TriangleMesh,
    observer: &mut Observer<'_>,
) -> Result<DiskMap, DiskError> {
    check(mesh)?;
    let mut stages = Stages::new("domain", STAGES, observer);
    stages.enter()?;
    let triangulation = intrinsic_delaunay_by(mesh, FlipRule::Simplicial)?;
    let disk = Disk::of(mesh.vertex_count(), &triangulation);
    let mut weights = cotangent_weights(&triangulation);
    let matrix = laplacian(mesh.vertex_count(), &triangulation, &weights);
    stages.enter()?;
    let ordering = Ordering::minimum_degree(&matrix, |_| true)?;
    stages.enter()?;
    let mut route = Route::BoundaryFirst;
    let mut points = disk.boundary_first(&matrix, &ordering)?;
    if !planar_flips(&triangulation.faces, &points).is_empty() {
        let moved = untangle_plane(&triangulation, &mut points);
        route = Route::Repaired { moved };
    }
    stages.enter()?;
    if !disk.is_locally_injective(&points) {
        bound_below(&mut weights, WEIGHT_FLOOR);
        let matrix = laplacian(mesh.vertex_count(), &triangulation, &weights);
        points = disk.convex(&matrix, &ordering)?;
        route = Route::Convex;
        untangle_plane(&triangulation, &mut points);
    }
    let flips = planar_flips(&triangulation.faces, &points);
    if let Some(&first) = flips.first() {
        return Err(DiskError::Flipped {
            flips: flips.len(),
            corners: triangulation.faces[first as usize],
        });
    }
    let distortion = measure_planar(&triangulation.faces, &triangulation.lengths, &points);
    Ok(DiskMap {
        flips_of_mesh: planar_flips(mesh.faces(), &points).len(),
        points,
        triangulation,
        route,
        distortion,
    })
}

fn check(mesh: &TriangleMesh) -> Result<(), DiskError> {
    let topology = mesh.topology();
    let (_, components) = topology.components();
    if components > 1 {
        return Err(DiskError::Components { components });
    }
    let loops = topology.boundary_loops().len();
    if loops != 1 {
        return Err(DiskError::Loops { loops });
    }
    match (1 - topology.euler_characteristic()) / 2 {
        0 => Ok(()),
        genus => Err(DiskError::Genus { genus }),
    }
}

/// A triangulated disk.
struct Disk<'a> {
    triangulation: &'a IntrinsicTriangulation,
    vertex_count: usize,
    /// Vertices of the boundary, the surface on their left.
    boundary: Vec<u32>,
    /// Length from each of them to the next.
    sides: Vec<f64>,
    inner: Vec<bool>,
}

impl<'a> Disk<'a> {
    fn of(vertex_count: usize, triangulation: &'a IntrinsicTriangulation) -> Self {
        let mut next = vec![NONE; vertex_count];
        let mut start = 0;
        for half_edge in 0..triangulation.twins.len() as u32 {
            if triangulation.twins[half_edge as usize] == NONE {
                start = ends(triangulation, half_edge)[0];
                next[start as usize] = half_edge;
            }
        }
        let (mut boundary, mut sides) = (Vec::new(), Vec::new());
        let mut vertex = start;
        loop {
            let half_edge = next[vertex as usize];
            boundary.push(vertex);
            sides.push(triangulation.lengths[(half_edge / 3) as usize][(half_edge % 3) as usize]);
            vertex = ends(triangulation, half_edge)[1];
            if vertex == start {
                break;
            }
        }
        Self {
            triangulation,
            vertex_count,
            boundary,
            sides,
            inner: next.iter().map(|&h| h == NONE).collect(),
        }
    }

    /// Returns the map whose conformal factor along the boundary is 1.
    fn boundary_first(
        &self,
        laplacian: &SymmetricMatrix,
        ordering: &Ordering,
    ) -> Result<Vec<[f64; 2]>, FactorError> {
        let extension = Extension::factor(laplacian, ordering, self.inner.clone())?;
        let lengths = self.triangulation.lengths.iter();
        let angles = lengths.map(|&sides| angles_of(sides));
        let sums = self.angle_sums(angles);
        // The metric e^2u g is flat where Δu is the curvature.
        let mut factor = Mat::zeros(self.vertex_count, 1);
        extension.solve(&mut factor, &|row, _| sums[row] - TAU);
        let exterior = self.boundary.iter().map(|&vertex| {
            let v = vertex as usize;
            let neighbours = laplacian.column(v).filter(|entry| entry.0 != v);
            let pull = |(other, entry): (usize, f64)| entry * (factor[(other, 0)] - factor[(v, 0)]);
            PI - sums[v] + neighbours.map(pull).sum::<f64>()
        });
        let curve = closed_curve(&self.sides, exterior);
        Ok(self.extend(&extension, &curve))
    }

    /// Returns the harmonic map onto a disk, the boundary along a circle by arc length.
    ///
    /// # Reference
    /// [Floater1997].
    fn convex(
        &self,
        laplacian: &SymmetricMatrix,
        ordering: &Ordering,
    ) -> Result<Vec<[f64; 2]>, FactorError> {
        let extension = Extension::factor(laplacian, ordering, self.inner.clone())?;
        let total: f64 = self.sides.iter().sum();
        let mut along = 0.0;
        let place = |&side: &f64| {
            let (sine, cosine) = (TAU * along / total).sin_cos();
            along += side;
            [cosine, sine].map(|x| x * total / TAU)
        };
        let circle: Vec<[f64; 2]> = self.sides.iter().map(place).collect();
        Ok(self.extend(&extension, &circle))
    }

    fn extend(&self, extension: &Extension<'_>, curve: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let mut values = Mat::zeros(self.vertex_count, 2);
        for (&vertex, point) in self.boundary.iter().zip(curve) {
            (0..2).for_each(|side| values[(vertex as usize, side)] = point[side]);
        }
        extension.extend(&mut values);
        let rows = 0..self.vertex_count;
        rows.map(|v| [values[(v, 0)], values[(v, 1)]]).collect()
    }

    /// Returns the sum of the angles of faces at each vertex.
    fn angle_sums(&self, angles: impl Iterator<Item = [f64; 3]>) -> Vec<f64> {
        let mut sums = vec![0.0; self.vertex_count];
        for (corners, angles) in self.triangulation.faces.iter().zip(angles) {
            for (&corner, angle) in corners.iter().zip(angles) {
                sums[corner as usize] += angle;
            }
        }
        sums
    }

    /// Whether every face turns left and the faces go once around every inner vertex.
    fn is_locally_injective(&self, points: &[[f64; 2]]) -> bool {
        let faces = &self.triangulation.faces;
        let angles = faces.iter().map(|corners| {
            let p = corners.map(|v| points[v as usize]);
            [0, 1, 2].map(|i| turn(p[i], p[(i + 1) % 3], p[(i + 2) % 3]))
        });
        let sums = self.angle_sums(angles);
        planar_flips(faces, points).is_empty()
            && (sums.iter().zip(&self.inner)).all(|(sum, inner)| !inner || (sum - TAU).abs() < PI)
    }
}

/// Returns the corners of the closed curve with these exterior angles at its corners and sides
/// nearest to those given.
///
/// # Reference
/// [Sawhney2017]. Lengths change in proportion to themselves.
fn closed_curve(sides: &[f64], exterior: impl Iterator<Item = f64>) -> Vec<[f64; 2]> {
    let mut direction = 0.0;
    let tangents: Vec<[f64; 2]> = exterior
        .map(|angle: f64| {
            direction += angle;
            [f64::cos(direction), f64::sin(direction)]
        })
        .collect();
    let sum = |weight: &dyn Fn([f64; 2]) -> f64| -> f64 {
        let both = sides.iter().zip(&tangents);
        both.map(|(side, &tangent)| side * weight(tangent)).sum()
    };
    let [xx, xy, yy] = [
        sum(&|t| t[0] * t[0]),
        sum(&|t| t[0] * t[1]),
        sum(&|t| t[1] * t[1]),
    ];
    let gap = [sum(&|t| t[0]), sum(&|t| t[1])];
    let determinant = xx * yy - xy * xy;
    let shift = [
        (yy * gap[0] - xy * gap[1]) / determinant,
        (xx * gap[1] - xy * gap[0]) / determinant,
    ];
    let mut at = [0.0; 2];
    let step = |(side, t): (&f64, &[f64; 2])| {
        let here = at;
        let length = side * (1.0 - t[0] * shift[0] - t[1] * shift[1]);
        (0..2).for_each(|x| at[x] += length * t[x]);
        here
    };
    sides.iter().zip(&tangents).map(step).collect()
}

/// Returns the angle at each corner of a triangle.
fn angles_of(sides: [f64; 3]) -> [f64; 3] {
    let fourfold = 4.0 * area(sides);
    [0, 1, 2].map(|i| {
        let [after, opposite, before] = [0, 1, 2].map(|k| sides[(i + k) % 3]);
        let cosine = after * after + (before - opposite) * (before + opposite);
        fourfold.atan2(cosine)
    })
}

/// Returns the angle at `a` from `b` to `c`.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let [[px, py], [qx, qy]] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1]]);
    (px * qy - py * qx).atan2(px * qx + py * qy)
}

#[cfg(test)]
#[path = "disk_tests.rs"]
mod tests;
