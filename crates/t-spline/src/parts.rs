//! A surface as plain numbers, as spline files hold them.

use std::sync::Arc;

use msplines_common::Vector3;
use msplines_common::mesh::TriangleMesh;
use serde::{Deserialize, Serialize};

use crate::caps::{CapOptions, Caps, CapsError};
use crate::domain::{Domain, DomainError, End, PeriodicForm, SnapOptions};
use crate::space::TSplineSpace;
use crate::spline::TSpline;
use crate::surface::TSplineSurface;
use crate::tmesh::{Axis, Grid, TMesh, TMeshError};

/// The numbers of a surface besides those of its mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SurfaceParts {
    /// The form, by half-edge of the mesh.
    pub form: Vec<[f64; 2]>,
    /// What lies beyond each boundary loop of the mesh.
    pub ends: Vec<End>,
    /// What counted as thin and near.
    pub snap: SnapOptions,
    /// The vertex of the input that each vertex of the mesh is; nothing for added ones.
    pub origins: Vec<Option<u32>>,
    /// How far each vertex has moved, in units.
    pub shifts: Vec<[f64; 2]>,
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
}

/// Numbers that are no surface over a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PartsError {
    /// The form does not cut the mesh into cylinders.
    #[error("the form of the mesh: {0}")]
    Domain(#[from] DomainError),
    /// Base grids that fit no cylinders.
    #[error("the T-mesh: {0}")]
    TMesh(#[from] TMeshError),
    /// Caps that do not fit.
    #[error("the caps: {0}")]
    Caps(#[from] CapsError),
    /// A split of a leaf that is not there, or cannot be split.
    #[error("split {index} is of leaf {leaf}, which is not there or too narrow")]
    Split {
        /// The split.
        index: usize,
        /// The leaf.
        leaf: u32,
    },
    /// Numbers in another count than the surface needs.
    #[error("there are {given} {what} where {needed} are needed")]
    Count {
        /// What is counted.
        what: &'static str,
        /// How many there are.
        given: usize,
        /// How many there should be.
        needed: usize,
    },
    /// A number that is not finite, or a radius that is not positive.
    #[error("number {index} of the {what} is not finite, or out of range")]
    Number {
        /// Which numbers.
        what: &'static str,
        /// The first.
        index: usize,
    },
}

impl TSplineSurface {
    /// Returns the numbers of the surface, besides those of [`Domain::mesh`].
    ///
    /// `caps` are the options that its space was built with.
    #[must_use]
    pub fn parts(&self, caps: &CapOptions) -> SurfaceParts {
        let (domain, space) = (self.domain(), self.spline().space());
        SurfaceParts {
            form: domain.form().form,
            ends: domain.ends().to_vec(),
            snap: *domain.snap(),
            origins: domain.origins().to_vec(),
            shifts: self.shifts().to_vec(),
            grids: space.mesh().grids().to_vec(),
            splits: space.mesh().splits().to_vec(),
            caps: *caps,
            radii: space.caps().caps().iter().map(|cap| cap.radius).collect(),
            control: self
                .spline()
                .control()
                .iter()
                .map(|c| [c.x, c.y, c.z])
                .collect(),
        }
    }

    /// Returns the surface of numbers over its mesh: the same bits as before.
    ///
    /// # Errors
    /// Numbers that are no surface over this mesh.
    pub fn from_parts(mesh: TriangleMesh, parts: &SurfaceParts) -> Result<Self, PartsError> {
        check_finite(parts)?;
        let vertices = mesh.vertex_count();
        check_count("origins", parts.origins.len(), vertices)?;
        check_count("shifts", parts.shifts.len(), vertices)?;
        let given = PeriodicForm {
            mesh,
            form: parts.form.clone(),
            ends: parts.ends.clone(),
        };
        let domain = Domain::of_form(&given, &parts.snap)?.with_origins(parts.origins.clone());
        let mut tmesh = TMesh::build(&Arc::new(domain.complex().clone()), &parts.grids)?;
        for (index, &(leaf, axis)) in parts.splits.iter().enumerate() {
            if leaf as usize >= tmesh.leaves().len() || !tmesh.split(leaf, axis) {
                return Err(PartsError::Split { index, leaf });
            }
        }
        let mut caps = Caps::build(domain.complex(), &parts.caps)?;
        check_count("radii", parts.radii.len(), caps.caps().len())?;
        for (cap, &radius) in (0..).zip(&parts.radii) {
            caps.set_radius(cap, radius);
        }
        let space = Arc::new(TSplineSpace::with_caps(tmesh, caps));
        check_count("control vectors", parts.control.len(), space.unknowns())?;
        let control = parts.control.iter().map(|&c| Vector3::from(c)).collect();
        Ok(Self::new(
            domain,
            parts.shifts.clone(),
            TSpline::new(space, control),
        ))
    }
}

fn check_count(what: &'static str, given: usize, needed: usize) -> Result<(), PartsError> {
    if given == needed {
        return Ok(());
    }
    Err(PartsError::Count {
        what,
        given,
        needed,
    })
}

fn check_finite(parts: &SurfaceParts) -> Result<(), PartsError> {
    let finite = |x: &f64| x.is_finite();
    let bad = [
        (
            "form",
            parts.form.iter().position(|v| !v.iter().all(finite)),
        ),
        (
            "shifts",
            parts.shifts.iter().position(|v| !v.iter().all(finite)),
        ),
        (
            "radii",
            parts
                .radii
                .iter()
                .position(|r| !(*r > 0.0 && r.is_finite())),
        ),
        (
            "control vectors",
            parts.control.iter().position(|v| !v.iter().all(finite)),
        ),
    ];
    let found = bad
        .into_iter()
        .find_map(|(what, index)| Some((what, index?)));
    found.map_or(Ok(()), |(what, index)| {
        Err(PartsError::Number { what, index })
    })
}
