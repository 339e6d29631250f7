//! How numbers on a surface are shown.

use serde::{Deserialize, Serialize};

/// A surface that carries fields.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FieldSurface {
    /// The stored one.
    #[default]
    Spline,
    /// The input of a solid.
    Input,
    /// A solid cut open.
    Cut,
}

impl FieldSurface {
    /// Returns its name in files of a row.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Spline => "spline",
            Self::Input => "input",
            Self::Cut => "cut",
        }
    }
}

/// What the numbers of a field look like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FieldColours {
    /// From the lowest to the highest.
    #[default]
    Sequential,
    /// Signed: the two signs apart, zero in the middle.
    Diverging,
    /// Whole numbers that name cells; cells that touch have different colours, and what is
    /// negative is in no cell.
    Cells,
    /// The attributes `red`, `green` and `blue` as they are.
    Values,
}

/// Whose numbers the colours of a field span.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FieldScale {
    /// Those of all panels of the figure that show the field of this name.
    #[default]
    Shared,
    /// Those of the panel alone.
    Own,
}
