//! The spline through all data, with every vertex a knot.

use std::sync::Arc;

use msplines_common::evaluate::VertexData;
use msplines_common::mesh::TriangleMesh;

use crate::target::Centred;
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
    let target = Centred::check(mesh.vertex_count(), &data.into())?;
    let space = Arc::new(Space::build(Arc::new(mesh.clone()), laplacian)?);
    let knots: Vec<u32> = (0..mesh.vertex_count() as u32).collect();
    let (data, mean) = (&target.data, &target.mean);
    Ok(BiharmonicSpline::of_vertex_values(
        &space, knots, data, mean,
    ))
}
