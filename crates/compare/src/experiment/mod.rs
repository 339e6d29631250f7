//! Experiments: one file per table or figure of a paper, with what it prints and what we say to it.

mod column;
mod field;
mod figure;
mod manifold;
mod network;
mod over_time;
mod printed;
mod property;
mod row;
mod solid;
mod view;

use std::collections::BTreeSet;
use std::path::Path;

use serde::{Deserialize, Serialize};

pub use column::{Column, Notation};
pub use field::{FieldColours, FieldScale, FieldSurface};
pub use figure::{Axis, Edges, Figure, Panel, Plot, Show};
pub use manifold::{LocalName, RowManifold, Settings, Tags};
pub use network::RowNetwork;
pub use over_time::RowFrames;
pub use printed::{Printed, Recorded};
pub use property::{Measured, Property, splines};
pub use row::{Ancestors, MethodName, Row, RowData};
pub use solid::{FitName, RowSolid, first_level};
pub use view::{Callout, Close, Corner, UpAxis, ViewHint};

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
    /// Further columns of its table.
    #[serde(default)]
    pub columns: Vec<Column>,
    /// Its rows.
    #[serde(rename = "row")]
    pub rows: Vec<Row>,
    /// Properties of splines, as the paper prints and as rows measured them.
    #[serde(default, rename = "property")]
    pub properties: Vec<Property>,
    /// Figures of its surfaces.
    #[serde(default, rename = "figure")]
    pub figures: Vec<Figure>,
    /// Plots of its figures.
    #[serde(default, rename = "plot")]
    pub plots: Vec<Plot>,
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
    /// A figure or plot that cannot be drawn.
    #[error("{path}: figure `{figure}`: {problem}")]
    Figure {
        /// The file.
        path: String,
        /// The figure or plot.
        figure: String,
        /// What is wrong and what to write.
        problem: String,
    },
    /// A column that no record can fill.
    #[error("{path}: column `{column}`: {problem}")]
    Column {
        /// The file.
        path: String,
        /// The quantity of the column.
        column: String,
        /// What is wrong and what to write.
        problem: String,
    },
    /// A property that cannot be judged.
    #[error("{path}: property `{property}`: {problem}")]
    Property {
        /// The file.
        path: String,
        /// The property.
        property: String,
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
        Self::parse(&read_text(path)?, &path.display().to_string())
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
        for (index, row) in self.rows.iter().enumerate() {
            let problem = if ids.insert(row.id.as_str()) {
                self.row_problem(index)
            } else {
                Some("two rows have this id; rename one".to_owned())
            };
            if let Some(problem) = problem {
                return Err(ExperimentError::Row {
                    path: name.to_owned(),
                    row: row.id.clone(),
                    problem,
                });
            }
        }
        if let Some((figure, problem)) = self.figure_problem() {
            return Err(ExperimentError::Figure {
                path: name.to_owned(),
                figure,
                problem,
            });
        }
        column::check(&self.columns, name)?;
        property::check(&self.properties, |row| self.has_row(row), name)
    }

    /// Keeps the row `id`, the rows that it needs, and what can be drawn of them; returns whether
    /// there is such a row.
    pub fn restrict(&mut self, id: &str) -> bool {
        let mut kept = BTreeSet::from([id.to_owned()]);
        // Rows need only earlier ones.
        for row in self.rows.iter().rev() {
            if kept.contains(&row.id) {
                kept.extend(row.needs().map(str::to_owned));
            }
        }
        let found = self.has_row(id);
        self.rows.retain(|row| kept.contains(&row.id));
        for figure in &mut self.figures {
            figure.panels.retain(|panel| kept.contains(&panel.row));
        }
        self.figures.retain(|figure| !figure.panels.is_empty());
        for row in &mut self.rows {
            let other = row.more_accurate_than.take();
            row.more_accurate_than = other.filter(|other| kept.contains(other));
        }
        self.plots.clear();
        for property in &mut self.properties {
            property.measured.retain(|_, m| kept.contains(&m.row));
        }
        self.properties
            .retain(|property| !property.measured.is_empty());
        found
    }

    /// Returns where an item stands in its paper: tables first, then figures by their numbers.
    fn place(&self) -> (usize, u32, String) {
        let kinds = ["table", "figure"];
        let kind = kinds.iter().position(|kind| self.item.starts_with(kind));
        let digits: String = self.item.chars().filter(char::is_ascii_digit).collect();
        match kind {
            Some(kind) => (kind, digits.parse().unwrap_or(u32::MAX), self.item.clone()),
            None => (kinds.len(), u32::MAX, self.item.clone()),
        }
    }

    fn has_row(&self, id: &str) -> bool {
        self.rows.iter().any(|row| row.id == id)
    }

    fn row_problem(&self, index: usize) -> Option<String> {
        let row = &self.rows[index];
        if row.model.is_some() == row.surface.is_some() {
            return Some("give either `model` or `surface`".to_owned());
        }
        if let Some(problem) = row.knots_problem().or_else(|| row.frames_problem()) {
            return Some(problem);
        }
        if let Some(problem) = row.surface.as_deref().and_then(|s| row.surface_problem(s)) {
            return Some(problem);
        }
        if row.printed.error.is_some() && row.tolerance <= 0.0 {
            return Some("a printed error needs a `tolerance`".to_owned());
        }
        let other = row.more_accurate_than.as_deref();
        if other.is_some_and(|id| !self.has_row(id)) {
            return Some("`more_accurate_than` names no row of this file".to_owned());
        }
        let earlier = &self.rows[..index];
        let missing = row.needs().find(|&id| !earlier.iter().any(|r| r.id == id));
        missing.map(|id| format!("needs the row `{id}`, which must stand before it"))
    }

    fn figure_problem(&self) -> Option<(String, String)> {
        let mut ids = BTreeSet::new();
        let figures = self.figures.iter().map(|figure| {
            let rows = figure.panels.iter().map(|panel| &panel.row).collect();
            (&figure.id, rows, false)
        });
        let plots = self.plots.iter().map(|plot| {
            let mixed = plot.x.is_history() != plot.y.is_history();
            (&plot.id, plot.rows.iter().collect::<Vec<_>>(), mixed)
        });
        for (id, rows, mixed) in figures.chain(plots) {
            if !ids.insert(id) {
                return Some((
                    id.clone(),
                    "two figures have this id; rename one".to_owned(),
                ));
            }
            if let Some(row) = rows.into_iter().find(|row| !self.has_row(row)) {
                return Some((id.clone(), format!("names no row of this file: `{row}`")));
            }
            if mixed {
                let problem = "`elapsed` and `objective` only go together";
                return Some((id.clone(), problem.to_owned()));
            }
        }
        let mut panels = self.figures.iter().flat_map(|figure| {
            let panels = figure.panels.iter().enumerate();
            panels.map(|(at, panel)| (&figure.id, at, panel))
        });
        panels.find_map(|(id, at, panel)| {
            let row = self.rows.iter().find(|row| row.id == panel.row);
            let of_frames = row.and_then(|row| over_time::panel_problem(panel, row));
            let problem = panel.problem().map(str::to_owned).or(of_frames)?;
            let place = format!("panel {} (row `{}`)", at + 1, panel.row);
            Some((id.clone(), format!("{place}: {problem}")))
        })
    }
}

/// What is known of a paper, from `paper.toml` in the folder of its experiments.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PaperFacts {
    /// What a report calls it.
    pub title: String,
    /// Authors, title, place and year.
    pub citation: String,
}

impl PaperFacts {
    /// Key of the folder that compares all methods and is no paper.
    pub const ACROSS: &'static str = "across";
    /// Name of the file.
    pub const FILE: &'static str = "paper.toml";

    /// Reads the facts of the paper `key` below the folder of all experiments; a paper without
    /// the file is called by its key.
    #[must_use]
    pub fn read(experiments: &Path, key: &str) -> Self {
        let text = std::fs::read_to_string(experiments.join(key).join(Self::FILE));
        let facts = text.ok().and_then(|text| toml::from_str(&text).ok());
        facts.unwrap_or_else(|| Self {
            title: key.to_owned(),
            citation: String::new(),
        })
    }
}

/// Returns the experiments of a folder `data/experiments`, by paper and place in it, restricted
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
            let is_toml = file.extension().is_some_and(|e| e == "toml");
            if is_toml && !file.ends_with(PaperFacts::FILE) {
                all.push(Experiment::read(&file)?);
            }
        }
    }
    all.sort_by_cached_key(|e| (e.paper == PaperFacts::ACROSS, e.paper.clone(), e.place()));
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

/// Returns the text of a file.
pub(crate) fn read_text(path: &Path) -> Result<String, ExperimentError> {
    std::fs::read_to_string(path).map_err(|source| ExperimentError::Unreadable {
        path: path.display().to_string(),
        source,
    })
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
pub(crate) mod tests {
    use super::*;
    use crate::case::{Amount, Data, Input, Knots, Method};

    const HEAD: &str =
        "schema = \"msplines.experiment/1\"\npaper = \"p\"\nitem = \"i\"\ntitle = \"t\"\n";

    fn parse(row: &str) -> Result<Experiment, ExperimentError> {
        let text =
            format!("{HEAD}[[row]]\nid = \"a\"\nlabel = \"A\"\nmethod = \"biharmonic\"\n{row}");
        Experiment::parse(&text, "p/i.toml")
    }

    /// Parses an experiment of one row `a` with fields before and tables after it.
    pub(crate) fn parse_with(fields: &str, tables: &str) -> Result<Experiment, ExperimentError> {
        let row = "[[row]]\nid = \"a\"\nlabel = \"A\"\nmethod = \"biharmonic\"\nsurface = \
                   \"genus-2\"\nknots = \"5\"\n";
        Experiment::parse(&format!("{HEAD}{fields}\n{row}{tables}"), "p/i.toml")
    }

    #[test]
    fn a_row_becomes_the_case_it_describes() {
        let text = "surface = \"genus-3\"\nknots = \"5%\"\neffort = \"fast\"\nsubdivide = 1\n";
        let experiment = parse(text).expect("a good row");
        let input = Input::Surface(crate::generated::GeneratedSurface::Genus3);
        let case = experiment.rows[0]
            .case(input, &Ancestors::default())
            .expect("a good case");
        assert_eq!(case.subdivide, 1);
        let Method::Biharmonic(method) = case.method else {
            panic!("another method");
        };
        assert_eq!(method.knots, Knots::Optimised(Amount::Fraction(0.05)));
        assert_eq!(method.effort, msplines_biharmonic::Effort::Fast);
    }

    #[test]
    fn a_row_of_colours_names_its_data_and_its_series() {
        let row = "surface = \"genus-8\"\nknots = \"5%\"\n";
        let colours = "data = \"colour-image\"\nselection = \"blue-noise\"\n";
        let experiment = parse(&format!("{row}{colours}")).expect("a good row");
        let colours = &experiment.rows[0];
        assert_eq!(colours.data.data(), Data::ColourImage);
        assert!(colours.data.are_colours());
        assert_eq!(colours.series(), "biharmonic B-spline, blue noise");
        let experiment = parse(row).expect("a good row");
        let plain = &experiment.rows[0];
        assert!(!plain.data.are_colours());
        assert_eq!(plain.series(), "biharmonic B-spline");
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
            ("model = \"m\"\n", "either `knots` or `knots_from`"),
            (
                "knots = \"5\"\nmodel = \"m\"\ninside_faces = true\n",
                "`inside_faces` goes with `knots_from`",
            ),
            (
                "model = \"m\"\nknots_from = \"a\"\n",
                "must stand before it",
            ),
            (
                "knots = \"5\"\nmodel = \"m\"\n[[plot]]\nid = \"p\"\ncaption = \"\"\nx = \"knots\"\ny = \"objective\"\n",
                "only go together",
            ),
            (
                "knots = \"5\"\nmodel = \"m\"\n[[figure]]\nid = \"f\"\ncaption = \"\"\n[[figure.panel]]\nrow = \"b\"\nshow = \"spline\"\n",
                "figure `f`: names no row",
            ),
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
