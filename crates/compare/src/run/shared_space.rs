//! A method with all that fits of changing data on one mesh share.

use std::sync::Arc;

use msplines_biharmonic as biharmonic;
use msplines_common::evaluate::VertexData;
use msplines_common::progress::Observer;
use msplines_ls_mesh as ls_mesh;

use crate::case::{Case, Method};
use crate::error::{RunError, SplineFileError};
use crate::fit::{Fitted, biharmonic_options, ls_mesh_options};
use crate::input::LoadedInput;
use crate::spline_file::StoredSpline;

/// A method, its options, and its space on the mesh of a run.
pub(super) enum SharedSpace {
    /// The bi-Laplacian, its elimination order, and the factor of the Laplacian.
    Biharmonic {
        space: Arc<biharmonic::Space>,
        options: biharmonic::Options,
        weights: Option<Vec<f64>>,
    },
    /// The graph Laplacian and its elimination order.
    LsMesh {
        space: Box<ls_mesh::Space>,
        options: ls_mesh::Options,
    },
}

impl SharedSpace {
    /// Assembles and orders the operators.
    pub(super) fn build(case: &Case, input: &LoadedInput) -> Result<Self, RunError> {
        let mesh = &input.mesh;
        match &case.method {
            Method::Biharmonic(method) => {
                let (options, weights) = biharmonic_options(method, case.seed, mesh)?;
                let creases = options.creases.on(mesh)?;
                let domain = Arc::new(mesh.clone());
                let space = biharmonic::Space::with_creases(domain, options.laplacian, creases)?;
                space.bilaplacian()?;
                Ok(Self::Biharmonic {
                    space: Arc::new(space),
                    options,
                    weights,
                })
            }
            Method::LsMesh {
                controls,
                selection,
                constraints,
            } => Ok(Self::LsMesh {
                options: ls_mesh_options(*controls, *selection, *constraints, mesh)?,
                space: Box::new(ls_mesh::Space::assemble(mesh)?),
            }),
            Method::SparseManifold(_)
            | Method::CurveNetwork(_)
            | Method::Chart(_)
            | Method::Trivariate(_)
            | Method::Conformal(_)
            | Method::PowellSabin(_)
            | Method::TSpline(_) => Err(RunError::Task {
                task: "data over time",
                method: case.method.name(),
            }),
        }
    }

    /// Factors what serves the evaluation of all splines, whatever their knots, and returns whether
    /// there is such a thing.
    ///
    /// Least-squares meshes have nothing of the kind, as their controls are in the matrix; splines
    /// with creases neither.
    pub(super) fn factor(&self) -> Result<bool, RunError> {
        match self {
            Self::Biharmonic { space, .. } if space.creases().is_empty() => {
                space.poisson()?;
                Ok(true)
            }
            Self::Biharmonic { .. } | Self::LsMesh { .. } => Ok(false),
        }
    }

    /// Fits `data`.
    pub(super) fn fit(
        &self,
        data: VertexData<'_>,
        observer: &mut Observer<'_>,
    ) -> Result<Fitted, RunError> {
        match self {
            Self::Biharmonic {
                space,
                options,
                weights,
            } => {
                let weights = weights.as_deref();
                let target = biharmonic::Target { data, weights };
                let fit = biharmonic::fit_in(space, target, options, observer)?;
                Ok(Fitted::of_biharmonic(fit, options))
            }
            Self::LsMesh { space, options } => {
                let fit = ls_mesh::fit_in(space, data, options, observer)?;
                Ok(Fitted::of_ls_mesh(fit, options))
            }
        }
    }

    /// Returns the values of a stored spline at all vertices: two solves with the Laplacian that
    /// [`Self::factor`] factored, or for a least-squares mesh a factorisation and a solve.
    ///
    /// # Panics
    /// If the spline is of another method.
    pub(super) fn evaluate(&self, stored: &StoredSpline) -> Result<Vec<f64>, SplineFileError> {
        match (self, stored) {
            (Self::Biharmonic { space, .. }, StoredSpline::Biharmonic(stored)) => {
                Ok(stored.restore_in(space)?.vertex_values()?)
            }
            (
                Self::LsMesh { space, .. },
                StoredSpline::LsMesh {
                    dimension,
                    controls,
                    control_values,
                    constraints,
                },
            ) => {
                let spline = ls_mesh::LsMesh::from_parts_in(
                    space,
                    *constraints,
                    *dimension,
                    controls.clone(),
                    control_values.clone(),
                )?;
                Ok(spline.vertex_values().to_vec())
            }
            _ => unreachable!("a spline is evaluated by the method that fitted it"),
        }
    }
}
