//! Manifold surfaces over quad meshes, by sparse representations on charts that agree.
//!
//! Every vertex of a control mesh has a chart; on it a surface is a short combination of many
//! possible functions, smooth ones and ones with creases, and the surface blends the charts with
//! weights that sum to one. [`fit()`] approximates the Catmull-Clark surface of the control mesh, creases
//! included, or any other points of its faces.
//!
//! ```
//! use msplines_common::mesh::polygon::{Rules, Sharpness};
//! use msplines_common::mesh::shapes::box_surface;
//! use msplines_common::progress::unobserved;
//! use msplines_sparse_manifold::{Options, dense_error, fit};
//!
//! let mesh = box_surface([1, 2, 3]);
//! let rules = Rules::default();
//! let sharpness = Sharpness::smooth(mesh.topology(), rules);
//! let fit = fit(&mesh, &sharpness, rules, &Options::default(), &mut unobserved())?;
//! assert!(dense_error(&fit.spline, &sharpness, rules).rms < 5e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Reference
//! [Wang2016].

mod cones;
mod dictionary;
mod domain;
mod error;
mod fit;
mod jet;
mod local;
mod measure;
pub mod network;
mod numbers;
mod observations;
mod options;
pub mod pursuit;
mod session;
mod spline;
mod tessellate;
#[cfg(test)]
mod tests;
mod weight;

pub use dictionary::{Atom, DEGREE, Dictionary, DictionaryKind};
pub use domain::{Domain, Star, corner_coordinates, face_coordinates, sharp_charts};
pub use error::{FitError, SplineError};
pub use fit::{Fit, Report, fit, fit_to};
pub use local::{ChartPoint, LocalError, LocalFunction, fit_local};
pub use measure::{DenseError, LimitSurface, ShapeError, dense_error};
pub use observations::{LimitGrid, Observations};
pub use options::{Acceptance, Components, Gate, Local, Options, SweepOrder};
pub use session::{Change, EditError, Session};
pub use spline::{Geometry, SparseManifold};
pub use tessellate::{Tessellation, Tessellator, grid_points};
