//! Biharmonic B-splines with optimised knots on triangle meshes.
//!
//! A biharmonic B-spline over the vertices of a mesh is `f = a + Σ wᵢ φᵢ`, where `φᵢ` is the Green's
//! function of the bi-Laplacian `B = L A⁻¹ L` at knot `i` and the coefficients sum to zero. Knots may
//! lie anywhere, follow no pattern, and need no parameterisation; the surface may have any genus, and
//! boundaries.
//!
//! [`fit`] chooses the knots (or takes given ones) and fits the spline to data at the vertices.
//! [`BiharmonicSpline`] holds the result and evaluates it at the vertices, on planar subdivisions, and
//! at any surface point.
//!
//! # Notation
//! `n` vertices, `T` the knots, `Z` all other vertices, `S` the data (n × d), `f` the spline at the
//! vertices. A function is a spline with these knots exactly if `(B f)_Z = 0`, so that it is
//! determined by its values `p` at the knots: `f = H p` with `f_T = p`, `f_Z = -B_ZZ⁻¹ B_ZT p`.
//! This parametrisation is what makes fitting well conditioned, where Green's coefficients are not.
//!
//! # Reference
//! [Hou2017] §4, §5, §6.

mod algebra;
mod creases;
mod decompose;
mod error;
mod explicit;
mod fit;
mod gram;
mod interpolate;
mod knot_values;
mod options;
mod points;
mod rings;
mod select;
mod space;
mod spline;
mod subdivision;
mod target;
#[cfg(test)]
mod tests;

pub use algebra::{CombineError, KnotError, Removal, combine};
pub use creases::Creases;
pub use decompose::{DecomposeError, Decomposition, Layer, decompose};
pub use error::FitError;
pub use explicit::{
    BasisKind, ExplicitBasis, ExplicitError, LocalFunctions, Locality, SparseColumns,
};
pub use fit::{Fit, Report, fit, fit_in};
pub use interpolate::interpolate;
pub use options::{CreaseChoice, Effort, KnotChoice, Laplacian, Options, Selection};
pub use select::Trial;
pub use space::{Bilaplacian, Space};
pub use spline::{BiharmonicSpline, Form, PartsError};
pub use subdivision::{Extension, Scheme};
pub use target::Target;
