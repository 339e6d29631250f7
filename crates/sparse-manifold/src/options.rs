//! What can be chosen about a fit.

use serde::{Deserialize, Serialize};

use crate::dictionary::DictionaryKind;
use crate::pursuit::Selection;

/// Options of [`fit`](crate::fit()).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// How the function of a chart is found.
    pub local: Local,
    /// Catmull-Clark steps whose vertices are the observations.
    pub levels: u32,
    /// Which charts may have shape functions, which are not smooth.
    pub gate: Gate,
    /// Charts without shape functions, whatever the gate says.
    pub smooth_charts: Vec<u32>,
    /// How charts take turns.
    pub order: SweepOrder,
    /// When a new choice of atoms replaces the one before.
    pub acceptance: Acceptance,
    /// Most sweeps in which charts choose their atoms anew.
    pub sweeps: u32,
    /// Most sweeps after them, in which they keep their atoms.
    pub frozen_sweeps: u32,
    /// Sweeps end where one lowers the squared error by less than this fraction.
    pub least_progress: f64,
}

/// How the function of a chart is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Local {
    /// A few atoms of a dictionary.
    Sparse {
        /// The dictionary.
        dictionary: DictionaryKind,
        /// Most atoms of a chart.
        sparsity: u32,
        /// Which atom comes next.
        selection: Selection,
        /// Whether the coordinates share their atoms.
        components: Components,
    },
    /// All polynomials up to a degree, by least squares.
    Polynomial {
        /// The degree; absent, one more than the valence, at most 14.
        degree: Option<u32>,
    },
    /// A tensor product of splines, by least squares.
    Spline,
}

/// Whether coordinates share their atoms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Components {
    /// They do: `sparsity` atoms serve all three.
    #[default]
    Joint,
    /// Each has `sparsity` atoms of its own.
    Each,
}

/// Which charts may have shape functions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Gate {
    /// Those that a sharp edge or corner touches.
    #[default]
    Sharp,
    /// All.
    Free,
}

/// How charts take turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SweepOrder {
    /// Each sees what those before it have become; charts without a common face go side by side.
    #[default]
    GaussSeidel,
    /// All see what the others were, and go this fraction of their way.
    Jacobi {
        /// The fraction.
        damping: f64,
    },
}

/// When a new choice of atoms replaces the one before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Acceptance {
    /// If it lowers the squared error more than new coefficients of the old atoms do.
    #[default]
    Better,
    /// Always.
    Always,
}

impl Options {
    /// The settings of the paper: two levels, orthogonal matching pursuit with 25 atoms for each
    /// coordinate out of monomials and 55 shape functions, always accepted.
    ///
    /// How many sweeps it makes is not said; it stops as soon as one does not lower the error.
    ///
    /// # Reference
    /// [Wang2016] Alg. 1, §4.1, §4.2.
    pub const PAPER: Self = Self {
        local: Local::Sparse {
            dictionary: DictionaryKind::AllShapes,
            sparsity: 25,
            selection: Selection::Omp,
            components: Components::Each,
        },
        levels: 2,
        gate: Gate::Free,
        smooth_charts: Vec::new(),
        order: SweepOrder::GaussSeidel,
        acceptance: Acceptance::Always,
        sweeps: 10,
        frozen_sweeps: 0,
        least_progress: 0.0,
    };
}

impl Default for Options {
    fn default() -> Self {
        Self {
            local: Local::Sparse {
                dictionary: DictionaryKind::default(),
                sparsity: 25,
                selection: Selection::default(),
                components: Components::default(),
            },
            levels: 3,
            gate: Gate::default(),
            smooth_charts: Vec::new(),
            order: SweepOrder::default(),
            acceptance: Acceptance::default(),
            sweeps: 4,
            frozen_sweeps: 20,
            least_progress: 0.005,
        }
    }
}
