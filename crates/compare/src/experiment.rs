//! Experiments: one file per table or figure of a paper, with what it prints and what we say to it.

use std::collections::BTreeSet;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::case::{Amount, Case, Data, Input, Method};
use crate::generated::GeneratedSurface;

/// The schema of [`Experiment`].
pub const EXPERIMENT_SCHEMA: &str = "msplines.experiment/1";

/// One table or figure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Experiment {
    /// Always [`EXPERIMENT_SCHEMA`].
    pub schema: String,
    /// Key of the paper, such as `hou2017`.
    pub paper: String,
    /// Name of the item, such as `table1`.
    pub item: String,
    /// What is compared, in one line.
    pub title: String,
    /// What a reader should know about the whole item.
    #[serde(default)]
    pub notes: String,
    /// Its rows.
    #[serde(rename = "row")]
    pub rows: Vec<Row>,
}

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
    /// Knots or control vertices: a count or a percentage.
    pub knots: String,
    /// What is fitted.
    #[serde(default)]
    pub data: RowData,
    /// Effort of the knot optimisation; the method's default where absent.
    pub effort: Option<msplines_biharmonic::Effort>,
    /// Rounds of midpoint subdivision at whose vertices the spline is evaluated.
    #[serde(default)]
    pub subdivide: u32,
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
}

/// Data as experiments name it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RowData {
    /// Vertex positions.
    #[default]
    Positions,
    /// The generated colours.
    ColourPattern,
}

/// What a paper prints. Errors are fractions, times seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Printed {
    /// Vertices of the paper's mesh.
    pub vertices: Option<u64>,
    /// Mean error over the vertices.
    pub error: Option<f64>,
    /// Peak signal-to-noise ratio in decibels.
    pub psnr_db: Option<f64>,
    /// Knot optimisation.
    pub select_seconds: Option<f64>,
    /// Fit at the chosen knots.
    pub fit_seconds: Option<f64>,
    /// Evaluation.
    pub evaluate_seconds: Option<f64>,
    /// Iterations of the knot optimisation.
    pub iterations: Option<u32>,
}

/// Our own value of a row, against regression.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recorded {
    /// Mean error over the vertices.
    pub error: f64,
    /// How far it may get worse, as a fraction.
    pub tolerance: f64,
}

/// Why an experiment file cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExperimentError {
    /// The file or folder cannot be read.
    #[error("{path}: {source}; run this from a checkout of the project")]
    Unreadable {
        /// The file or folder.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// Not the fields of an experiment.
    #[error("{path}: {message}")]
    Syntax {
        /// The file.
        path: String,
        /// What the parser said, with line and column.
        message: String,
    },
    /// Fields that contradict each other.
    #[error("{path}: row `{row}`: {problem}")]
    Row {
        /// The file.
        path: String,
        /// The row.
        row: String,
        /// What is wrong and what to write.
        problem: String,
    },
    /// No such paper or item.
    #[error("no experiment `{asked}`; there are: {available}")]
    Unknown {
        /// What was asked for.
        asked: String,
        /// What there is.
        available: String,
    },
}

impl Experiment {
    /// Reads and checks an experiment file.
    ///
    /// # Errors
    /// A file that cannot be read, or whose fields are unknown or contradict each other.
    pub fn read(path: &Path) -> Result<Self, ExperimentError> {
        let name = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|source| ExperimentError::Unreadable {
            path: name.clone(),
            source,
        })?;
        Self::parse(&text, &name)
    }

    /// Reads and checks the text of an experiment file called `name`.
    ///
    /// # Errors
    /// Fields that are unknown or contradict each other.
    pub fn parse(text: &str, name: &str) -> Result<Self, ExperimentError> {
        let syntax = |message: String| ExperimentError::Syntax {
            path: name.to_owned(),
            message,
        };
        let experiment: Self = toml::from_str(text).map_err(|e| syntax(e.to_string()))?;
        if experiment.schema != EXPERIMENT_SCHEMA {
            return Err(syntax(format!("schema must be {EXPERIMENT_SCHEMA}")));
        }
        experiment.check(name)?;
        Ok(experiment)
    }

    fn check(&self, name: &str) -> Result<(), ExperimentError> {
        let mut ids = BTreeSet::new();
        for row in &self.rows {
            let refused = |problem: &str| ExperimentError::Row {
                path: name.to_owned(),
                row: row.id.clone(),
                problem: problem.to_owned(),
            };
            if !ids.insert(row.id.as_str()) {
                return Err(refused("two rows have this id; rename one"));
            }
            if row.model.is_some() == row.surface.is_some() {
                return Err(refused("give either `model` or `surface`"));
            }
            row.amount().map_err(|e| refused(&format!("knots: {e}")))?;
            if let Some(surface) = &row.surface {
                surface
                    .parse::<GeneratedSurface>()
                    .map_err(|e| refused(&e.to_string()))?;
            }
            if row.printed.error.is_some() && row.tolerance <= 0.0 {
                return Err(refused("a printed error needs a `tolerance`"));
            }
            let other = row.more_accurate_than.as_deref();
            if other.is_some_and(|id| !self.rows.iter().any(|row| row.id == id)) {
                return Err(refused("`more_accurate_than` names no row of this file"));
            }
        }
        Ok(())
    }
}

impl Row {
    /// Returns the number of knots or control vertices.
    ///
    /// # Errors
    /// Text that is neither a count nor a percentage.
    pub fn amount(&self) -> Result<Amount, crate::case::AmountError> {
        self.knots.parse()
    }

    /// Returns the run of this row on `input`.
    ///
    /// # Errors
    /// Knots that are neither a count nor a percentage.
    pub fn case(&self, input: Input) -> Result<Case, crate::case::AmountError> {
        let amount = self.amount()?;
        let mut method = match self.method {
            MethodName::Biharmonic => Method::biharmonic(amount),
            MethodName::LsMesh => Method::ls_mesh(amount),
        };
        if let (Method::Biharmonic { effort, .. }, Some(asked)) = (&mut method, self.effort) {
            *effort = asked;
        }
        let data = match self.data {
            RowData::Positions => Data::Positions,
            RowData::ColourPattern => Data::ColourPattern,
        };
        Ok(Case {
            data,
            subdivide: self.subdivide,
            ..Case::new(input, method)
        })
    }
}

/// Returns the experiments of a folder `data/experiments`, sorted by paper and item, restricted
/// to `paper` and `item` where given.
///
/// # Errors
/// A folder or file that cannot be used, or a paper or item that does not exist.
pub fn experiments(
    folder: &Path,
    paper: Option<&str>,
    item: Option<&str>,
) -> Result<Vec<Experiment>, ExperimentError> {
    let mut all = Vec::new();
    for paper_folder in entries(folder)? {
        for file in entries(&paper_folder)? {
            if file
                .extension()
                .is_some_and(|extension| extension == "toml")
            {
                all.push(Experiment::read(&file)?);
            }
        }
    }
    let name = |e: &Experiment| format!("{} {}", e.paper, e.item);
    let available = all.iter().map(name).collect::<Vec<_>>().join(", ");
    all.retain(|e| paper.is_none_or(|p| p == e.paper) && item.is_none_or(|i| i == e.item));
    if all.is_empty() {
        let asked = [paper, item]
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
            .join(" ");
        return Err(ExperimentError::Unknown { asked, available });
    }
    Ok(all)
}

fn entries(folder: &Path) -> Result<Vec<std::path::PathBuf>, ExperimentError> {
    let unreadable = |source| ExperimentError::Unreadable {
        path: folder.display().to_string(),
        source,
    };
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        paths.push(entry.map_err(unreadable)?.path());
    }
    paths.sort();
    Ok(paths)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str =
        "schema = \"msplines.experiment/1\"\npaper = \"p\"\nitem = \"i\"\ntitle = \"t\"\n";

    fn parse(row: &str) -> Result<Experiment, ExperimentError> {
        let text =
            format!("{HEAD}[[row]]\nid = \"a\"\nlabel = \"A\"\nmethod = \"biharmonic\"\n{row}");
        Experiment::parse(&text, "p/i.toml")
    }

    #[test]
    fn a_row_becomes_the_case_it_describes() {
        let text = "surface = \"genus-3\"\nknots = \"5%\"\neffort = \"fast\"\nsubdivide = 1\n";
        let experiment = parse(text).expect("a good row");
        let input = Input::Surface(GeneratedSurface::Genus3);
        let case = experiment.rows[0].case(input).expect("a good case");
        assert_eq!(case.subdivide, 1);
        let Method::Biharmonic { knots, effort, .. } = case.method else {
            panic!("another method");
        };
        assert_eq!(knots, Amount::Fraction(0.05));
        assert_eq!(effort, msplines_biharmonic::Effort::Fast);
    }

    #[test]
    fn contradictions_are_refused_with_file_and_row() {
        let bad = [
            ("knots = \"5\"\n", "either `model` or `surface`"),
            (
                "knots = \"5\"\nmodel = \"m\"\nsurface = \"genus-2\"\n",
                "either `model` or `surface`",
            ),
            ("knots = \"five\"\nmodel = \"m\"\n", "neither a count"),
            ("knots = \"5\"\nsurface = \"cube\"\n", "no surface `cube`"),
            (
                "knots = \"5\"\nmodel = \"m\"\nprinted.error = 0.1\n",
                "needs a `tolerance`",
            ),
            (
                "knots = \"5\"\nmodel = \"m\"\nmore_accurate_than = \"b\"\n",
                "names no row",
            ),
            ("knots = \"5\"\nmodel = \"m\"\nknot = 3\n", "unknown field"),
        ];
        for (row, message) in bad {
            let error = parse(row).expect_err(row).to_string();
            assert!(
                error.contains(message) && error.contains("p/i.toml"),
                "{error}"
            );
        }
    }
}
