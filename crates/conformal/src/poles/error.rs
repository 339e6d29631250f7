//! Why a surface with poles has no form of the kind asked for.

use super::search::LEAST_FLUX;

/// Why a surface with poles has no form of the kind asked for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PolesError {
    /// There are fewer than two holes.
    #[error(
        "the surface has {holes} holes, and fluxes between holes need two; \
         name more vertices, or lay the surface out without poles"
    )]
    TooFew {
        /// Boundary loops and poles together.
        holes: usize,
    },
    /// Another number of class entries than of classes.
    #[error("{given} class entries are given for a surface of genus {genus}; give {needed}")]
    ClassCount {
        /// How many were given.
        given: usize,
        /// How many are needed.
        needed: usize,
        /// Number of handles.
        genus: usize,
    },
    /// Another number of fluxes than of holes, or one that is not finite.
    #[error("{given} finite fluxes are given for {holes} holes; give one for each")]
    FluxCount {
        /// How many finite ones were given.
        given: usize,
        /// Boundary loops and poles together.
        holes: usize,
    },
    /// Fluxes that do not sum to zero.
    #[error(
        "the fluxes sum to {sum}; what flows into one hole has to flow out of others: give fluxes of sum 0"
    )]
    Unbalanced {
        /// Their sum.
        sum: f64,
    },
    /// A flux that is too small.
    #[error(
        "hole {hole} has flux {flux}, less than {LEAST_FLUX} of the largest one, {largest}; \
         such a hole swallows a zero: give it more, or leave it out"
    )]
    Weak {
        /// The hole.
        hole: usize,
        /// Its flux.
        flux: f64,
        /// The largest flux.
        largest: f64,
    },
    /// Every form tried has another number of zeros than the topology asks for.
    #[error(
        "the form has {found} zeros inside instead of {expected}: some lie on the loops of holes; \
         choose other vertices, or other fluxes"
    )]
    Zeros {
        /// Zeros found, with their orders.
        found: i64,
        /// `2g - 2 + b` for genus `g` and `b` holes.
        expected: i64,
    },
    /// No class has a form all of whose fluxes are large enough.
    #[error("no form with large enough fluxes was found; choose other vertices, or another seed")]
    NoForm,
}
