//! Powell-Sabin splines over planar triangulations and over surfaces of any genus.
//!
//! A [`FlatDomain`] is a triangle mesh with a flat vector along every edge, such as the integrals of a
//! holomorphic 1-form. Every face is split into six, and value and gradient at the vertices make one
//! C1 surface of quadratic pieces. [`fit()`] finds the fairest one through given positions and normals;
//! [`Basis`] is its B-spline form with control triangles; edits change it locally.
//!
//! ```
//! use msplines_common::progress::unobserved;
//! use msplines_common::{Point3, Vector3};
//! use msplines_powell_sabin::{FlatDomain, Options, VertexCondition, fit};
//!
//! let plane = [[0., 0.], [1., 0.], [1., 1.], [0., 1.], [0.4, 0.6]];
//! let domain = FlatDomain::planar(&plane)?;
//! // A bump: the vertex inside is lifted, all normals are upright.
//! let conditions: Vec<VertexCondition> = (0..5)
//!     .map(|v| VertexCondition::Interpolate {
//!         position: Point3::new(plane[v][0], plane[v][1], if v == 4 { 0.2 } else { 0.0 }),
//!         normal: Vector3::z(),
//!     })
//!     .collect();
//! let fit = fit(&domain, &conditions, &Options::default(), &mut unobserved())?;
//! assert_eq!(fit.report.unknowns, 4 * 5);
//! assert_eq!(fit.spline.tessellate(8)?.faces.len(), 4 * 64);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Over a whole surface of any genus, laid out by an affine atlas, [`fit_surface`] does the same and fills
//! the holes at the zeros of the form:
//!
//! ```
//! use msplines_common::mesh::shapes;
//! use msplines_common::progress::unobserved;
//! use msplines_conformal::{Atlas, AtlasOptions};
//! use msplines_powell_sabin::{SurfaceOptions, VertexCondition, estimate_normals, fit_surface};
//!
//! let atlas = Atlas::of_surface(&shapes::genus(2, 2500), &AtlasOptions::default(), &mut unobserved())?.atlas;
//! let conditions = VertexCondition::of_mesh(atlas.mesh(), &estimate_normals(atlas.mesh())?);
//! let fit = fit_surface(&atlas, &conditions, &SurfaceOptions::default(), &mut unobserved())?;
//! let checks = fit.spline.measure(&conditions, 1, 1000);
//! assert!(checks.position_max < 1e-14 && checks.seam_max < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Reference
//! [He2005]; [PowellSabin1977]; [Dierckx1997].

pub mod domain;
mod edit;
pub mod element;
pub mod energy;
mod error;
mod fit;
mod normals;
mod options;
mod spline;
pub mod surface;
mod tangent;
#[cfg(test)]
mod tests;
mod triangles;
mod vector;
pub use domain::{DomainError, FlatDomain};
pub use edit::{NewVertex, Target};
pub use error::{EditError, FitError, NormalError, SplineError};
pub use fit::{Fit, Report, VertexCondition, Warning, fit};
pub use normals::estimate_normals;
pub use options::{Fairness, Options, Orientation};
pub use spline::{Basis, PowellSabinSpline, Tessellation};
pub use surface::{
    Fill, PowellSabinSurface, SurfaceError, SurfaceFit, SurfaceOptions, fit_surface,
};
pub use triangles::{PowellSabinTriangle, powell_sabin_triangles};
