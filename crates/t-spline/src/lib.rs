//! T-splines over conformal nets of surfaces of any genus.
//!
//! The horizontal trajectories of a holomorphic 1-form with integer periods are closed, but for those
//! through its zeros: these cut the surface into cylinders, glued along their borders by translations.
//! A [`CylinderComplex`] holds that in exact integers; a T-mesh of boxes on it carries one cubic T-spline
//! without a seam.
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
pub use fit::{Fit, FitError, FitOptions, Sample, Stop, fit};
pub use parts::SurfaceParts;
pub use space::TSplineSpace;
pub use spline::TSpline;
pub use surface::TSplineSurface;
pub use tmesh::TMesh;
