//! Functions of single charts in spline files.

use msplines_sparse_manifold::{DictionaryKind, LocalFunction, Star};
use serde::{Deserialize, Serialize};

use crate::error::SplineFileError;

/// The function of a chart, a height above it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredLocal {
    /// Number of sectors of the closed star.
    pub valence: u32,
    /// What it is made of.
    pub dictionary: DictionaryKind,
    /// Largest degree of monomials.
    pub degree: u32,
    /// Numbers of its atoms, in the order in which they were chosen.
    pub atoms: Vec<u16>,
    /// Coefficient of each.
    pub coefficients: Vec<f64>,
}

impl StoredLocal {
    /// Returns the stored form of a function.
    #[must_use]
    pub fn of(function: &LocalFunction) -> Self {
        let (dictionary, degree) = function.made_of();
        Self {
            valence: function.star().valence,
            dictionary,
            degree,
            atoms: function.support().to_vec(),
            coefficients: function.coefficients().to_vec(),
        }
    }

    /// Returns the function.
    ///
    /// # Errors
    /// Atoms or coefficients that are none.
    pub fn restore(&self) -> Result<LocalFunction, SplineFileError> {
        let star = Star {
            sectors: self.valence,
            valence: self.valence,
        };
        Ok(LocalFunction::from_parts(
            star,
            self.dictionary,
            self.degree,
            self.atoms.clone(),
            self.coefficients.clone(),
        )?)
    }
}
