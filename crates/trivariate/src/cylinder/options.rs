//! What can be chosen about a cylindrical solid.

use serde::{Deserialize, Serialize};

use super::error::CylinderError;
use crate::error::FitError;
use crate::fit::multilevel;
use crate::spline::MOST_SPANS;

/// Most samples of a solid: their positions take 1.2 GB.
pub const MOST_SAMPLES: usize = 50_000_000;

/// Options of [`map`](super::map()) and [`fit`](super::fit()).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Where the axis begins and ends on the surface.
    pub poles: Poles,
    /// Level loops between the poles, about evenly spaced along the axis. Multilevel B-splines need
    /// several for each span, else they make stairs.
    pub loops: usize,
    /// Points of a loop, evenly spaced.
    pub meridians: usize,
    /// Samples from the axis to the surface, both included.
    pub radii: usize,
    /// What becomes of the surface beyond the outermost loops.
    pub ends: Ends,
    /// Standard deviation of the weights with which points of the axis are averaged, against its
    /// length.
    pub axis_smoothing: f64,
    /// How the spline is fitted.
    pub approximation: Approximation,
}

/// The two vertices of the surface that the latitude runs between.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Poles {
    /// The vertices nearest to where the longest principal axis of the surface, through its centre,
    /// enters the surface first and leaves it last; the extreme ones if it misses the surface.
    #[default]
    Pierced,
    /// The extreme vertices along that axis.
    Extreme,
    /// These vertices, latitude 0 first.
    Given([u32; 2]),
}

/// What becomes of the surface beyond the outermost loops.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ends {
    /// Latitudes 0 and 1 are the poles: the whole solid is covered.
    #[default]
    Collapsed,
    /// Latitudes 0 and 1 are the outermost loops: the caps beyond them are left out.
    Stretched,
}

/// How the spline is fitted to the samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Approximation {
    /// By multilevel B-splines whose lattices wrap around in longitude.
    Multilevel(multilevel::Options),
    /// By least squares.
    LeastSquares {
        /// Spans in each direction.
        spans: usize,
        /// Weight of the squared second differences of control points, against the mean squared
        /// weight of a control point; positive.
        smoothing: f64,
    },
}

impl Options {
    /// The settings of the comparison in the paper: multilevel B-splines from 2 to 64 spans. It
    /// does not say how many samples they had.
    ///
    /// # Reference
    /// [Kim2014] §6, Table 1.
    pub const PAPER: Self = Self {
        poles: Poles::Pierced,
        loops: 256,
        meridians: 256,
        radii: 65,
        ends: Ends::Collapsed,
        axis_smoothing: 0.05,
        approximation: Approximation::Multilevel(multilevel::Options::PAPER),
    };

    pub(super) fn check(&self) -> Result<(), CylinderError> {
        for (name, value, least) in [
            ("loops", self.loops, 2),
            ("meridians", self.meridians, 3),
            ("radii", self.radii, 2),
        ] {
            if !(least..=MOST_SAMPLES).contains(&value) {
                return Err(CylinderError::Count { name, value, least });
            }
        }
        if !(0.0..=0.5).contains(&self.axis_smoothing) {
            let (name, value, range) = ("axis_smoothing", self.axis_smoothing, "from 0 to 0.5");
            return Err(FitError::Number { name, value, range }.into());
        }
        let rows = self.loops + 2;
        let samples = rows.saturating_mul(self.meridians.saturating_mul(self.radii));
        if samples > MOST_SAMPLES {
            return Err(CylinderError::TooManySamples { samples });
        }
        Ok(())
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            loops: 200,
            meridians: 192,
            radii: 33,
            approximation: Approximation::LeastSquares {
                spans: 16,
                smoothing: 1e-5,
            },
            ..Self::PAPER
        }
    }
}

impl Approximation {
    pub(super) fn check(&self) -> Result<(), FitError> {
        let (coarsest, finest, name, value, valid) = match *self {
            Self::Multilevel(multilevel::Options {
                coarsest,
                finest,
                stop_rms,
            }) => (coarsest, finest, "stop_rms", stop_rms, stop_rms >= 0.0),
            Self::LeastSquares { spans, smoothing } => {
                (spans, spans, "smoothing", smoothing, smoothing > 0.0)
            }
        };
        let whole = coarsest > 0 && finest.is_multiple_of(coarsest);
        if !whole || !(finest / coarsest).is_power_of_two() || finest > MOST_SPANS {
            return Err(FitError::Levels { coarsest, finest });
        }
        if !(valid && value.is_finite()) {
            let range = match self {
                Self::Multilevel(_) => "of at least 0",
                Self::LeastSquares { .. } => "above 0",
            };
            return Err(FitError::Number { name, value, range });
        }
        Ok(())
    }
}
