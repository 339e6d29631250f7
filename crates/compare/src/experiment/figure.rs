//! What is drawn of an experiment: figures of surfaces, and plots of its figures.

use serde::{Deserialize, Serialize};

use super::{Callout, Close, FieldColours, FieldScale, FieldSurface, ViewHint};

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
    /// Which of the surfaces on the way, from 0; only with [`Show::Level`], which needs it.
    pub level: Option<usize>,
    /// The attribute of its stored surface that is shown; only with [`Show::Field`].
    pub field: Option<String>,
    /// The surface that carries it, the spline's own where absent; only with [`Show::Field`].
    pub on: Option<FieldSurface>,
    /// What that attribute looks like, [`FieldColours::Sequential`] where absent; only with
    /// [`Show::Field`].
    pub colours: Option<FieldColours>,
    /// Whose numbers its colours span, [`FieldScale::Shared`] where absent; only with
    /// [`Show::Field`] and numbers.
    pub scale: Option<FieldScale>,
    /// Share of the vertices whose numbers the colours span, all where absent: a field with
    /// singularities would be of one colour; only with [`Show::Field`] and numbers.
    pub span: Option<f64>,
    /// Whether the knots, control vertices or zeros are drawn on top, as [`Show::Knots`] does.
    #[serde(default)]
    pub knots: bool,
    /// What stands below it; the label of the row where absent.
    pub label: Option<String>,
    /// Which edges are drawn.
    #[serde(default)]
    pub edges: Edges,
    /// Direction it is seen from; that of the model where absent.
    pub view: Option<ViewHint>,
    /// A part that fills the picture; all of the surface where absent.
    pub close: Option<Close>,
    /// A part that is magnified in a corner.
    pub callout: Option<Callout>,
}

/// What a panel shows of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Show {
    /// The input mesh, shaded, in its colours where the data are colours.
    Input,
    /// The spline, shaded, in its colours where the data are colours. Edges of a T-spline are those of its
    /// T-mesh.
    Spline,
    /// The distance between spline and data at every vertex, cold to warm, on the spline.
    Error,
    /// The knots or control vertices on the input mesh.
    Knots,
    /// An attribute of the stored surface as colours on it.
    Field,
    /// The surface that a sparse manifold approximates, shaded.
    Target,
    /// A checkerboard on the surface of a conformal atlas, or of the form of a T-spline.
    Checkers,
    /// A Powell-Sabin spline with its control triangles, which let the surface shine through.
    ControlTriangles,
    /// The domain of a Powell-Sabin spline with its faces split into six.
    Refinement,
    /// Two overlapping charts of a Powell-Sabin spline, laid out in the plane.
    Charts,
    /// Stripes of equal slope on a spline whose exact normals are known: they bend where curvature
    /// jumps, and break where normals do.
    Isophotes,
    /// The cylinders of a T-spline in colours, with the critical graph; edges are those of its first
    /// T-mesh.
    Cylinders,
    /// The same laid out in the plane.
    Rectangles,
    /// A T-spline with its control points; edges join them.
    ControlPoints,
    /// A T-spline on the way to the last one; edges are those of its T-mesh.
    Level,
}

impl Panel {
    /// Returns how its field is coloured.
    #[must_use]
    pub fn field_colours(&self) -> FieldColours {
        self.colours.unwrap_or_default()
    }

    /// Returns which fields contradict each other, and what to write.
    pub(super) fn problem(&self) -> Option<&'static str> {
        if let Some(problem) = self.close.as_ref().and_then(Close::problem) {
            return Some(problem);
        }
        if (self.show == Show::Level) != self.level.is_some() {
            return Some("`level` goes with `show = \"level\"`, which needs it: 0 is the first");
        }
        let says_how = self.field.is_some()
            || self.on.is_some()
            || self.colours.is_some()
            || self.scale.is_some()
            || self.span.is_some();
        let has_numbers = matches!(
            self.field_colours(),
            FieldColours::Sequential | FieldColours::Diverging
        );
        match (self.show, self.field_colours()) {
            (Show::Field, FieldColours::Values) if self.field.is_some() => {
                Some("`colours = \"values\"` shows `red`, `green` and `blue`; leave out `field`")
            }
            (Show::Field, FieldColours::Values) if self.scale.is_none() && self.span.is_none() => {
                None
            }
            (Show::Field, _) if self.scale.is_some() && !has_numbers => {
                Some("cells and values have no `scale`; leave it out")
            }
            (Show::Field, _) if self.span.is_some() && !has_numbers => {
                Some("cells and values have no `span`; leave it out")
            }
            (Show::Field, _) if self.span.is_some_and(|span| !(span > 0.0 && span <= 1.0)) => {
                Some("`span` is a share of the vertices, above 0 and at most 1")
            }
            (Show::Field, _) if self.field.is_none() => {
                Some("name the attribute of its surface as `field`")
            }
            (Show::Field, _) => None,
            _ if says_how => {
                Some("`field`, `on`, `colours`, `scale` and `span` go with `show = \"field\"` only")
            }
            _ => None,
        }
    }
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

/// A plot: one point per row and one series per [`Row::series`](super::Row::series), or one series
/// per row along its history.
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

#[cfg(test)]
mod tests {
    use super::super::tests::parse_with;

    #[test]
    fn panels_of_fields_are_refused_with_file_figure_and_panel() {
        let parse = |fields: &str| {
            let first = "[[figure.panel]]\nrow = \"a\"\nshow = \"spline\"\nknots = true\n";
            let text = format!(
                "[[figure]]\nid = \"f\"\ncaption = \"\"\n{first}[[figure.panel]]\nrow = \"a\"\n{fields}\n"
            );
            parse_with("", &text)
        };
        let show = "show = \"field\"\n";
        for good in [
            "field = \"u\"",
            "field = \"u\"\ncolours = \"diverging\"\nscale = \"own\"",
            "field = \"u\"\ncolours = \"cells\"\nknots = true",
            "colours = \"values\"",
        ] {
            parse(&format!("{show}{good}")).expect(good);
        }
        let bad = [
            (
                "show = \"spline\"\nfield = \"u\"",
                "go with `show = \"field\"` only",
            ),
            (
                "show = \"error\"\nscale = \"own\"",
                "go with `show = \"field\"` only",
            ),
            ("show = \"field\"", "name the attribute"),
            (
                "show = \"field\"\ncolours = \"cells\"",
                "name the attribute",
            ),
            (
                "show = \"field\"\nfield = \"u\"\ncolours = \"values\"",
                "leave out `field`",
            ),
            (
                "show = \"field\"\ncolours = \"values\"\nscale = \"own\"",
                "no `scale`",
            ),
            (
                "show = \"field\"\nfield = \"u\"\ncolours = \"cells\"\nscale = \"shared\"",
                "no `scale`",
            ),
        ];
        for (fields, message) in bad {
            let error = parse(fields).expect_err(fields).to_string();
            let place = "p/i.toml: figure `f`: panel 2 (row `a`): ";
            assert!(
                error.starts_with(place) && error.contains(message),
                "{error}"
            );
        }
    }

    #[test]
    fn unknown_colours_and_spans_that_are_no_share_are_refused() {
        let parse = |fields: &str| {
            let text = format!(
                "[[figure]]\nid = \"f\"\ncaption = \"\"\n[[figure.panel]]\nrow = \"a\"\nshow = \"field\"\nfield = \"u\"\n{fields}\n"
            );
            parse_with("", &text)
        };
        parse("span = 0.98").expect("a share");
        for (fields, message) in [
            ("colours = \"cells\"\nspan = 0.9", "no `span`"),
            ("span = 1.5", "at most 1"),
        ] {
            let error = parse(fields).expect_err(fields).to_string();
            assert!(error.contains(message), "{error}");
        }
        let error = parse("colours = \"rainbow\"");
        let text = error.expect_err("no such colours").to_string();
        assert!(
            text.contains("p/i.toml") && text.contains("rainbow"),
            "{text}"
        );
    }
}
