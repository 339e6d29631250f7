//! T-splines over conformal nets of surfaces of any genus.
//!
//! The horizontal trajectories of a holomorphic 1-form with integer periods are closed, but for those
//! through its zeros: these cut the surface into cylinders, glued along their borders by translations.
//! A [`CylinderComplex`] holds that in exact integers; a T-mesh of boxes on it carries one cubic T-spline
//! without a seam.
//!
//! ```
//! use msplines_common::mesh::shapes;
//! use msplines_common::progress::unobserved;
//! use msplines_t_spline::{Domain, DomainOptions, FitOptions, Sampling, Stop, TSplineSurface};
//!
//! let mesh = shapes::torus(1.0, 0.4, 500);
//! let domain = Domain::of_surface(&mesh, &DomainOptions::default(), &mut unobserved())?;
//! let options = FitOptions { stop: Stop::ControlPoints(150), ..FitOptions::default() };
//! let sampling = Sampling::default();
//! let fitted = TSplineSurface::fit(domain, &mesh, &sampling, &options, &mut unobserved())?;
//! assert_eq!(fitted.report.unknowns, fitted.surface.spline().control().len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Reference
//! [He2006].

pub mod blend;
pub mod caps;
pub mod cells;
pub mod complex;
pub mod domain;
pub mod edit;
pub mod fit;
pub mod measure;
pub mod options;
pub mod parts;
#[cfg(test)]
mod samples;
mod sampling;
pub mod space;
pub mod spline;
pub mod support;
pub mod surface;
mod tessellate;
pub mod tmesh;

pub use complex::CylinderComplex;
pub use domain::{Domain, DomainOptions};
pub use fit::{Fit, FitError, FitOptions, FittedSurface, Sample, Sampling, Stop, fit};
pub use parts::SurfaceParts;
pub use space::TSplineSpace;
pub use spline::TSpline;
pub use surface::TSplineSurface;
pub use tmesh::TMesh;
