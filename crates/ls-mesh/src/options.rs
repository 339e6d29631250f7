//! What a fit is asked for.

/// Options of [`fit`](crate::fit).
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Which vertices are controls.
    pub controls: ControlChoice,
    /// How controls are selected, where they are not given.
    pub selection: Selection,
    /// How strictly the surface passes through its controls.
    pub constraints: Constraints,
}

/// Which vertices are controls.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ControlChoice {
    /// The fit selects them.
    Selected {
        /// How many.
        count: usize,
    },
    /// These vertices, in this order.
    Given(Vec<u32>),
}

/// How controls are selected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Selection {
    /// One control per solve, at the vertex of largest error.
    Greedy,
    /// Equal numbers of controls per solve, at the largest local maxima of the error.
    Combined {
        /// Number of solves that the selection is spread over; more are made only where the error
        /// has fewer local maxima than controls are due.
        solves: usize,
    },
}

/// How strictly the surface passes through its controls.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Constraints {
    /// In the sense of least squares.
    Soft {
        /// Weight of a control's row beside the rows of the graph Laplacian.
        weight: f64,
    },
    /// Exactly; the other vertices minimise the Laplacian.
    Hard,
}

impl Options {
    /// The settings of the comparison in the paper, for its Dragon of 4,903 controls.
    ///
    /// Neither this paper nor the one it follows says how many solves a selection takes.
    ///
    /// # Reference
    /// [Hou2017] Eq. (14), §8.1, Figure 4.
    pub const PAPER: Self = Self {
        controls: ControlChoice::Selected { count: 4903 },
        selection: Selection::Combined { solves: 40 },
        constraints: Constraints::Soft { weight: 1.0 },
    };
}

impl Default for Options {
    /// Returns the settings of the paper with 1,000 controls.
    fn default() -> Self {
        Self {
            controls: ControlChoice::Selected { count: 1000 },
            ..Self::PAPER
        }
    }
}
