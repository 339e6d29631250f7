//! Choosing knots: a dense sample, backward elimination, then exchange; or other ways to compare with.
//! Where the largest error matters more than a small rise of the mean, a polish follows.
//!
//! # Notation
//! `r = S - f` the residual, `C` the weights of the vertices. A knot `i` can go at the cost
//! `ΔE_i = |w_i|² / D_i`, with `D = diag(S_T (Hᵀ C² H)⁻¹ S_T)` and `S_T` the Schur complement of `B` on
//! the knots: this is the exact increase of the squared error when it alone is removed and all others
//! are fitted again. A vertex `j` can come with the gain `g_j² / |C B_ZZ⁻¹ e_j|²`,
//! `g = B_ZZ⁻¹ (C² r)_Z`. Both denominators are diagonals of huge matrices. The first is estimated from
//! what the knots near a knot see of each other ([`crate::gram`]), the second with random signs.
//!
//! # Reference
//! [Hou2017] §6. Deviation: exact leave-one-out scores instead of reweighted l1 (Eq. 9, 10), at a
//! small fraction of the time and with the number of knots met exactly.

mod cross_validation;
mod eliminate;
mod exchange;
mod l1;
mod polish;
mod sample;
mod scores;
mod state;
pub(crate) mod voronoi;

use msplines_common::linalg::Mat;
use msplines_common::progress::{Observer, Outcome};

use crate::gram::{Gram, Sight};
use crate::knot_values::KnotValues;
use crate::target::Centred;
use crate::{Effort, FitError, Options, Selection, Space};

pub use cross_validation::Trial;
#[cfg(test)]
pub(crate) use scores::insertion_denominators;

use sample::Density;
use state::State;

/// Knots, and what the final fit starts from.
pub(crate) struct Selected<'a> {
    pub(crate) system: KnotValues<'a>,
    /// What preconditions the fit.
    pub(crate) gram: Gram,
    /// A spline to start it from.
    pub(crate) fitted: Option<Mat<f64>>,
    pub(crate) outcome: Outcome,
    pub(crate) eliminations: u32,
    pub(crate) exchanges: [u32; 2],
    pub(crate) polish_rounds: [u32; 2],
    pub(crate) l1_rounds: u32,
    /// What the user should know.
    pub(crate) warnings: Vec<String>,
    pub(crate) cross_validation: Vec<Trial>,
}

impl<'a> Selected<'a> {
    pub(crate) fn given(
        space: &'a Space,
        target: &Centred,
        knots: Vec<u32>,
        stopped: bool,
    ) -> Result<Self, FitError> {
        let system = KnotValues::factor(space, knots)?;
        let gram = Gram::on(space, &system, target, Sight::Ring)?;
        let outcome = if stopped {
            Outcome::Stopped
        } else {
            Outcome::Converged
        };
        Ok(Self {
            system,
            gram,
            fitted: None,
            outcome,
            eliminations: 0,
            exchanges: [0, 0],
            polish_rounds: [0, 0],
            l1_rounds: 0,
            warnings: Vec::new(),
            cross_validation: Vec::new(),
        })
    }
}

/// Where knots are many, so many vertices have one candidate beside them, and no more: factors for
/// many knots are small, but have no analysis in common. At 24,182 knots of 173,000 vertices 3.4
/// candidates a knot instead of 4 take half the time and leave 8 % more error.
const ENOUGH: usize = 3;

/// How much work an effort is.
struct Plan {
    /// Candidates per knot that elimination starts from.
    candidates: f64,
    /// Largest shares of the knots that the first and the last round eliminate.
    elimination: [f64; 2],
    /// Share of the knots that the first round exchanges.
    exchange: f64,
    /// Factor on this share after each round.
    cooling: f64,
    /// Most rounds of exchange.
    rounds: u32,
}

impl Plan {
    /// The trade-offs were measured on closed scans of 8,000 to 100,000 vertices; see the ledger.
    fn of(effort: Effort) -> Self {
        match effort {
            Effort::Fast => Self {
                candidates: 3.0,
                elimination: [0.25, 0.07],
                exchange: 0.08,
                cooling: 0.85,
                rounds: 1,
            },
            Effort::Standard => Self {
                candidates: 4.0,
                elimination: [0.3, 0.05],
                exchange: 0.08,
                cooling: 0.85,
                rounds: 3,
            },
            Effort::Best => Self {
                candidates: 4.0,
                elimination: [0.2, 0.04],
                exchange: 0.08,
                cooling: 0.9,
                rounds: 8,
            },
        }
    }
}

/// Chooses `count` knots for a target, fewer than there are vertices.
pub(crate) fn select<'a>(
    space: &'a Space,
    target: &'a Centred,
    count: usize,
    options: &Options,
    stopped: bool,
    observer: &mut Observer<'_>,
) -> Result<Selected<'a>, FitError> {
    let plan = Plan::of(options.effort);
    let mut run = Run { observer, stopped };
    let (mut eliminations, mut l1_rounds, mut warnings) = (0, 0, Vec::new());
    let mut state = match options.selection {
        Selection::Exchange => {
            let wanted = (count as f64 * plan.candidates).ceil() as usize;
            let enough = count + target.data.nrows() / ENOUGH;
            let candidates = if stopped { count } else { wanted.min(enough) };
            let candidates = candidates.min(target.data.nrows());
            let sample = sample::sample(space, target, candidates, count, options.seed);
            let mut state = State::start(space, target, sample, options.seed)?;
            eliminations = eliminate::eliminate(&mut state, count, plan.elimination, &mut run)?;
            state
        }
        Selection::L1 | Selection::L1Exchange => {
            let found = l1::reweighted_l1(space, target, count, options.seed, &mut run)?;
            l1_rounds = found.rounds;
            warnings.extend(found.warning());
            found.state
        }
        Selection::Curvature => sampled(space, target, count, Density::Curvature, options.seed)?,
        Selection::BlueNoise => sampled(space, target, count, Density::Even, options.seed)?,
    };
    let exchanges = match options.selection {
        Selection::Exchange | Selection::L1Exchange => {
            exchange::exchange(&mut state, &plan, &mut run)?
        }
        Selection::L1 | Selection::Curvature | Selection::BlueNoise => [0, 0],
    };
    let polish_rounds = if options.polish {
        polish::polish(&mut state, &mut run)?
    } else {
        [0, 0]
    };
    let outcome = if run.stopped {
        Outcome::Stopped
    } else {
        Outcome::Converged
    };
    let (system, gram, fitted) = state.into_parts();
    Ok(Selected {
        system,
        gram,
        fitted: Some(fitted),
        outcome,
        eliminations,
        exchanges,
        polish_rounds,
        l1_rounds,
        warnings,
        cross_validation: Vec::new(),
    })
}

/// Returns the fit with the knots of a sample.
fn sampled<'a>(
    space: &'a Space,
    target: &'a Centred,
    count: usize,
    density: Density,
    seed: u64,
) -> Result<State<'a>, FitError> {
    let knots = sample::exact_sample(space, target, count, density, seed);
    State::start(space, target, knots, seed)
}

/// Chooses as many knots as noisy data can bear, and where.
pub(crate) fn select_cross_validated<'a>(
    space: &'a Space,
    target: &'a Centred,
    options: &Options,
    stopped: bool,
    observer: &mut Observer<'_>,
) -> Result<Selected<'a>, FitError> {
    let mut run = Run { observer, stopped };
    let trials = cross_validation::cross_validate(space, target, options, &mut run)?;
    let stopped = run.stopped;
    let count = cross_validation::best_count(&trials, 1);
    let selected = select(space, target, count, options, stopped, observer)?;
    Ok(Selected {
        cross_validation: trials,
        ..selected
    })
}

/// The observer and what it said so far.
struct Run<'a, 'b> {
    observer: &'a mut Observer<'b>,
    stopped: bool,
}

impl Run<'_, '_> {
    /// Reports a step and returns whether to stop.
    fn stop(&mut self, done: u64, total: u64, objective: f64) -> bool {
        use msplines_common::progress::Progress;
        let step = Progress::new("select", done, total).with_objective(objective);
        self.stopped |= (self.observer)(&step).is_break();
        self.stopped
    }
}
