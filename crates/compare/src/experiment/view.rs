//! From where surfaces are seen, and what of them.

use serde::{Deserialize, Serialize};

/// Where a surface is seen from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ViewHint {
    /// Axis that points up.
    pub up: UpAxis,
    /// Degrees around that axis.
    pub azimuth: f64,
    /// Degrees above the horizon.
    pub elevation: f64,
}

impl Default for ViewHint {
    fn default() -> Self {
        Self {
            up: UpAxis::Y,
            azimuth: 25.0,
            elevation: 20.0,
        }
    }
}

/// An axis that points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum UpAxis {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third.
    Z,
}

/// A magnified part of a picture; lengths are fractions of its side.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Callout {
    /// Middle of the part, from the left and from the top.
    pub at: [f64; 2],
    /// Side of the part.
    pub size: f64,
    /// Where the magnified part goes.
    #[serde(default)]
    pub corner: Corner,
}

/// A corner of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Corner {
    /// At the top, left.
    TopLeft,
    /// At the top, right.
    TopRight,
    /// At the bottom, left.
    BottomLeft,
    /// At the bottom, right.
    #[default]
    BottomRight,
}

/// The part of a surface around a place: give either `mark` or `at`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Close {
    /// A zero, an edited vertex or a knot of the row, counted from 0.
    pub mark: Option<usize>,
    /// A place, as fractions of the sides of the bounding box.
    pub at: Option<[f64; 3]>,
    /// How far around it one sees, over the diagonal.
    pub radius: f64,
}

impl Close {
    /// Returns what is wrong with it.
    pub(super) fn problem(&self) -> Option<&'static str> {
        if self.mark.is_some() == self.at.is_some() {
            return Some("`close` needs either a `mark` or a place `at`");
        }
        let good = self.radius > 0.0 && self.radius.is_finite();
        (!good).then_some("`close` needs a positive `radius`, over the diagonal")
    }
}
