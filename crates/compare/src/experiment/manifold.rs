//! What a row says about a sparse manifold.

use msplines_sparse_manifold::pursuit::Selection;
use msplines_sparse_manifold::{
    Acceptance, Components, DictionaryKind, Gate, Local, Options, SweepOrder,
};
use serde::{Deserialize, Serialize};

use crate::case::{Creases, Polygons, SparseManifoldMethod};

/// Options of a sparse manifold; what is absent is as `settings` has it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RowManifold {
    /// Where options start from.
    pub settings: Settings,
    /// How the function of a chart is found.
    pub local: LocalName,
    /// Catmull-Clark steps whose vertices are the observations.
    pub levels: Option<u32>,
    /// Most atoms of a chart.
    pub sparsity: Option<u32>,
    /// Which atom comes next.
    pub selection: Option<Selection>,
    /// What charts are made of.
    pub dictionary: Option<DictionaryKind>,
    /// Whether coordinates share their atoms.
    pub components: Option<Components>,
    /// Degree of least-squares polynomials.
    pub degree: Option<u32>,
    /// Which charts may have shape functions.
    pub gate: Option<Gate>,
    /// Charts without shape functions.
    pub smooth_charts: Vec<u32>,
    /// How charts take turns.
    pub order: Option<SweepOrder>,
    /// When a new choice of atoms replaces the one before.
    pub acceptance: Option<Acceptance>,
    /// Most sweeps in which atoms are chosen.
    pub sweeps: Option<u32>,
    /// Most sweeps in which they are kept.
    pub frozen_sweeps: Option<u32>,
    /// Whether the tags of the control mesh count.
    pub creases: Tags,
    /// What is done with faces that are not quads.
    pub polygons: Polygons,
    /// Vertices of the decimated scan that the control mesh is made of.
    pub scan: Option<usize>,
}

/// Where options start from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Settings {
    /// The defaults of the library.
    #[default]
    Ours,
    /// Those of the paper.
    Paper,
}

/// How the function of a chart is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LocalName {
    /// A few atoms.
    #[default]
    Sparse,
    /// Least-squares polynomials.
    Polynomial,
    /// Least-squares splines.
    Spline,
}

/// Whether tags of a control mesh count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tags {
    /// They do.
    #[default]
    Kept,
    /// Nothing but the boundary is sharp.
    Dropped,
}

impl RowManifold {
    /// Returns the method that these options ask for.
    #[must_use]
    pub fn method(&self) -> SparseManifoldMethod {
        let base = match self.settings {
            Settings::Ours => Options::default(),
            Settings::Paper => Options::PAPER,
        };
        SparseManifoldMethod {
            options: Options {
                local: self.local(base.local),
                levels: self.levels.unwrap_or(base.levels),
                gate: self.gate.unwrap_or(base.gate),
                smooth_charts: self.smooth_charts.clone(),
                order: self.order.unwrap_or(base.order),
                acceptance: self.acceptance.unwrap_or(base.acceptance),
                sweeps: self.sweeps.unwrap_or(base.sweeps),
                frozen_sweeps: self.frozen_sweeps.unwrap_or(base.frozen_sweeps),
                least_progress: base.least_progress,
            },
            creases: match self.creases {
                Tags::Kept => Creases::Beside,
                Tags::Dropped => Creases::None,
            },
            polygons: self.polygons,
            scan: self.scan,
            ..SparseManifoldMethod::default()
        }
    }

    fn local(&self, base: Local) -> Local {
        match (self.local, base) {
            (LocalName::Polynomial, _) => Local::Polynomial {
                degree: self.degree,
            },
            (LocalName::Spline, _) => Local::Spline,
            (
                LocalName::Sparse,
                Local::Sparse {
                    dictionary,
                    sparsity,
                    selection,
                    components,
                },
            ) => Local::Sparse {
                dictionary: self.dictionary.unwrap_or(dictionary),
                sparsity: self.sparsity.unwrap_or(sparsity),
                selection: self.selection.unwrap_or(selection),
                components: self.components.unwrap_or(components),
            },
            (LocalName::Sparse, other) => other,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_change_what_they_name_and_nothing_else() {
        let row = |text: &str| toml::from_str::<RowManifold>(text).expect(text).method();
        assert_eq!(row(""), SparseManifoldMethod::default());
        assert_eq!(row("settings = \"paper\"").options, Options::PAPER);
        let changed = row("settings = \"paper\"\nsparsity = 5\nlevels = 3").options;
        let Local::Sparse {
            sparsity,
            selection,
            ..
        } = changed.local
        else {
            panic!("still sparse")
        };
        assert_eq!(
            (sparsity, selection, changed.levels),
            (5, Selection::Omp, 3)
        );
        let polynomial = row("local = \"polynomial\"\ndegree = 6").options.local;
        assert_eq!(polynomial, Local::Polynomial { degree: Some(6) });
        assert!(toml::from_str::<RowManifold>("sparse = 5").is_err());
    }
}
