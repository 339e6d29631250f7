//! One row of an experiment: a run, what the paper prints for it, and what must hold.

use std::collections::BTreeMap;
use std::path::PathBuf;

use msplines_biharmonic::Selection;
use serde::{Deserialize, Serialize};

use super::{Printed, Recorded, RowFrames, RowManifold, RowNetwork, RowSolid};
use crate::case::{
    Amount, AmountError, Case, CaseCreases, ChartMethod, ConformalMethod, Data, Input, Knots,
    Method, PowellSabinMethod, TSplineMethod, Task, Weights,
};
use crate::generated::{ChartFunction, ControlShape, GeneratedSurface, NetworkShape, SolidShape};

/// One row of an experiment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// Unique in its experiment.
    pub id: String,
    /// What a table says at its start.
    pub label: String,
    /// Name of a model in `data/models.toml`.
    pub model: Option<String>,
    /// Name of a generated surface, where there is no model.
    pub surface: Option<String>,
    /// The method.
    pub method: MethodName,
    /// Knots or control vertices: a count, a percentage, or `all`.
    pub knots: Option<String>,
    /// Another row of this experiment: the knots are the vertices nearest to its knots, or
    /// with `inside_faces` the points nearest to them.
    pub knots_from: Option<String>,
    /// Another row of this experiment, to whose surface the distance is measured.
    pub compared_with: Option<String>,
    /// What is fitted.
    #[serde(default)]
    pub data: RowData,
    /// Options of a sparse manifold or a single chart.
    pub manifold: Option<RowManifold>,
    /// Options of a surface over a curve network.
    pub network: Option<RowNetwork>,
    /// Options of a trivariate spline.
    pub solid: Option<RowSolid>,
    /// Options of a conformal atlas.
    pub conformal: Option<ConformalMethod>,
    /// Options of a Powell-Sabin spline.
    pub powell_sabin: Option<PowellSabinMethod>,
    /// Options of a T-spline.
    pub t_spline: Option<TSplineMethod>,
    /// Frames of an animation, in place of one surface.
    pub over_time: Option<RowFrames>,
    /// How knots are chosen; the method's default where absent.
    pub selection: Option<Selection>,
    /// Degrees beyond which edges are creases; none where absent.
    pub creases: Option<f64>,
    /// Effort of the knot optimisation; the method's default where absent.
    pub effort: Option<msplines_biharmonic::Effort>,
    /// Rounds of midpoint subdivision at whose vertices the spline is evaluated.
    #[serde(default)]
    pub subdivide: u32,
    /// Where that subdivision puts its vertices.
    #[serde(default)]
    pub scheme: msplines_biharmonic::Scheme,
    /// Rounds of Loop's subdivision that the model or surface goes through before anything else.
    #[serde(default)]
    pub refine: u32,
    /// Whether the spline lives on the double cover of the input.
    #[serde(default)]
    pub double_cover: bool,
    /// What is done beyond a fit.
    pub task: Option<Task>,
    /// Where vertices count more than elsewhere.
    pub weights: Option<Weights>,
    /// Whether the knots of `knots_from` may lie inside faces.
    #[serde(default)]
    pub inside_faces: bool,
    /// Whether the two-sided distance between the surfaces is measured.
    #[serde(default)]
    pub measure_distance: bool,
    /// Whether only `--full` runs this row.
    #[serde(default)]
    pub full_only: bool,
    /// Seconds after which the row is given up.
    #[serde(default = "default_time_limit")]
    pub time_limit_seconds: f64,
    /// What the paper prints.
    #[serde(default)]
    pub printed: Printed,
    /// How far our error may lie from the printed one, as a fraction of it.
    #[serde(default)]
    pub tolerance: f64,
    /// Our own value, which must not get worse.
    pub recorded: Option<Recorded>,
    /// Another row of the same experiment that must have a larger error.
    pub more_accurate_than: Option<String>,
    /// Values of the record that must not be exceeded, such as `error.max` or
    /// `checks.reference_rms`.
    #[serde(default)]
    pub at_most: BTreeMap<String, f64>,
    /// Why ours differs, where it does.
    #[serde(default)]
    pub analysis: String,
}

fn default_time_limit() -> f64 {
    600.0
}

/// A method as experiments name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MethodName {
    /// Biharmonic B-spline.
    Biharmonic,
    /// Least-squares mesh.
    LsMesh,
    /// Sparse manifold.
    SparseManifold,
    /// Surface over a curve network.
    CurveNetwork,
    /// The function of a single chart.
    Chart,
    /// Trivariate spline of a solid.
    Trivariate,
    /// Conformal atlas.
    Conformal,
    /// Powell-Sabin spline through the vertices of a surface.
    PowellSabin,
    /// T-spline that approximates a surface.
    TSpline,
}

impl MethodName {
    /// Returns the name in records and files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Biharmonic => "biharmonic",
            Self::LsMesh => "ls-mesh",
            Self::SparseManifold => "sparse-manifold",
            Self::CurveNetwork => "curve-network",
            Self::Chart => "chart",
            Self::Trivariate => "trivariate",
            Self::Conformal => "conformal",
            Self::PowellSabin => "powell-sabin",
            Self::TSpline => "t-spline",
        }
    }

    /// Returns whether its surface is made of charts over polygons, and its input no surface of
    /// triangles.
    #[must_use]
    pub fn has_charts(self) -> bool {
        matches!(
            self,
            Self::SparseManifold | Self::CurveNetwork | Self::Chart
        )
    }

    /// Returns what tables and legends for people say.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Biharmonic => "biharmonic B-spline",
            Self::LsMesh => "least-squares mesh",
            Self::SparseManifold => "sparse manifold",
            Self::CurveNetwork => "surface over curves",
            Self::Chart => "single chart",
            Self::Trivariate => "trivariate spline",
            Self::Conformal => "conformal atlas",
            Self::PowellSabin => "Powell-Sabin spline",
            Self::TSpline => "T-spline",
        }
    }
}

/// Data as experiments name it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RowData {
    /// Vertex positions.
    #[default]
    Positions,
    /// Generated colours that are as hard everywhere.
    ColourPattern,
    /// Generated colours that are like an image.
    ColourImage,
}

impl RowData {
    /// Returns what is fitted at the vertices.
    #[must_use]
    pub fn data(self) -> Data {
        match self {
            Self::Positions => Data::Positions,
            Self::ColourPattern => Data::ColourPattern,
            Self::ColourImage => Data::ColourImage,
        }
    }

    /// Returns whether these are colours, whose errors are said in decibels.
    #[must_use]
    pub fn are_colours(self) -> bool {
        matches!(self, Self::ColourPattern | Self::ColourImage)
    }
}

/// Files of other rows that a row needs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ancestors {
    /// Points at the knots of the row `knots_from`.
    pub knots: Option<PathBuf>,
    /// Surface of the row `compared_with`.
    pub reference: Option<PathBuf>,
}

impl Row {
    /// Returns the other rows whose results this one needs.
    pub fn needs(&self) -> impl Iterator<Item = &str> {
        self.knots_from
            .iter()
            .chain(&self.compared_with)
            .map(String::as_str)
    }

    /// Returns what is wrong with the fields that say how many knots there are.
    pub(super) fn knots_problem(&self) -> Option<String> {
        if let Some(problem) = self.options_problem() {
            return Some(problem.to_owned());
        }
        let takes_places = match self.method {
            MethodName::Biharmonic => true,
            MethodName::LsMesh => false,
            MethodName::SparseManifold
            | MethodName::CurveNetwork
            | MethodName::Chart
            | MethodName::Trivariate
            | MethodName::Conformal
            | MethodName::PowellSabin
            | MethodName::TSpline => {
                let given = self.knots.is_some() || self.knots_from.is_some();
                let title = self.method.title();
                return given.then(|| format!("a {title} has no knots; leave them out"));
            }
        };
        match (&self.knots, &self.knots_from) {
            (Some(_), Some(_)) | (None, None) => {
                Some("give either `knots` or `knots_from`".to_owned())
            }
            (None, Some(_)) if !takes_places => Some(format!(
                "{} takes no `knots_from`; give `knots`",
                self.method.name()
            )),
            (None, Some(_)) => None,
            (Some(_), None) if self.inside_faces => {
                Some("`inside_faces` goes with `knots_from`; leave it out".to_owned())
            }
            (Some(text), None) if takes_places => text.parse::<Knots>().err().map(|e| refused(&e)),
            (Some(text), None) => text.parse::<Amount>().err().map(|e| refused(&e)),
        }
    }

    /// Returns which options belong to another method.
    fn options_problem(&self) -> Option<&'static str> {
        let charts = matches!(self.method, MethodName::SparseManifold | MethodName::Chart);
        if self.manifold.is_some() && !charts {
            return Some("`manifold` goes with sparse manifolds and charts; leave it out");
        }
        if self.network.is_some() && self.method != MethodName::CurveNetwork {
            return Some("`network` goes with surfaces over curves; leave it out");
        }
        if self.solid.is_some() && self.method != MethodName::Trivariate {
            return Some("`solid` goes with trivariate splines; leave it out");
        }
        if self.conformal.is_some() && self.method != MethodName::Conformal {
            return Some("`conformal` goes with conformal atlases; leave it out");
        }
        if self.powell_sabin.is_some() && self.method != MethodName::PowellSabin {
            return Some("`powell_sabin` goes with Powell-Sabin splines; leave it out");
        }
        if self.t_spline.is_some() && self.method != MethodName::TSpline {
            return Some("`t_spline` goes with T-splines; leave it out");
        }
        None
    }

    /// Returns whether the input is a control mesh, and not a surface of triangles.
    #[must_use]
    pub fn takes_control_mesh(&self) -> bool {
        let scan = self.manifold.as_ref().and_then(|options| options.scan);
        self.method == MethodName::SparseManifold && scan.is_none()
    }

    /// Returns the generated input of this name.
    ///
    /// # Errors
    /// A name that nothing has, and what there is.
    pub fn generated(&self, name: &str) -> Result<Input, String> {
        if self.method == MethodName::CurveNetwork {
            let network = name.parse::<NetworkShape>().map_err(|e| e.to_string())?;
            return Ok(Input::Network(network));
        }
        if self.method == MethodName::Chart {
            let chart = name.parse::<ChartFunction>().map_err(|e| e.to_string())?;
            return Ok(Input::Chart(chart));
        }
        if self.method == MethodName::Trivariate && name.starts_with("box-") {
            let solid = name.parse::<SolidShape>().map_err(|e| e.to_string())?;
            return Ok(Input::Solid(solid));
        }
        if self.takes_control_mesh() {
            let shape = name.parse::<ControlShape>().map_err(|e| e.to_string())?;
            return Ok(Input::Control(shape));
        }
        let surface = name
            .parse::<GeneratedSurface>()
            .map_err(|e| e.to_string())?;
        Ok(Input::Surface(surface))
    }

    pub(super) fn surface_problem(&self, name: &str) -> Option<String> {
        self.generated(name).err()
    }

    /// Returns how many knots are asked for, as tables say it.
    #[must_use]
    pub fn asked_knots(&self) -> String {
        match (&self.knots, &self.knots_from) {
            (Some(knots), _) => knots.clone(),
            (None, Some(row)) => format!("those of {row}"),
            (None, None) => String::new(),
        }
    }

    /// Returns what the rows have in common that a plot connects: the method, and the selection of
    /// knots where the row names it.
    #[must_use]
    pub fn series(&self) -> String {
        let title = self.method.title();
        let selection = match self.selection {
            None => return title.to_owned(),
            Some(Selection::Exchange) => "exchange",
            Some(Selection::L1) => "l1",
            Some(Selection::L1Exchange) => "l1, then exchange",
            Some(Selection::Curvature) => "curvature",
            Some(Selection::BlueNoise) => "blue noise",
        };
        format!("{title}, {selection}")
    }

    /// Returns the run of this row on `input`.
    ///
    /// # Errors
    /// Knots that cannot be read, which [`super::Experiment::parse`] refuses.
    pub fn case(&self, input: Input, ancestors: &Ancestors) -> Result<Case, AmountError> {
        let asked = self.knots.as_deref().unwrap_or_default();
        let mut method = match (self.method, &ancestors.knots) {
            (MethodName::Biharmonic, Some(points)) if self.inside_faces => {
                Method::biharmonic(Knots::At(points.clone()))
            }
            (MethodName::Biharmonic, Some(points)) => {
                Method::biharmonic(Knots::Near(points.clone()))
            }
            (MethodName::Biharmonic, None) => Method::biharmonic(asked.parse()?),
            (MethodName::LsMesh, _) => Method::ls_mesh(asked.parse()?),
            (MethodName::SparseManifold, _) => {
                let options = self.manifold.clone().unwrap_or_default();
                Method::SparseManifold(Box::new(options.method()))
            }
            (MethodName::Chart, _) => {
                let options = self.manifold.clone().unwrap_or_default();
                Method::Chart(ChartMethod::new(options.method().options.local))
            }
            (MethodName::CurveNetwork, _) => {
                let options = self.network.clone().unwrap_or_default();
                Method::CurveNetwork(Box::new(options.method()))
            }
            (MethodName::Trivariate, _) => {
                let options = self.solid.clone().unwrap_or_default();
                Method::Trivariate(Box::new(options.method()))
            }
            (MethodName::Conformal, _) => {
                Method::Conformal(self.conformal.clone().unwrap_or_default())
            }
            (MethodName::PowellSabin, _) => {
                Method::PowellSabin(Box::new(self.powell_sabin.clone().unwrap_or_default()))
            }
            (MethodName::TSpline, _) => {
                Method::TSpline(Box::new(self.t_spline.clone().unwrap_or_default()))
            }
        };
        if let Method::Biharmonic(method) = &mut method {
            method.effort = self.effort.unwrap_or(method.effort);
            method.selection = self.selection.unwrap_or(method.selection);
            method.weights.clone_from(&self.weights);
            if let Some(degrees) = self.creases {
                method.creases = CaseCreases::SharperThan(degrees);
            }
        }
        Ok(Case {
            data: self.data.data(),
            subdivide: self.subdivide,
            scheme: self.scheme,
            refine: self.refine,
            double_cover: self.double_cover,
            task: self.task.clone().unwrap_or_default(),
            measure_distance: self.measure_distance,
            reference: ancestors.reference.clone(),
            ..Case::new(input, method)
        })
    }
}

fn refused(error: &AmountError) -> String {
    format!("knots: {error}")
}
