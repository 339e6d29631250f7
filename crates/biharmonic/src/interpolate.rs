//! The spline through all data, with every vertex a knot.

use std::sync::Arc;

use msplines_common::evaluate::VertexData;
use msplines_common::linalg::Mat;
use msplines_common::mesh::TriangleMesh;

use crate::fit::{checked_data, finish};
use crate::{BiharmonicSpline, FitError, Laplacian, Space};

/// Returns the spline that takes the data at every vertex, without solving anything.
///
/// # Reference
/// [Hou2017] Alg. 3, Theorem 3.
///
/// # Errors
/// Data that does not fit the mesh, or a mesh that is not connected.
pub fn interpolate(
    mesh: &TriangleMesh,
    data: VertexData<'_>,
    laplacian: Laplacian,
) -> Result<BiharmonicSpline, FitError> {
    let (centred, mean) = checked_data(mesh, data)?;
    let space = Space::build(Arc::new(mesh.clone()), laplacian)?;
    let knots: Vec<u32> = (0..mesh.vertex_count() as u32).collect();
    let coefficients: Mat<f64> = space.coefficients(&centred);
    Ok(finish(space, knots, &coefficients, &centred, &mean))
}
