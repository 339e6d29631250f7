//! How far a surface is from the Catmull-Clark surface of its control mesh.

use msplines_common::mesh::polygon::{
    PolygonMesh, Refined, Rules, Sharpness, limit_stencils, limit_tangent_stencils,
};
use msplines_common::mesh::{SurfacePoint, TriangleMesh};
use msplines_common::metrics::SurfaceTree;
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::observations::LimitGrid;
use crate::spline::SparseManifold;
use crate::tessellate::Tessellator;

/// Levels of the grid on which surfaces are compared: 16 by 16 cells in every face.
const LEVELS: u32 = 4;

/// Distances between points of equal parameters, in mean lengths of control edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DenseError {
    /// Root of the mean square.
    pub rms: f64,
    /// Largest.
    pub max: f64,
}

/// Returns the distance to exact points of the limit surface on 16 by 16 cells in every face, between
/// the observations too.
///
/// Points on an edge count once for each of its faces.
#[must_use]
pub fn dense_error(spline: &SparseManifold, sharpness: &Sharpness, rules: Rules) -> DenseError {
    let mesh = spline.mesh();
    let limit = LimitGrid::build(mesh, sharpness, rules, LEVELS).observations(mesh.positions());
    let tessellator = Tessellator::build(spline, 1 << LEVELS);
    let faces: Vec<(f64, f64)> = (0..mesh.face_count() as u32)
        .into_par_iter()
        .map(|face| {
            let points = tessellator.face(spline, face);
            let pairs = points.iter().zip(limit.grid(face));
            pairs.fold((0.0, 0.0), |(sum, max): (f64, f64), (p, &o)| {
                let square = (nalgebra::Point3::from(*p) - limit.points[o as usize]).norm_squared();
                (sum + square, max.max(square))
            })
        })
        .collect();
    let (sum, max) = faces
        .iter()
        .fold((0.0, 0.0), |(s, m): (f64, f64), f| (s + f.0, m.max(f.1)));
    let edge = mesh.mean_edge_length();
    DenseError {
        rms: (sum / limit.grids.len() as f64).sqrt() / edge,
        max: max.sqrt() / edge,
    }
}

/// A Catmull-Clark surface as a shape that other surfaces are compared with, whatever their domain.
#[derive(Debug)]
pub struct LimitSurface {
    mesh: TriangleMesh,
    tree: SurfaceTree,
    /// Normals at the corners of the triangles.
    normals: Vec<[Vector3<f64>; 3]>,
}

/// How far a surface is from another as a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeError {
    /// Root of the mean squared distance from the nearest point.
    pub rms: f64,
    /// Largest such distance.
    pub max: f64,
    /// Mean angle between the normals there, in degrees.
    pub normals_degrees: f64,
}

impl LimitSurface {
    /// Returns the limit surface of a control mesh of quads, cut into triangles with exact corners.
    #[must_use]
    pub fn build(mesh: &PolygonMesh, sharpness: &Sharpness, rules: Rules) -> Option<Self> {
        let start = Refined::none(mesh.topology(), sharpness);
        let refined = (0..LEVELS).fold(start, |refined, _| refined.again(rules));
        let points = limit_stencils(&refined, rules).apply(mesh.positions());
        let half_edges: Vec<u32> = (0..refined.topology.half_edge_count() as u32).collect();
        let tangents = limit_tangent_stencils(&refined, &half_edges, rules);
        let tangents = tangents.apply(mesh.positions());
        let normal = |h: usize| {
            let [u, v] = [2 * h, 2 * h + 1].map(|i| tangents[i].coords);
            u.cross(&v).try_normalize(0.0).unwrap_or_default()
        };
        let (mut triangles, mut normals) = (Vec::new(), Vec::new());
        for (face, corners) in refined.topology.faces().enumerate() {
            for half in [[0, 1, 2], [0, 2, 3]] {
                triangles.push(half.map(|corner| corners[corner]));
                normals.push(half.map(|corner| normal(4 * face + corner)));
            }
        }
        let mesh = TriangleMesh::build(points, triangles).ok()?;
        Some(Self {
            tree: SurfaceTree::build(&mesh),
            mesh,
            normals,
        })
    }

    /// Returns the surface cut into triangles: 16 by 16 cells in every face.
    #[must_use]
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// Returns how far a manifold is from this surface, at the middles of `cells` by `cells` cells in
    /// each of its faces.
    #[must_use]
    pub fn error(&self, spline: &SparseManifold, cells: u32) -> ShapeError {
        let step = |i: u32| (f64::from(i) + 0.5) / f64::from(cells);
        let at = |face: u32, i: u32| SurfacePoint {
            face,
            at: [step(i % cells), step(i / cells), 0.0],
        };
        let faces: Vec<[f64; 3]> = (0..spline.mesh().face_count() as u32)
            .into_par_iter()
            .map(|face| {
                let points: Vec<SurfacePoint> = (0..cells * cells).map(|i| at(face, i)).collect();
                self.face_error(spline, &points)
            })
            .collect();
        let sums = faces.iter().fold([0.0, 0.0, 0.0], |[s, m, a], f| {
            [s + f[0], f64::max(m, f[1]), a + f[2]]
        });
        let count = (faces.len() * (cells * cells) as usize).max(1) as f64;
        ShapeError {
            rms: (sums[0] / count).sqrt(),
            max: sums[1],
            normals_degrees: sums[2] / count,
        }
    }

    /// Returns the sum of squared distances, the largest distance and the sum of angles.
    fn face_error(&self, spline: &SparseManifold, points: &[SurfacePoint]) -> [f64; 3] {
        // Points inside of faces are always on the surface.
        let found = spline.geometry(points).unwrap_or_default();
        let mut sums = [0.0; 3];
        for geometry in &found {
            let Some(foot) = self.tree.closest(&geometry.position) else {
                continue;
            };
            let corners = self.normals[foot.point.face as usize].iter();
            let normal: Vector3<f64> = corners.zip(foot.point.at).map(|(n, b)| n * b).sum();
            sums[0] += foot.distance.powi(2);
            sums[1] = sums[1].max(foot.distance);
            sums[2] += normal.angle(&geometry.normal).to_degrees();
        }
        sums
    }
}
