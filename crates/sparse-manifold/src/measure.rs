//! How far a surface is from the Catmull-Clark surface of its control mesh.

use msplines_common::mesh::polygon::{Rules, Sharpness};
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
