//! Solids as trivariate B-splines over the unit cube.
//!
//! A solid is given by its closed surface or by tetrahedra. [`domain::mesher`] fills a surface with
//! tetrahedra whose dihedral angles are bounded; [`domain::boundary`] maps the surface to that of the
//! cube, [`domain::volume`] the solid to the cube, without folds. [`solid::fit`] is all of it in one call.
//! [`cylinder`] is the method that all this is measured against: solids over a cylinder.
//!
//! Samples of a solid, points with parameters in the unit cube, become a uniform cubic tensor product:
//! by multilevel B-splines as the paper has it ([`fit::multilevel`]), by least squares with
//! smoothing ([`fit::least_squares`]), or by least squares whose result is proved not to fold
//! ([`fit::certified`]). [`validity`] proves that the determinant is positive on the whole closed cube and
//! that the boundary does not meet itself; [`measure`] counts degenerate finite elements and measures
//! their distortion; a [`TrivariateSpline`] is evaluated, refined, deformed and inverted.
//!
//! ```
//! use msplines_common::Point3;
//! use msplines_common::progress::unobserved;
//! use msplines_trivariate::fit::certified;
//! use msplines_trivariate::{VolumeSamples, fit::least_squares};
//!
//! let step = |i: usize| i as f64 / 9.0;
//! let parameters: Vec<[f64; 3]> =
//!     (0..1000).map(|at| [step(at % 10), step(at / 10 % 10), step(at / 100)]).collect();
//! let bend = |[u, v, w]: [f64; 3]| Point3::new(u, v + 0.3 * u * u, w - 0.2 * u * v);
//! let points = parameters.iter().map(|&at| bend(at)).collect();
//! let samples = VolumeSamples::build(parameters, points)?;
//! let options = certified::Options {
//!     least_squares: least_squares::Options { finest: 4, ..Default::default() },
//!     ..Default::default()
//! };
//! let fit = certified::fit(&samples, &options, &mut unobserved())?;
//! assert!(fit.certificate.holds());
//! assert!((fit.spline.position([0.5; 3]) - bend([0.5; 3])).norm() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Reference
//! [Kim2014].

pub mod cylinder;
pub mod domain;
mod error;
pub mod export;
pub mod fit;
pub mod measure;
pub mod options;
mod samples;
pub mod solid;
pub mod spline;
#[cfg(test)]
mod tests;
pub mod validity;

pub use error::FitError;
pub use samples::VolumeSamples;
pub use spline::TrivariateSpline;
