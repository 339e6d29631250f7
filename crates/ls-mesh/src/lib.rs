//! Least-squares meshes: surfaces from connectivity and a few control vertices.
//!
//! The vertices minimise `‖L x‖²`, the graph Laplacian's deviation of every vertex from the mean of
//! its neighbours, while control vertices stay at (or near) their data. Only connectivity enters, so
//! that the controls and the faces are the whole surface. A least-squares mesh has values at
//! vertices only; between them it is linear on the faces.
//!
//! ```
//! use msplines_common::evaluate::VertexData;
//! use msplines_common::mesh::TriangleMesh;
//! use msplines_common::{Point3, progress::unobserved};
//! use msplines_ls_mesh::{ControlChoice, Options, fit};
//!
//! let positions = [[1., 1., 1.], [1., -1., -1.], [-1., 1., -1.], [-1., -1., 1.]].map(Point3::from);
//! let faces = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
//! let mesh = TriangleMesh::build(positions.to_vec(), faces)?;
//! let values: Vec<f64> = positions.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
//! let data = VertexData { dimension: 3, values: &values };
//! let options = Options { controls: ControlChoice::Selected { count: 2 }, ..Options::default() };
//! let fit = fit(&mesh, data, &options, &mut unobserved())?;
//! assert_eq!(fit.spline.controls().len(), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Reference
//! [Sorkine2004]; [Hou2017] Eq. (14), Eq. (15), §8.1.

mod error;
mod fit;
mod frame;
mod options;
mod select;
mod space;
mod spline;
mod system;
#[cfg(test)]
mod tests;

pub use error::FitError;
pub use fit::{Fit, Report, fit, fit_in};
pub use options::{Constraints, ControlChoice, Options, Selection};
pub use space::Space;
pub use spline::LsMesh;
