//! The explicit representation: control points and localised basis functions.
//!
//! A spline is `f = Σ_j λ_j ψ_j`, with one control point `λ_j` and one basis function `ψ_j` for each
//! knot. The functions sum to one, and each is close to zero beyond the second ring of Voronoi cells
//! around its knot, so that moving a control point changes the spline near its knot.
//!
//! # Notation
//! `ψ = H P`: the functions are combined from the splines `H e_k` that are 1 at one knot and 0 at all
//! others, by a sparse matrix `P` (K × K, column `j` for `ψ_j`). `H 1 = 1`, so they sum to one exactly
//! if the rows of `P` do. The values of a spline at the knots are `p = P λ`.
//!
//! # Reference
//! [Hou2017] §3.2, §7.2. Deviation: functions are combined from the localised `H e_k`, not from Green's
//! functions by difference masks (kept as [`BasisKind::DifferenceMasks`]), which lose the partition of
//! unity on triangle meshes.

mod columns;
mod convert;
mod error;
mod functions;
mod joint;
mod masks;
mod mixture;
mod quadratic;
mod small;
mod sparse;
#[cfg(test)]
mod tests;

use std::ops::ControlFlow;
use std::sync::Arc;

use msplines_common::linalg::Cholesky;
use msplines_common::progress::{Observer, Outcome, Progress};
use serde::{Deserialize, Serialize};

pub use error::ExplicitError;
pub use functions::{LocalFunctions, Locality};
pub use sparse::SparseColumns;

use crate::Space;
use crate::fit::checked_knots;
use crate::knot_values::KnotValues;
use crate::rings::Rings;
use columns::LocalColumns;
use joint::{Joint, NEIGHBOUR_SHARE, ROUNDS, neighbour_matrix};
use masks::Masks;
use mixture::Mixture;

/// Condition of `P` beyond which control points would lie far off the surface; 3 to 7 is usual.
const LARGEST_CONDITION: f64 = 7.5;

/// How often bounds are raised where the condition is larger; each time takes a round. Of twelve samples
/// of scattered vertices three times were not enough for four.
const MOST_RAISES: u32 = 8;

/// Difference masks may take so many numbers at once: 2 GB.
const LARGEST_GREEN: usize = 1 << 28;

/// How basis functions are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BasisKind {
    /// Combinations over the second ring of knots, all optimised together: 0.5 % of the mass of a
    /// function lies outside the second ring of cells where knots are spread evenly, 1 % where they
    /// are optimised.
    #[default]
    JointQp,
    /// A fixed share of each control point goes to the neighbours: no optimisation, the smallest
    /// condition, two to four times the mass outside of the second ring.
    Neighbour {
        /// The share `β`, at least 0 and below 0.5; 0.35 is a good one.
        beta: f64,
    },
    /// `H e_k` themselves: control points are the values at the knots.
    Cardinal,
    /// Green's functions combined by difference masks: as the paper says, and for comparison only.
    DifferenceMasks {
        /// Rings of knots that a mask reaches, 2 or 3.
        rings: u32,
    },
}

impl BasisKind {
    /// The construction of the paper.
    ///
    /// # Reference
    /// [Hou2017] Eq. (3), §7.2.
    pub const PAPER: Self = Self::DifferenceMasks { rings: 2 };

    /// A share of the neighbours that gives well localised functions without optimisation.
    pub const NEIGHBOUR: Self = Self::Neighbour {
        beta: NEIGHBOUR_SHARE,
    };
}

/// The basis functions of all splines with some knots.
///
/// Building one costs a solve per knot, plus, for [`BasisKind::JointQp`], 10 to 20 sparse factorisations
/// of size K in each of 4 to 12 rounds. Every conversion is then a solve or two, whatever the number of components.
#[derive(Debug)]
pub struct ExplicitBasis {
    space: Arc<Space>,
    knots: Vec<u32>,
    kind: BasisKind,
    rings: Rings,
    factor: Arc<Cholesky>,
    rule: Rule,
    outcome: Outcome,
}

#[derive(Debug)]
enum Rule {
    Mixture(Mixture),
    Masks(Box<Masks>),
}

impl ExplicitBasis {
    /// Builds the basis of the splines in a space with these knots, in any order.
    ///
    /// The observer sees the phase `basis`, counted in knots; there is no basis if it breaks.
    ///
    /// # Reference
    /// [Hou2017] Eq. (3), Eq. (6), Theorem 1. Deviation: see [`BasisKind`].
    ///
    /// # Errors
    /// Knots that are none, or a kind that does not exist for this space.
    pub fn build(
        space: &Arc<Space>,
        knots: &[u32],
        kind: BasisKind,
        observer: &mut Observer<'_>,
    ) -> Result<Self, ExplicitError> {
        let knots = checked_knots(space.mesh().vertex_count(), knots)?;
        check_kind(space, knots.len(), kind)?;
        let rings = Rings::build(space.mesh(), &knots);
        let system = KnotValues::factor(space, knots.clone())?;
        let mut outcome = Outcome::Converged;
        let rule = match kind {
            BasisKind::Cardinal => Rule::Mixture(Mixture::build(neighbour_matrix(&rings, 0.0))?),
            BasisKind::Neighbour { beta } => {
                Rule::Mixture(Mixture::build(neighbour_matrix(&rings, beta))?)
            }
            BasisKind::JointQp => {
                let (mixture, converged) = joint(&system, &rings, observer)?;
                if !converged {
                    outcome = Outcome::MaxIterations;
                }
                Rule::Mixture(mixture)
            }
            BasisKind::DifferenceMasks { rings: stencil } => {
                Rule::Masks(Box::new(Masks::build(space, &knots, &rings, stencil)?))
            }
        };
        Ok(Self {
            space: Arc::clone(space),
            factor: system.shared_factor(),
            knots,
            kind,
            rings,
            rule,
            outcome,
        })
    }

    /// Returns, for every vertex of the mesh, the index of the knot whose Voronoi cell it lies in.
    #[must_use]
    pub fn cells(&self) -> &[u32] {
        self.rings.cells()
    }

    /// Returns the knots, ascending vertices; function `j` belongs to knot `j`.
    #[must_use]
    pub fn knots(&self) -> &[u32] {
        &self.knots
    }

    /// Returns how the functions are made.
    #[must_use]
    pub fn kind(&self) -> BasisKind {
        self.kind
    }

    /// Returns the space of the splines.
    #[must_use]
    pub fn space(&self) -> &Arc<Space> {
        &self.space
    }

    /// Returns whether the optimisation found its minimum; without one it is converged.
    ///
    /// Any basis is valid: what a minimum missed costs is locality.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        self.outcome
    }

    /// Returns the matrix `P` from control points to values at the knots; difference masks have none.
    #[must_use]
    pub fn mixture(&self) -> Option<&SparseColumns> {
        match &self.rule {
            Rule::Mixture(mixture) => Some(mixture.matrix()),
            Rule::Masks(_) => None,
        }
    }

    /// Returns the condition number of what gives control points: of `P`, estimated from below, or of
    /// the matrix `Ñ` of difference masks.
    #[must_use]
    pub fn condition(&self) -> f64 {
        match &self.rule {
            Rule::Mixture(mixture) => mixture.condition(),
            Rule::Masks(masks) => masks.condition(),
        }
    }

    fn system(&self) -> Result<KnotValues<'_>, ExplicitError> {
        let factor = Arc::clone(&self.factor);
        Ok(KnotValues::with_factor(
            &self.space,
            self.knots.clone(),
            factor,
        )?)
    }

    fn check_function(&self, index: usize) -> Result<(), ExplicitError> {
        let knots = self.knots.len();
        if index < knots {
            Ok(())
        } else {
            Err(ExplicitError::NoSuchControlPoint { index, knots })
        }
    }
}

/// Returns the joint `P`, and whether it is optimal.
fn joint(
    system: &KnotValues<'_>,
    rings: &Rings,
    observer: &mut Observer<'_>,
) -> Result<(Mixture, bool), ExplicitError> {
    let total = rings.len() as u64;
    let mut report =
        |done: u64| -> ControlFlow<()> { observer(&Progress::new("basis", done, total)) };
    let columns = LocalColumns::build(system, rings, |done| report(done as u64));
    let columns = columns.ok_or(ExplicitError::Stopped)?;
    let mut joint = Joint::start(rings, &columns);
    let mut round = |joint: &mut Joint<'_>| {
        if report(total).is_break() {
            return Err(ExplicitError::Stopped);
        }
        Ok(joint.round()?)
    };
    for _ in 0..ROUNDS {
        round(&mut joint)?;
    }
    let mut mixture = Mixture::build(joint.matrix())?;
    for _ in 0..MOST_RAISES {
        if mixture.condition() <= LARGEST_CONDITION {
            break;
        }
        joint.hold(&mixture.weakest());
        round(&mut joint)?;
        mixture = Mixture::build(joint.matrix())?;
    }
    Ok((mixture, joint.converged()))
}

fn check_kind(space: &Space, knots: usize, kind: BasisKind) -> Result<(), ExplicitError> {
    match kind {
        BasisKind::Neighbour { beta } if !(0.0..0.5).contains(&beta) => {
            Err(ExplicitError::Share { share: beta })
        }
        BasisKind::DifferenceMasks { .. } if !space.creases().is_empty() => {
            Err(ExplicitError::Creases)
        }
        BasisKind::DifferenceMasks { rings } if !(1..=8).contains(&rings) => {
            Err(ExplicitError::Rings { rings })
        }
        BasisKind::DifferenceMasks { .. } => {
            let vertices = space.mesh().vertex_count();
            let numbers = vertices * knots;
            if numbers > LARGEST_GREEN {
                return Err(ExplicitError::TooLarge {
                    vertices,
                    knots,
                    numbers,
                });
            }
            Ok(())
        }
        _ => Ok(()),
    }
}
