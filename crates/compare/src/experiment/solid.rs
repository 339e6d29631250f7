//! Options of trivariate splines as experiments name them.

use msplines_trivariate::domain::Sampling;
use msplines_trivariate::domain::mesher::{MesherOptions, Spacing};
use msplines_trivariate::domain::volume::{Corners, Search, VolumeOptions};
use msplines_trivariate::fit::{certified, least_squares, multilevel};
use msplines_trivariate::options::Fitting;
use msplines_trivariate::solid::Options;
use serde::{Deserialize, Serialize};

use super::manifold::Settings;
use crate::case::{Cut, Filler, LatticeMove, SolidMap, TrivariateMethod};

/// Options of a trivariate spline; what is absent is as `settings` has it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RowSolid {
    /// Where options start from. Those of the paper find corners where none are given.
    pub settings: Settings,
    /// What the solid is mapped to.
    pub map: SolidMap,
    /// What fills a surface with tetrahedra.
    pub filler: Filler,
    /// Vertices that become the corners of the cube.
    pub corners: Option<[u32; 8]>,
    /// How a surface is filled; takes the place of all options of the mesher.
    pub mesher: Option<MesherOptions>,
    /// How long lattice edges are.
    pub spacing: Option<Spacing>,
    /// How tetrahedra are mapped to the cube; takes the place of all options of the map.
    pub volume: Option<VolumeOptions>,
    /// Which points are fitted.
    pub sampling: Option<Sampling>,
    /// How they are fitted.
    pub fit: Option<FitName>,
    /// Spans of the last level.
    pub spans: Option<usize>,
    /// Spans of the first level; as few as doubling allows where absent.
    pub coarsest: Option<usize>,
    /// Root mean square at which multilevel B-splines end.
    pub stop_rms: Option<f64>,
    /// Weight of the second derivatives.
    pub smoothing: Option<f64>,
    /// Cells in each direction of the samplings by which the spline is judged.
    pub validate_at: Option<Vec<usize>>,
    /// Cells along the side of a span when the solid is cut into pieces.
    pub cells: Option<usize>,
    /// What pictures cut away.
    pub cut: Option<Cut>,
    /// Control points that are moved after the fit.
    pub moves: Vec<LatticeMove>,
}

/// How samples are fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FitName {
    /// By least squares, proved not to fold.
    Certified,
    /// By least squares.
    LeastSquares,
    /// By multilevel B-splines.
    Multilevel,
}

/// Fewest spans of a first level that is not given.
const FEWEST: usize = 4;

/// Returns the spans of the first level: those of the last one, halved as often as they stay whole and
/// are not below four.
#[must_use]
pub fn first_level(finest: usize) -> usize {
    let mut spans = finest;
    while spans.is_multiple_of(2) && spans / 2 >= FEWEST {
        spans /= 2;
    }
    spans
}

impl RowSolid {
    /// Returns the method that these options ask for.
    #[must_use]
    pub fn method(&self) -> TrivariateMethod {
        let base = TrivariateMethod::default();
        TrivariateMethod {
            options: self.options(),
            map: self.map,
            filler: self.filler,
            validate_at: self.validate_at.clone().unwrap_or(base.validate_at),
            cells: self.cells.unwrap_or(base.cells),
            cut: self.cut.unwrap_or(base.cut),
            moves: self.moves.clone(),
        }
    }

    fn options(&self) -> Options {
        let mut options = match self.settings {
            Settings::Ours => Options::default(),
            Settings::Paper => Options::paper([0; 8]),
        };
        if let Some(mesher) = self.mesher {
            options.domain.mesher = mesher;
        }
        if let Some(spacing) = self.spacing {
            options.domain.mesher.spacing = spacing;
        }
        if let Some(volume) = &self.volume {
            options.domain.volume = volume.clone();
        }
        options.domain.volume.corners = match (self.corners, options.domain.volume.corners) {
            (Some(corners), _) => Corners::Given(corners),
            // The paper's corners are those that a user gives.
            (None, Corners::Given(_)) if self.volume.is_none() => Corners::Found(Search::default()),
            (None, corners) => corners,
        };
        options.sampling = self.sampling.unwrap_or(options.sampling);
        options.fitting = self.fitting(options.fitting);
        options
    }

    fn fitting(&self, base: Fitting) -> Fitting {
        let fitting = match (self.fit, base) {
            (None, base) => base,
            (Some(FitName::Certified), base @ Fitting::Certified(_))
            | (Some(FitName::LeastSquares), base @ Fitting::LeastSquares(_))
            | (Some(FitName::Multilevel), base @ Fitting::Multilevel(_)) => base,
            (Some(FitName::Certified), _) => Fitting::Certified(certified::Options::default()),
            (Some(FitName::LeastSquares), _) => {
                Fitting::LeastSquares(least_squares::Options::default())
            }
            (Some(FitName::Multilevel), _) => Fitting::Multilevel(multilevel::Options::default()),
        };
        match fitting {
            Fitting::Multilevel(mut options) => {
                options.finest = self.spans.unwrap_or(options.finest);
                options.coarsest = self.coarsest.unwrap_or(options.coarsest);
                options.stop_rms = self.stop_rms.unwrap_or(options.stop_rms);
                Fitting::Multilevel(options)
            }
            Fitting::LeastSquares(options) => Fitting::LeastSquares(self.least_squares(options)),
            Fitting::Certified(options) => Fitting::Certified(certified::Options {
                least_squares: self.least_squares(options.least_squares),
                ..options
            }),
        }
    }

    fn least_squares(&self, base: least_squares::Options) -> least_squares::Options {
        let finest = self.spans.unwrap_or(base.finest);
        let coarsest = match self.spans {
            Some(spans) => first_level(spans),
            None => base.coarsest,
        };
        least_squares::Options {
            finest,
            coarsest: self.coarsest.unwrap_or(coarsest),
            smoothing: self.smoothing.unwrap_or(base.smoothing),
            ..base
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(text: &str) -> TrivariateMethod {
        toml::from_str::<RowSolid>(text).expect(text).method()
    }

    #[test]
    fn options_change_what_they_name_and_nothing_else() {
        assert_eq!(row(""), TrivariateMethod::default());
        let corners = "settings = \"paper\"\ncorners = [0, 1, 2, 3, 4, 5, 6, 7]";
        let paper = Options::paper([0, 1, 2, 3, 4, 5, 6, 7]);
        assert_eq!(row(corners).options, paper);
        let found = row("settings = \"paper\"\nspans = 32").options;
        assert!(matches!(found.domain.volume.corners, Corners::Found(_)));
        let expected = Fitting::Multilevel(multilevel::Options {
            finest: 32,
            ..multilevel::Options::PAPER
        });
        assert_eq!(found.fitting, expected);
        let coarse = row("spans = 8\nspacing = { along_diagonal = 12.0 }").options;
        let Fitting::Certified(options) = coarse.fitting else {
            panic!("still certified");
        };
        let levels = (options.least_squares.coarsest, options.least_squares.finest);
        assert_eq!(levels, (4, 8));
        assert!(toml::from_str::<RowSolid>("knots = 5").is_err());
    }

    #[test]
    fn first_levels_double_to_the_last() {
        let levels = [1, 4, 6, 12, 16, 20, 64].map(first_level);
        assert_eq!(levels, [1, 4, 6, 6, 4, 5, 4]);
    }
}
