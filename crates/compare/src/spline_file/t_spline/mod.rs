//! T-splines in files.
//!
//! Control points are listed; what is long and derived from the input is told in few bytes: the mesh by what
//! differs from the input, the form by what does not follow from other edges, movements of vertices and
//! coarser levels as bits.

mod first;
mod form;
mod layout;
mod packed;
#[cfg(test)]
mod tests;

use msplines_common::mesh::TriangleMesh;
use msplines_t_spline::caps::CapOptions;
use msplines_t_spline::domain::{End, SnapOptions};
use msplines_t_spline::fit::Level;
use msplines_t_spline::parts::{LevelParts, PartsError};
use msplines_t_spline::tmesh::{Axis, Grid};
use msplines_t_spline::{SurfaceParts, TSplineSurface};
use serde::{Deserialize, Serialize};

pub(super) use first::FirstTSpline;
pub use form::StoredForm;
pub use layout::{FaceRun, StoredLayout};
pub use packed::{Bytes, Vectors};

use crate::error::SplineFileError;

/// A T-spline in a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredTSpline {
    /// The mesh that lies on the cylinders.
    pub mesh: StoredLayout,
    /// The form on its half-edges.
    pub form: StoredForm,
    /// What lies beyond each boundary loop of the mesh.
    pub ends: Vec<End>,
    /// Faces of that mesh outside of the surface, in closed holes, ascending.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outside: Vec<u32>,
    /// What counted as thin and near.
    pub snap: SnapOptions,
    /// How far each vertex has moved, in units.
    pub shifts: Vectors<2>,
    /// The base grid of each cylinder.
    pub grids: Vec<Grid>,
    /// The splits of leaves, in order.
    pub splits: Vec<(u32, Axis)>,
    /// Degrees of the caps.
    pub caps: CapOptions,
    /// Radius of each cap.
    pub radii: Vec<f64>,
    /// Control points, then coefficients of caps.
    pub control: Vec<[f64; 3]>,
    /// Coarser surfaces on the way to this one, the coarsest first.
    pub levels: Vec<StoredLevel>,
}

/// A coarser surface on the way to another one, over the same mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredLevel {
    /// How many of the splits it has.
    pub splits: usize,
    /// Radius of each cap.
    pub radii: Vec<f64>,
    /// Control points, then coefficients of caps.
    pub control: Vectors<3>,
}

impl StoredTSpline {
    /// Returns the stored form of a surface that was fitted to a mesh, and built with these caps, with all
    /// surfaces on the way to it, the last included; there may be none.
    #[must_use]
    pub fn of(
        surface: &TSplineSurface,
        caps: &CapOptions,
        levels: &[Level],
        input: &TriangleMesh,
    ) -> Self {
        let parts = surface.parts(caps).with_levels(levels);
        Self::of_parts(parts, surface.domain().mesh(), input)
    }

    fn of_parts(parts: SurfaceParts, own: &TriangleMesh, input: &TriangleMesh) -> Self {
        let mesh = StoredLayout::of(own, &parts.origins, input);
        let form = StoredForm::of(own.topology(), &parts.form);
        Self::with_layout(mesh, form, parts)
    }

    /// Stores numbers whose form and mesh are `form` and `mesh`.
    fn with_layout(mesh: StoredLayout, form: StoredForm, parts: SurfaceParts) -> Self {
        let level = |level: LevelParts| StoredLevel {
            splits: level.splits,
            radii: level.radii,
            control: Vectors(level.control),
        };
        Self {
            mesh,
            form,
            ends: parts.ends,
            outside: parts.outside,
            snap: parts.snap,
            shifts: Vectors(parts.shifts),
            grids: parts.grids,
            splits: parts.splits,
            caps: parts.caps,
            radii: parts.radii,
            control: parts.control,
            levels: parts.levels.into_iter().map(level).collect(),
        }
    }

    /// Returns how many surfaces there are: the coarser levels and the surface itself.
    #[must_use]
    pub fn level_count(&self) -> usize {
        self.levels.len() + 1
    }

    /// Returns what a file of a level holds, with all coarser ones; 0 is the coarsest.
    ///
    /// # Errors
    /// A level that is not there or has more splits than the surface; numbers that belong to another mesh.
    pub fn at_level(&self, level: usize, input: &TriangleMesh) -> Result<Self, SplineFileError> {
        let (mesh, parts) = self.parts(input)?;
        let coarse = parts.at_level(level).map_err(|error| match error {
            PartsError::Level { level, last } => SplineFileError::NoSuchLevel { level, last },
            error => error.into(),
        })?;
        Ok(Self::of_parts(coarse, &mesh, input))
    }

    /// Returns the surface over the mesh that it was fitted to.
    ///
    /// # Errors
    /// Numbers that are no surface, or belong to another mesh.
    pub fn restore(&self, input: &TriangleMesh) -> Result<TSplineSurface, SplineFileError> {
        let (mesh, parts) = self.parts(input)?;
        Ok(TSplineSurface::from_parts(mesh, &parts)?)
    }

    /// Returns the mesh on the cylinders and all numbers.
    fn parts(&self, input: &TriangleMesh) -> Result<(TriangleMesh, SurfaceParts), SplineFileError> {
        let vertices = input.vertex_count();
        let mut poles = self.ends.iter().filter_map(|end| match end {
            End::Pole(vertex) => Some(*vertex),
            End::Boundary => None,
        });
        if let Some(vertex) = poles.find(|v| *v as usize >= vertices) {
            return Err(SplineFileError::NoSuchVertex { vertex, vertices });
        }
        let (mesh, origins) = self.mesh.restore(input)?;
        let level = |level: &StoredLevel| LevelParts {
            splits: level.splits,
            radii: level.radii.clone(),
            control: level.control.0.clone(),
        };
        let parts = SurfaceParts {
            form: self.form.restore(mesh.topology())?,
            ends: self.ends.clone(),
            outside: self.outside.clone(),
            snap: self.snap,
            origins,
            shifts: self.shifts.0.clone(),
            grids: self.grids.clone(),
            splits: self.splits.clone(),
            caps: self.caps,
            radii: self.radii.clone(),
            control: self.control.clone(),
            levels: self.levels.iter().map(level).collect(),
        };
        Ok((mesh, parts))
    }
}
