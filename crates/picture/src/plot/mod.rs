//! Plots as SVG: curves over an axis, and horizontal bars.
//!
//! An SVG here is one string that needs nothing else: text is set in whatever sans-serif font the
//! reader has, all of it escaped. Colours are those of Okabe and Ito, which most colour-blind
//! readers can tell apart, and every series has a marker of its own shape as well.
//!
//! ```
//! use msplines_picture::plot::{Plot, Quantity, Series};
//!
//! let errors = [[100.0, 2e-2], [200.0, 5e-3], [400.0, 1.2e-3]];
//! let plot = Plot {
//!     x: Quantity::logarithmic("knots"),
//!     y: Quantity::logarithmic("error / diagonal"),
//!     series: vec![Series::new("B-spline", &errors)],
//!     ..Plot::default()
//! };
//! assert!(plot.to_svg()?.starts_with("<svg"));
//! # Ok::<(), msplines_picture::PictureError>(())
//! ```

mod bars;
mod curves;
mod sheet;
mod track;

pub use bars::{Bar, Bars};
pub use curves::{Highlight, Look, Note, Plot, Series};

use crate::Spacing;

/// What is measured along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quantity<'a> {
    /// Its name and unit; may be empty.
    pub label: &'a str,
    /// Whether equal steps are equal differences or equal ratios.
    pub spacing: Spacing,
}

impl<'a> Quantity<'a> {
    /// Returns a quantity on a linear axis.
    #[must_use]
    pub const fn linear(label: &'a str) -> Self {
        let spacing = Spacing::Linear;
        Self { label, spacing }
    }

    /// Returns a quantity on a logarithmic axis; all values must be positive.
    #[must_use]
    pub const fn logarithmic(label: &'a str) -> Self {
        let spacing = Spacing::Logarithmic;
        Self { label, spacing }
    }
}
