//! Conformal atlases as runs are asked for them.

use std::fmt;
use std::str::FromStr;

use msplines_conformal::FormChoice;
use serde::{Deserialize, Serialize};

/// A conformal atlas with its options.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ConformalMethod {
    /// The form of a closed surface of genus >= 1, [`Form::Optimal`] where absent; surfaces of genus 0
    /// leave no choice.
    pub form: Option<Form>,
    /// Vertices whose stars are removed first.
    pub puncture: Vec<u32>,
}

/// Which holomorphic form is taken, as people name it: `optimal`, `integer`, `integer:1,0,0,1`,
/// `periods:0.5,1` or `coefficients:1,0`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Form {
    /// The one of most even length.
    #[default]
    Optimal,
    /// The most even one whose imaginary part has small integer periods.
    Integer,
    /// The one whose imaginary part has these periods.
    IntegerPeriods(Vec<i64>),
    /// The one whose real part has these periods over the loops of the homology.
    Periods(Vec<f64>),
    /// The one whose real part has these coefficients in the harmonic basis.
    Coefficients(Vec<f64>),
}

impl Form {
    /// Returns the choice for searches that start from `seed`.
    #[must_use]
    pub fn choice(&self, seed: u64) -> FormChoice {
        match self {
            Self::Optimal => FormChoice::Optimal { seed },
            Self::Integer => FormChoice::integer(seed),
            Self::IntegerPeriods(periods) => FormChoice::IntegerPeriods(periods.clone()),
            Self::Periods(periods) => FormChoice::Periods(periods.clone()),
            Self::Coefficients(coefficients) => FormChoice::Coefficients(coefficients.clone()),
        }
    }
}

/// No form is named so.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{text}` names no form; give optimal, integer, integer:N,... for periods of the imaginary part, periods:X,... or coefficients:X,... for the real part"
)]
pub struct FormError {
    /// What was given.
    pub text: String,
}

impl FromStr for Form {
    type Err = FormError;

    fn from_str(text: &str) -> Result<Self, FormError> {
        let unknown = || FormError {
            text: text.to_owned(),
        };
        let finite = |list: &str| {
            let numbers: Option<Vec<f64>> =
                list.split(',').map(|x| x.trim().parse().ok()).collect();
            numbers
                .filter(|numbers| numbers.iter().all(|x: &f64| x.is_finite()))
                .ok_or_else(unknown)
        };
        match text.trim().split_once(':') {
            None if text.trim() == "optimal" => Ok(Self::Optimal),
            None if text.trim() == "integer" => Ok(Self::Integer),
            Some(("integer", list)) => {
                let numbers: Result<Vec<i64>, _> =
                    list.split(',').map(|n| n.trim().parse()).collect();
                numbers.map(Self::IntegerPeriods).map_err(|_| unknown())
            }
            Some(("periods", list)) => finite(list).map(Self::Periods),
            Some(("coefficients", list)) => finite(list).map(Self::Coefficients),
            _ => Err(unknown()),
        }
    }
}

impl fmt::Display for Form {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let joined = |numbers: &[f64]| {
            let numbers: Vec<String> = numbers.iter().map(|x| format!("{x:?}")).collect();
            numbers.join(",")
        };
        match self {
            Self::Optimal => f.write_str("optimal"),
            Self::Integer => f.write_str("integer"),
            Self::IntegerPeriods(periods) => {
                let periods: Vec<String> = periods.iter().map(i64::to_string).collect();
                write!(f, "integer:{}", periods.join(","))
            }
            Self::Periods(periods) => write!(f, "periods:{}", joined(periods)),
            Self::Coefficients(numbers) => write!(f, "coefficients:{}", joined(numbers)),
        }
    }
}

impl TryFrom<String> for Form {
    type Error = FormError;

    fn try_from(text: String) -> Result<Self, FormError> {
        text.parse()
    }
}

impl From<Form> for String {
    fn from(form: Form) -> Self {
        form.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms_are_read_as_they_are_written() {
        for form in [
            Form::Optimal,
            Form::Integer,
            Form::IntegerPeriods(vec![1, 0, -2, 3]),
            Form::Periods(vec![0.1, -1e-300]),
            Form::Coefficients(vec![1.0, 1.0 / 3.0]),
        ] {
            assert_eq!(form.to_string().parse(), Ok(form));
        }
        for text in [
            "",
            "best",
            "periods:",
            "periods:1,nan",
            "integer:0.5",
            "optimal:1",
            "coefficients:1,,2",
        ] {
            let error = text.parse::<Form>().expect_err(text).to_string();
            assert!(error.contains("optimal, integer"), "{error}");
        }
    }

    #[test]
    fn seeds_reach_the_searches() {
        assert_eq!(Form::Integer.choice(7), FormChoice::integer(7));
        assert_eq!(Form::default().choice(3), FormChoice::Optimal { seed: 3 });
    }
}
