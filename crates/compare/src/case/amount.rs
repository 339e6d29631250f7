//! Numbers of vertices, as counts or percentages.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// A number of vertices, or a fraction of them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Amount {
    /// So many vertices.
    Count(usize),
    /// This fraction of the vertices, rounded to the nearest count; at least one unless it is zero.
    Fraction(f64),
}

/// Why an amount makes no sense.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AmountError {
    /// Neither `1500` nor `3%`.
    #[error("`{text}` is neither a count such as 1500 nor a percentage such as 3%")]
    Unreadable {
        /// What was given.
        text: String,
    },
    /// Nothing at all.
    #[error("{asked} of {vertices} vertices is none; ask for at least one")]
    Zero {
        /// What was given.
        asked: Amount,
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// More than there are.
    #[error(
        "{asked} is more than the {vertices} vertices of the mesh; ask for at most {vertices} or 100%"
    )]
    TooMany {
        /// What was given.
        asked: Amount,
        /// Vertices of the mesh.
        vertices: usize,
    },
}

impl Amount {
    /// Returns the count this amount stands for on a mesh of `vertices` vertices.
    ///
    /// # Errors
    /// A count of zero, or more than there are vertices.
    pub fn of(self, vertices: usize) -> Result<usize, AmountError> {
        let count = match self {
            Self::Count(count) => count,
            Self::Fraction(fraction) if fraction > 1.0 => usize::MAX,
            Self::Fraction(fraction) if fraction > 0.0 => {
                ((fraction * vertices as f64).round() as usize).max(1)
            }
            Self::Fraction(_) => 0,
        };
        match count {
            0 => Err(AmountError::Zero {
                asked: self,
                vertices,
            }),
            _ if count > vertices => Err(AmountError::TooMany {
                asked: self,
                vertices,
            }),
            _ => Ok(count),
        }
    }
}

impl fmt::Display for Amount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count(count) => write!(f, "{count}"),
            Self::Fraction(fraction) => write!(f, "{}%", (fraction * 1e8).round() / 1e6),
        }
    }
}

impl FromStr for Amount {
    type Err = AmountError;

    fn from_str(text: &str) -> Result<Self, AmountError> {
        let unreadable = || AmountError::Unreadable {
            text: text.to_owned(),
        };
        let Some(percent) = text.trim().strip_suffix('%') else {
            return text
                .trim()
                .parse()
                .map(Self::Count)
                .map_err(|_| unreadable());
        };
        let percent: f64 = percent.trim().parse().map_err(|_| unreadable())?;
        if !percent.is_finite() || percent < 0.0 {
            return Err(unreadable());
        }
        Ok(Self::Fraction(percent / 100.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_are_read_as_counts_or_percentages() {
        assert_eq!("1500".parse(), Ok(Amount::Count(1500)));
        assert_eq!("3%".parse(), Ok(Amount::Fraction(0.03)));
        assert_eq!("0.5 %".parse(), Ok(Amount::Fraction(0.005)));
        for text in ["", "%", "-3%", "nan%", "3.5", "-1", "many"] {
            assert!(text.parse::<Amount>().is_err(), "{text} must be refused");
        }
    }

    #[test]
    fn amounts_stay_between_one_and_all_vertices() {
        assert_eq!(Amount::Fraction(0.03).of(10_044), Ok(301));
        assert_eq!(Amount::Fraction(1.0).of(7), Ok(7));
        assert_eq!(Amount::Fraction(0.001).of(7), Ok(1));
        assert_eq!(Amount::Count(7).of(7), Ok(7));
        for bad in [Amount::Count(0), Amount::Fraction(0.0)] {
            assert!(matches!(bad.of(7), Err(AmountError::Zero { .. })));
        }
        for bad in [
            Amount::Count(8),
            Amount::Fraction(1.01),
            Amount::Fraction(1e300),
        ] {
            assert!(matches!(bad.of(7), Err(AmountError::TooMany { .. })));
        }
    }

    #[test]
    fn a_refused_amount_says_what_to_ask_for() {
        let error = Amount::Count(8).of(7).expect_err("too many").to_string();
        assert_eq!(
            error,
            "8 is more than the 7 vertices of the mesh; ask for at most 7 or 100%"
        );
        let error = Amount::Fraction(0.0).of(7).expect_err("none").to_string();
        assert_eq!(error, "0% of 7 vertices is none; ask for at least one");
    }
}
