//! Powell-Sabin splines over planar triangulations and over surfaces of any genus.
pub mod domain;
mod edit;
pub mod element;
pub mod energy;
mod error;
mod fit;
mod normals;
mod options;
mod spline;
#[cfg(test)]
mod tests;
mod triangles;
mod vector;
pub use domain::{DomainError, FlatDomain};
pub use edit::{NewVertex, Target};
pub use error::{EditError, FitError, NormalError, SplineError};
pub use fit::{Fit, Report, VertexData, Warning, fit};
pub use normals::estimate_normals;
pub use options::{Fairness, Options, Orientation};
pub use spline::{Basis, PowellSabinSpline, Tessellation};
pub use triangles::{PowellSabinTriangle, powell_sabin_triangles};
