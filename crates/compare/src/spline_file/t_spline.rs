//! T-splines in files.

use msplines_common::mesh::TriangleMesh;
use msplines_t_spline::caps::CapOptions;
use msplines_t_spline::domain::End;
use msplines_t_spline::{SurfaceParts, TSplineSurface};
use serde::{Deserialize, Serialize};

use super::StoredMesh;
use crate::error::SplineFileError;

/// A T-spline in a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredTSpline {
    /// The mesh that lies on the cylinders, where it is another one than the domain of the file: with
    /// edges flipped, faces split, stars of poles removed.
    pub mesh: Option<StoredMesh>,
    /// The numbers of the surface over it.
    pub surface: SurfaceParts,
}

impl StoredTSpline {
    /// Returns the stored form of a surface that was fitted to a mesh, and built with these caps.
    #[must_use]
    pub fn of(surface: &TSplineSurface, caps: &CapOptions, input: &TriangleMesh) -> Self {
        let own = surface.domain().mesh();
        let same = own.faces() == input.faces() && own.positions() == input.positions();
        Self {
            mesh: (!same).then(|| StoredMesh::of(own)),
            surface: surface.parts(caps),
        }
    }

    /// Returns the surface over the mesh that it was fitted to.
    ///
    /// # Errors
    /// Numbers that are no surface, or belong to another mesh.
    pub fn restore(&self, input: &TriangleMesh) -> Result<TSplineSurface, SplineFileError> {
        let vertices = input.vertex_count();
        let beyond = |v: &&u32| **v as usize >= vertices;
        let poles = self.surface.ends.iter().filter_map(|end| match end {
            End::Pole(vertex) => Some(vertex),
            End::Boundary => None,
        });
        let mut named = self.surface.origins.iter().flatten().chain(poles);
        if let Some(&vertex) = named.find(beyond) {
            return Err(SplineFileError::NoSuchVertex { vertex, vertices });
        }
        let mesh = match &self.mesh {
            Some(mesh) => mesh.restore()?,
            None => input.clone(),
        };
        Ok(TSplineSurface::from_parts(mesh, &self.surface)?)
    }
}
