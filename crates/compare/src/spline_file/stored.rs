//! The numbers of splines of all methods, as they are stored.

use std::sync::Arc;

use msplines_biharmonic::{Scheme, Space};
use msplines_common::Point3;
use msplines_common::mesh::TriangleMesh;
use msplines_ls_mesh::{Constraints, LsMesh};
use msplines_powell_sabin::PowellSabinSurface;
use msplines_powell_sabin::surface::SurfaceParts;
use msplines_t_spline::TSplineSurface;
use serde::{Deserialize, Serialize};

use super::{
    LARGEST, StoredBiharmonic, StoredLocal, StoredManifold, StoredTSpline, StoredTrivariate,
};
use crate::error::{RunError, SplineFileError};

/// The numbers of a spline, from which it is evaluated again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "method", content = "data", rename_all = "kebab-case")]
pub enum StoredSpline {
    /// A biharmonic B-spline.
    Biharmonic(StoredBiharmonic),
    /// Control vertices of a least-squares mesh.
    LsMesh {
        /// Components of a value.
        dimension: usize,
        /// Control vertices.
        controls: Vec<u32>,
        /// Value of each control vertex, `[control][component]`.
        control_values: Vec<f64>,
        /// How the control values bind.
        constraints: Constraints,
    },
    /// A sparse manifold.
    SparseManifold(StoredManifold),
    /// The function of a single chart.
    Chart(StoredLocal),
    /// A trivariate spline.
    Trivariate(StoredTrivariate),
    /// A Powell-Sabin spline over a surface.
    PowellSabin(Box<SurfaceParts>),
    /// A T-spline over a surface.
    TSpline(Box<StoredTSpline>),
}

impl StoredSpline {
    /// Returns the stored form of a least-squares mesh.
    #[must_use]
    pub fn of_ls_mesh(spline: &LsMesh, constraints: Constraints) -> Self {
        Self::LsMesh {
            dimension: spline.dimension(),
            controls: spline.controls().to_vec(),
            control_values: spline.control_values().to_vec(),
            constraints,
        }
    }

    /// Returns the biharmonic B-spline that this is.
    ///
    /// # Errors
    /// A spline of another method, which does not have the `task`.
    pub(crate) fn biharmonic(&self, task: &'static str) -> Result<&StoredBiharmonic, RunError> {
        match self {
            Self::Biharmonic(stored) => Ok(stored),
            _ => Err(self.without(task)),
        }
    }

    /// Returns the sparse manifold that this is.
    ///
    /// # Errors
    /// A spline of another method, which does not have the `task`.
    pub(crate) fn manifold(&self, task: &'static str) -> Result<&StoredManifold, RunError> {
        match self {
            Self::SparseManifold(stored) => Ok(stored),
            _ => Err(self.without(task)),
        }
    }

    /// Returns the trivariate spline that this is.
    ///
    /// # Errors
    /// A spline of another method, which does not have the `task`.
    pub(crate) fn trivariate(&self, task: &'static str) -> Result<&StoredTrivariate, RunError> {
        match self {
            Self::Trivariate(stored) => Ok(stored),
            _ => Err(self.without(task)),
        }
    }

    /// Returns the Powell-Sabin spline that this is, over its mesh.
    ///
    /// # Errors
    /// A spline of another method, or numbers that do not fit the mesh.
    pub(crate) fn powell_sabin(&self, mesh: &TriangleMesh) -> Result<PowellSabinSurface, RunError> {
        match self {
            Self::PowellSabin(parts) => {
                let surface = PowellSabinSurface::from_parts(mesh.clone(), parts);
                Ok(surface.map_err(SplineFileError::from)?)
            }
            _ => Err(self.without("Powell-Sabin surface")),
        }
    }

    /// Returns the T-spline that this is, over the mesh it was fitted to.
    ///
    /// # Errors
    /// A spline of another method, or numbers that do not fit the mesh.
    pub(crate) fn t_spline(&self, mesh: &TriangleMesh) -> Result<TSplineSurface, RunError> {
        match self {
            Self::TSpline(stored) => Ok(stored.restore(mesh)?),
            _ => Err(self.without("T-spline surface")),
        }
    }

    fn without(&self, task: &'static str) -> RunError {
        RunError::Task {
            task,
            method: self.method(),
        }
    }

    /// Returns the name of the method.
    #[must_use]
    pub fn method(&self) -> &'static str {
        match self {
            Self::Biharmonic(_) => "biharmonic",
            Self::LsMesh { .. } => "ls-mesh",
            Self::SparseManifold(_) => "sparse-manifold",
            Self::Chart(_) => "chart",
            Self::Trivariate(_) => "trivariate",
            Self::PowellSabin(_) => "powell-sabin",
            Self::TSpline(_) => "t-spline",
        }
    }

    /// Returns the number of components of a value.
    #[must_use]
    pub fn dimension(&self) -> usize {
        match self {
            Self::Biharmonic(spline) => spline.dimension,
            Self::LsMesh { dimension, .. } => *dimension,
            Self::SparseManifold(_)
            | Self::Trivariate(_)
            | Self::PowellSabin(_)
            | Self::TSpline(_) => 3,
            Self::Chart(_) => 1,
        }
    }

    /// Returns the vertices that are knots or control vertices.
    #[must_use]
    pub fn knots(&self) -> &[u32] {
        match self {
            Self::Biharmonic(spline) => &spline.knots,
            Self::LsMesh { controls, .. } => controls,
            Self::SparseManifold(_)
            | Self::Chart(_)
            | Self::Trivariate(_)
            | Self::PowellSabin(_)
            | Self::TSpline(_) => &[],
        }
    }

    /// Returns the places of the knots or control vertices on the domain `mesh`.
    ///
    /// # Panics
    /// If the spline belongs to another mesh.
    #[must_use]
    pub fn knot_places(&self, mesh: &TriangleMesh) -> Vec<Point3<f64>> {
        let added = match self {
            Self::Biharmonic(spline) => spline.added_points.as_slice(),
            Self::LsMesh { .. }
            | Self::SparseManifold(_)
            | Self::Chart(_)
            | Self::Trivariate(_)
            | Self::PowellSabin(_)
            | Self::TSpline(_) => &[],
        };
        let place = |&knot: &u32| match mesh.positions().get(knot as usize) {
            Some(vertex) => *vertex,
            None => mesh.position(added[knot as usize - mesh.vertex_count()]),
        };
        self.knots().iter().map(place).collect()
    }

    /// Returns the values at the vertices of `mesh`, or of its midpoint subdivision after `rounds`
    /// rounds, with the mesh they belong to.
    ///
    /// # Errors
    /// Numbers that do not fit the mesh, or a system that cannot be solved.
    pub fn evaluate(
        &self,
        mesh: &TriangleMesh,
        rounds: u32,
    ) -> Result<(TriangleMesh, Vec<f64>), SplineFileError> {
        self.evaluate_by(Scheme::Planar, mesh, rounds)
    }

    /// Returns what [`Self::evaluate`] does on the subdivision of another scheme, where it is not the
    /// spline.
    ///
    /// # Errors
    /// As [`Self::evaluate`].
    pub fn evaluate_by(
        &self,
        scheme: Scheme,
        mesh: &TriangleMesh,
        rounds: u32,
    ) -> Result<(TriangleMesh, Vec<f64>), SplineFileError> {
        self.evaluate_in(None, scheme, mesh, rounds)
    }

    /// The same in the space that a biharmonic spline was fitted in: what that has computed is not
    /// computed again.
    pub(crate) fn evaluate_in(
        &self,
        space: Option<&Arc<Space>>,
        scheme: Scheme,
        mesh: &TriangleMesh,
        rounds: u32,
    ) -> Result<(TriangleMesh, Vec<f64>), SplineFileError> {
        match self {
            Self::Biharmonic(stored) => {
                let spline = match space {
                    Some(space) => stored.restore_in(space)?,
                    None => stored.restore(mesh)?,
                };
                if rounds == 0 {
                    return Ok((mesh.clone(), spline.vertex_values()?));
                }
                Ok(spline.extension_by(scheme, rounds)?)
            }
            Self::SparseManifold(_) | Self::Chart(_) => Err(SplineFileError::Polygons),
            Self::Trivariate(_) => Err(SplineFileError::Cube),
            Self::PowellSabin(_) => Err(SplineFileError::SurfacePoints),
            Self::TSpline(_) => Err(SplineFileError::OwnTessellation),
            Self::LsMesh { .. } if rounds > 0 => Err(SplineFileError::VerticesOnly),
            Self::LsMesh {
                dimension,
                controls,
                control_values,
                constraints,
            } => {
                check_lengths(controls, *dimension, control_values, mesh.vertex_count())?;
                let spline = LsMesh::from_parts(
                    mesh,
                    *constraints,
                    *dimension,
                    controls.clone(),
                    control_values.clone(),
                )?;
                Ok((mesh.clone(), spline.vertex_values().to_vec()))
            }
        }
    }
}

/// Checks that there are values for every knot, and that the knots are vertices.
pub(super) fn check_lengths(
    knots: &[u32],
    dimension: usize,
    values: &[f64],
    vertices: usize,
) -> Result<(), SplineFileError> {
    if dimension == 0 || knots.len().checked_mul(dimension) != Some(values.len()) {
        return Err(SplineFileError::WrongLength {
            knots: knots.len(),
            dimension,
            values: values.len(),
        });
    }
    if let Some(&vertex) = knots.iter().find(|&&v| v as usize >= vertices) {
        return Err(SplineFileError::NoSuchVertex { vertex, vertices });
    }
    match values.iter().position(|x| x.is_nan() || x.abs() > LARGEST) {
        Some(index) => Err(SplineFileError::NotFinite {
            what: "coefficient",
            index,
        }),
        None => Ok(()),
    }
}
