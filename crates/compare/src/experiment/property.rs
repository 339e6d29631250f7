//! Properties of splines: what a paper says that each kind has, and what rows measured of it.

use std::collections::BTreeSet;

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use super::ExperimentError;
use crate::record::path_problem;

/// One line of a matrix of properties; its columns are kinds of splines.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Property {
    /// What it is called; unique in its experiment.
    pub name: String,
    /// What the paper prints for each spline, in its order.
    #[serde(default)]
    pub printed: IndexMap<String, String>,
    /// What rows measured, by spline.
    #[serde(default)]
    pub measured: IndexMap<String, Measured>,
    /// What a reader should know about the line.
    #[serde(default)]
    pub remark: String,
}

/// A number of a row by which a spline has a property.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measured {
    /// The row.
    pub row: String,
    /// Where the number stands in its record, such as `checks.partition_of_unity`.
    pub value: String,
    /// What it must not exceed, above which the row fails; nothing is judged where absent.
    pub at_most: Option<f64>,
    /// What is said of it; [`Measured::VALUE`] stands for the number.
    #[serde(default = "bare")]
    pub says: String,
}

fn bare() -> String {
    Measured::VALUE.to_owned()
}

impl Measured {
    /// What stands for the number in [`Measured::says`].
    pub const VALUE: &'static str = "{value}";
}

/// Returns the splines of a matrix: those that any line prints in the order of the lines, then those
/// that are only measured.
#[must_use]
pub fn splines(properties: &[Property]) -> Vec<&str> {
    let printed = properties.iter().flat_map(|p| p.printed.keys());
    let measured = properties.iter().flat_map(|p| p.measured.keys());
    let mut splines: Vec<&str> = Vec::new();
    for name in printed.chain(measured) {
        if !splines.contains(&name.as_str()) {
            splines.push(name);
        }
    }
    splines
}

/// Checks that every property is named once, says something, and is measured by rows there are.
pub(super) fn check(
    properties: &[Property],
    has_row: impl Fn(&str) -> bool,
    file: &str,
) -> Result<(), ExperimentError> {
    let mut names = BTreeSet::new();
    for property in properties {
        let problem = if names.insert(&property.name) {
            property.problem(&has_row)
        } else {
            Some("two properties have this name; rename one".to_owned())
        };
        if let Some(problem) = problem {
            return Err(ExperimentError::Property {
                path: file.to_owned(),
                property: property.name.clone(),
                problem,
            });
        }
    }
    Ok(())
}

impl Property {
    fn problem(&self, has_row: impl Fn(&str) -> bool) -> Option<String> {
        if self.printed.is_empty() && self.measured.is_empty() {
            return Some("give `printed`, `measured` or both".to_owned());
        }
        self.measured.iter().find_map(|(spline, measured)| {
            let Measured { row, value, .. } = measured;
            let problem = if has_row(row) {
                path_problem(value)?
            } else {
                format!("names no row of this file: `{row}`")
            };
            Some(format!("measured for `{spline}`: {problem}"))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::parse_with;
    use super::splines;

    fn property(fields: &str) -> String {
        format!("[[property]]\nname = \"unity\"\n{fields}\n")
    }

    #[test]
    fn splines_stand_in_the_order_of_the_paper() {
        let first = property("printed = { \"Z\" = \"Yes\", \"B\" = \"No\", \"A\" = \"Yes\" }");
        let second = "[[property]]\nname = \"other\"\nprinted = { \"C\" = \"-\", \"A\" = \"No\" }\nmeasured = { \"M\" = { row = \"a\", value = \"dofs\", at_most = 1 } }\n";
        let text = format!("{first}{second}");
        let properties = parse_with("", &text).expect("good").properties;
        assert_eq!(splines(&properties), ["Z", "B", "A", "C", "M"]);
        assert_eq!(properties[1].measured["M"].says, "{value}");
        let json = serde_json::to_string(&properties).expect("JSON");
        let read: Vec<super::Property> = serde_json::from_str(&json).expect("read again");
        assert_eq!(splines(&read), ["Z", "B", "A", "C", "M"]);
    }

    #[test]
    fn a_restricted_experiment_keeps_what_its_rows_measure() {
        let measured =
            property("measured = { \"M\" = { row = \"a\", value = \"dofs\", at_most = 1 } }");
        let printed = "[[property]]\nname = \"other\"\nprinted = { \"A\" = \"No\" }\n";
        let mut experiment = parse_with("", &format!("{measured}{printed}")).expect("good");
        assert!(experiment.restrict("a"));
        assert_eq!(experiment.properties.len(), 1);
        assert!(!experiment.restrict("none"));
        assert!(experiment.properties.is_empty());
    }

    #[test]
    fn mistakes_in_properties_are_told_with_file_and_property() {
        let measured = |inner: &str| property(&format!("measured = {{ \"M\" = {{ {inner} }} }}"));
        let twice = property("printed = { \"A\" = \"Yes\" }").repeat(2);
        let bad = [
            (property(""), "property `unity`: give `printed`"),
            (twice, "property `unity`: two properties have this name"),
            (
                measured("row = \"b\", value = \"dofs\", at_most = 1"),
                "measured for `M`: names no row of this file: `b`",
            ),
            (
                measured("row = \"a\", value = \"check.unity\", at_most = 1"),
                "measured for `M`: no record has `check.unity`",
            ),
            (
                measured("row = \"a\", at_most = 1"),
                "missing field `value`",
            ),
        ];
        for (text, message) in bad {
            let error = parse_with("", &text).expect_err(message).to_string();
            assert!(
                error.contains(message) && error.contains("p/i.toml"),
                "{error}"
            );
        }
    }
}
