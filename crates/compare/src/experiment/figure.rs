//! What is drawn of an experiment: figures of surfaces, and plots of its figures.

use serde::{Deserialize, Serialize};

/// A figure: panels side by side.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Figure {
    /// Unique among the figures and plots of its experiment.
    pub id: String,
    /// What is shown.
    pub caption: String,
    /// What a reader should look for.
    #[serde(default)]
    pub look_for: String,
    /// Panels in one line on a wide screen.
    #[serde(default = "default_columns")]
    pub columns: usize,
    /// The panels.
    #[serde(rename = "panel")]
    pub panels: Vec<Panel>,
}

fn default_columns() -> usize {
    3
}

/// One picture of a figure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Panel {
    /// The row whose surface is shown.
    pub row: String,
    /// What is shown of it.
    pub show: Show,
    /// Which frame of a row about an animation; its last shown one where absent.
    pub frame: Option<usize>,
    /// What stands below it; the label of the row where absent.
    pub label: Option<String>,
    /// Which edges are drawn.
    #[serde(default)]
    pub edges: Edges,
    /// Direction it is seen from; that of the model where absent.
    pub view: Option<ViewHint>,
    /// A part that is magnified in a corner.
    pub callout: Option<Callout>,
}

/// What a panel shows of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Show {
    /// The input mesh, shaded, in its colours where the data are colours.
    Input,
    /// The spline, shaded, in its colours where the data are colours.
    Spline,
    /// The distance between spline and data at every vertex, cold to warm, on the spline.
    Error,
    /// The knots or control vertices on the input mesh.
    Knots,
}

/// Edges in a panel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Edges {
    /// None.
    #[default]
    None,
    /// The edges of the domain mesh, or their images on the spline.
    Domain,
}

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

/// A plot: one point per row and one series per method, or per `series` of the rows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plot {
    /// Unique among the figures and plots of its experiment.
    pub id: String,
    /// What is shown.
    pub caption: String,
    /// What a reader should look for.
    #[serde(default)]
    pub look_for: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The rows, all where empty.
    #[serde(default)]
    pub rows: Vec<String>,
}

/// A quantity along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// Number of knots or control vertices.
    Knots,
    /// Free real coefficients.
    Dofs,
    /// Mean error at the vertices.
    Error,
    /// Root mean square of the two-sided distance.
    Distance,
    /// Peak signal-to-noise ratio.
    Psnr,
    /// Wall time from start to last output.
    Seconds,
    /// Seconds since the row started, along its history; only with [`Axis::Objective`].
    Elapsed,
    /// What the optimisation minimises, along its history; only with [`Axis::Elapsed`].
    Objective,
}

impl Axis {
    /// Returns whether this is a quantity along the history of a row.
    #[must_use]
    pub fn is_history(self) -> bool {
        matches!(self, Self::Elapsed | Self::Objective)
    }

    /// Returns what stands along the axis.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Knots => "knots or control vertices",
            Self::Dofs => "free coefficients",
            Self::Error => "mean error, % of diagonal",
            Self::Distance => "rms distance, % of diagonal",
            Self::Psnr => "PSNR per channel, dB",
            Self::Seconds => "time from start to end, s",
            Self::Elapsed => "seconds since the start",
            Self::Objective => "rms error, % of diagonal",
        }
    }
}
