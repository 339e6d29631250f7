//! Fits to whole surfaces.

use std::sync::Arc;

use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::Observer;

use super::{FitError, FitOptions, FitReport, Level, Sampling, fit};
use crate::domain::Domain;
use crate::surface::TSplineSurface;

/// A surface over the mesh that it was fitted to, and how it was found.
#[derive(Clone, Debug)]
pub struct FittedSurface {
    /// The surface.
    pub surface: TSplineSurface,
    /// The splines of all surfaces on the way, the last one included.
    pub levels: Vec<Level>,
    /// How the fit ended.
    pub report: FitReport,
}

impl TSplineSurface {
    /// Fits a spline over the cylinders of a domain to `surface`, the mesh that the domain was made of, and
    /// lays it over the mesh of the domain, whose vertices go where the fit has moved them.
    ///
    /// The samples are those of [`Sampling::samples`]; `observer` and cost are those of [`fit`].
    ///
    /// # Errors
    /// Samplings, budgets or options that are no task; a domain that carries no T-mesh.
    ///
    /// # Panics
    /// If `surface` does not have the vertices that are poles of the domain: those of its own mesh are.
    pub fn fit(
        domain: Domain,
        surface: &TriangleMesh,
        sampling: &Sampling,
        options: &FitOptions,
        observer: &mut Observer<'_>,
    ) -> Result<FittedSurface, FitError> {
        let samples = sampling.samples(&domain, surface, options.stop)?;
        let complex = Arc::new(domain.complex().clone());
        let found = fit(&complex, &samples, options, observer)?;
        // The samples begin with the vertices.
        let vertices = &found.samples[..domain.mesh().vertex_count()];
        let shifts = vertices.iter().map(|s| s.shift).collect();
        Ok(FittedSurface {
            surface: Self::new(domain, shifts, found.spline),
            levels: found.levels,
            report: found.report,
        })
    }
}
