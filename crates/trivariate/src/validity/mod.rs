//! Whether a solid folds: certificates that hold on the whole closed cube.
//!
//! [`certify`] shows that the determinant of the first derivatives is positive everywhere: the solid is
//! an immersion. [`boundary`] shows that no two points of the boundary coincide. Both together
//! make the map one-to-one: a local homeomorphism of the cube that is one-to-one on its boundary is one
//! on the cube, as every point is then covered as often as the boundary winds around it.

mod boundary;
mod certificate;
mod determinant;

pub use boundary::{BoundaryOptions, BoundaryReport, BoundaryVerdict, Contact, boundary};
pub(crate) use certificate::uncertified;
pub use certificate::{Certificate, Options, Refuted, certify};
pub(crate) use determinant::{COEFFICIENTS, Determinants, LANES};
