//! Unit normals at the vertices of a mesh.

use msplines_common::Vector3;
use msplines_common::mesh::{Topology, TriangleMesh};

use crate::error::NormalError;

/// Returns a unit normal for every vertex: the cross products of pairs of edges, each divided by the
/// squared lengths of both.
///
/// This is exact where a vertex and its neighbours lie on a sphere and its faces close; elsewhere,
/// among the weights that use the faces at a vertex alone, it is the most accurate in its author's
/// comparison.
///
/// # Reference
/// [Max1999].
///
/// # Errors
/// A vertex whose faces have no area, or cancel.
pub fn estimate_normals(mesh: &TriangleMesh) -> Result<Vec<Vector3<f64>>, NormalError> {
    let topology = mesh.topology();
    let position = |v: u32| mesh.positions()[v as usize];
    (0..mesh.vertex_count() as u32)
        .map(|vertex| {
            let mut sum = Vector3::zeros();
            let mut largest = 0.0_f64;
            for h in topology.outgoing(vertex) {
                let back = topology.origin(Topology::previous(h));
                let out = position(topology.target(h)) - position(vertex);
                let back = position(back) - position(vertex);
                // Divided one by one: the product of four lengths overflows much earlier.
                let (a, b) = (out.norm(), back.norm());
                let term = (out / a).cross(&(back / b)) / a / b;
                if term.iter().all(|c| c.is_finite()) {
                    sum += term;
                    largest = largest.max(term.norm());
                }
            }
            // A sum below rounding of its terms has no direction.
            sum.try_normalize(1e-12 * largest)
                .filter(|n| n.iter().all(|c| c.is_finite()) && largest > 0.0)
                .ok_or(NormalError::Undefined { vertex })
        })
        .collect()
}
