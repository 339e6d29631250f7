//! The harmonic latitude of a surface, and levels of it that cut equal areas.
//!
//! With positive weights every vertex but the poles is a weighted mean of its neighbours, so that
//! it has a lower and a higher one: its index, 1 minus half the changes of sign around it, is at
//! most 0. Over a sphere indices sum to 2, and the poles have 1 each. So all others have index 0:
//! there is no saddle, and every level set is one loop.

use msplines_common::linalg::SymmetricMatrix;
use msplines_common::mesh::{Facts, TriangleMesh};
use msplines_common::operators::{Operators, mesh_operators};

use super::error::CylinderError;
use super::options::Poles;
use super::poles;
use crate::domain::boundary::{BoundaryError, check_surface};
use crate::domain::dirichlet::Dirichlet;

/// Smallest weight of an edge, against the cotangent of 45 degrees.
const SMALLEST_WEIGHT: f64 = 1e-2;

/// A function on the surface that rises from one pole to the other.
pub(super) struct Latitude {
    /// The poles.
    pub(super) poles: [u32; 2],
    /// Its value at each vertex, from 0 to 1.
    pub(super) values: Vec<f64>,
    /// Whether the normals of the surface point inwards.
    pub(super) inward: bool,
    /// The part of the surface that belongs to each vertex.
    areas: Vec<f64>,
}

/// Returns the harmonic latitude.
///
/// # Reference
/// [Martin2008]. Deviation: cotangents that are small or negative are replaced by a positive
/// weight, so that every level set is one loop.
pub(super) fn solve(surface: &TriangleMesh, poles: Poles) -> Result<Latitude, CylinderError> {
    check_surface(surface)?;
    for face in 0..surface.face_count() as u32 {
        if !surface.face_normal(face).norm().is_normal() {
            let vertices = surface.faces()[face as usize];
            return Err(BoundaryError::FlatFace { face, vertices }.into());
        }
    }
    let poles = poles::find(surface, poles)?;
    let operators = mesh_operators(surface);
    let weights = convex(&operators);
    let mut given = vec![false; surface.vertex_count()];
    let mut values = vec![[0.0; 3]; surface.vertex_count()];
    for (pole, vertex) in poles.into_iter().enumerate() {
        given[vertex as usize] = true;
        values[vertex as usize][0] = pole as f64;
    }
    Dirichlet::factor(&weights, &given)?.solve(&mut [&mut values]);
    Ok(Latitude {
        poles,
        values: values.into_iter().map(|[value, ..]| value).collect(),
        inward: Facts::measure(surface).volume.is_some_and(|v| v < 0.0),
        areas: operators.mass,
    })
}

/// The Laplacian with positive weights.
fn convex(operators: &Operators) -> SymmetricMatrix {
    let laplacian = &operators.laplacian;
    let mut entries = Vec::with_capacity(2 * laplacian.entry_count());
    for column in 0..laplacian.size() {
        for (row, entry) in laplacian.column(column).filter(|&(row, _)| row > column) {
            let weight = (-entry).max(SMALLEST_WEIGHT);
            let (row, column) = (row as u32, column as u32);
            entries.extend([
                (row, row, weight),
                (column, column, weight),
                (row, column, -weight),
            ]);
        }
    }
    SymmetricMatrix::from_lower_triplets(laplacian.size(), &entries)
}

impl Latitude {
    /// Returns values between those of the poles, ascending, with equal areas of the surface
    /// between them.
    pub(super) fn levels(&self, count: usize) -> Vec<f64> {
        let value = |v: u32| self.values[v as usize];
        let mut order: Vec<u32> = (0..self.values.len() as u32).collect();
        order.sort_by(|&a, &b| value(a).total_cmp(&value(b)).then(a.cmp(&b)));
        // The area below a vertex, half of its own included; a pole has all of its own on one side.
        let mut below = Vec::with_capacity(order.len());
        let mut total = 0.0;
        for &v in &order {
            below.push(total + 0.5 * self.areas[v as usize]);
            total += self.areas[v as usize];
        }
        below[0] = 0.0;
        below[order.len() - 1] = total;
        (1..=count)
            .map(|k| {
                let target = total * k as f64 / (count + 1) as f64;
                let next = below.partition_point(|&area| area < target);
                let next = next.clamp(1, order.len() - 1);
                let step = below[next] - below[next - 1];
                let share = if step > 0.0 {
                    (target - below[next - 1]) / step
                } else {
                    0.5
                };
                let [low, high] = [order[next - 1], order[next]].map(value);
                low + (high - low) * share
            })
            .collect()
    }
}
