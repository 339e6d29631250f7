//! Verdicts: our figures against the printed ones, and against our own of before.
//!
//! Only a real model is judged against what a paper prints. On a stand-in or a generated surface
//! our own recorded value must not get worse. Times are shown as ratios and never judged.

use msplines_common::metrics::VertexError;
use serde::{Deserialize, Serialize};

use crate::experiment::{Property, Row};
use crate::models::Provenance;
use crate::record::Record;

/// Ours against the printed error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Within the tolerance of the printed value.
    Reproduced,
    /// Smaller than printed by more than the tolerance.
    Better,
    /// Larger than printed by more than the tolerance.
    Worse,
    /// Another model than the paper's, or nothing printed.
    NotComparable,
    /// Not run, which is no failure.
    NotRun,
    /// Crashed, out of time, or refused.
    Failed,
}

impl Verdict {
    /// Returns what tables say.
    #[must_use]
    pub fn text(self) -> &'static str {
        match self {
            Self::Reproduced => "reproduced",
            Self::Better => "better",
            Self::Worse => "worse",
            Self::NotComparable => "not comparable",
            Self::NotRun => "not run",
            Self::Failed => "failed",
        }
    }
}

/// Ours against our own recorded value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Regression {
    /// Nothing is recorded.
    NotRecorded,
    /// Not worse than recorded, within its tolerance.
    Kept,
    /// Better than recorded by more than the tolerance: record the new value.
    Improved,
    /// Worse than recorded by more than the tolerance.
    Regressed,
}

/// A value of a record and what it must not exceed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bound {
    /// Where it stands in the record, such as `error.max`.
    pub quantity: String,
    /// The bound, where there is one.
    pub at_most: Option<f64>,
    /// The value, where the record has it.
    pub value: Option<f64>,
}

impl Bound {
    /// Returns whether the value is there and not above the bound.
    #[must_use]
    pub fn holds(&self) -> bool {
        let within = |value: f64| self.at_most.is_none_or(|bound| value <= bound);
        self.value.is_some_and(within)
    }

    /// Returns what is wrong, where the bound does not hold.
    fn missed(&self) -> Option<String> {
        let value = self
            .value
            .map_or("missing".to_owned(), |value| format!("{value:e}"));
        let bound = self
            .at_most
            .map_or_else(String::new, |bound| format!(", not at most {bound:e}"));
        (!self.holds()).then(|| format!("{} is {value}{bound}", self.quantity))
    }
}

/// What a row measured of a property of a spline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PropertyCheck {
    /// The property.
    pub property: String,
    /// The spline that has it or not.
    pub spline: String,
    /// The number by which it does.
    pub bound: Bound,
}

/// All that is said about the figures of one row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Judgement {
    /// Ours against the printed error.
    pub verdict: Verdict,
    /// Our error over the printed one; also where it is not comparable.
    pub ratio: Option<f64>,
    /// Ours against our own.
    pub regression: Regression,
    /// Our error over our recorded one.
    pub recorded_ratio: Option<f64>,
    /// Whether the claim of being more accurate than another row holds, where one is made and
    /// both rows ran.
    pub claim_holds: Option<bool>,
    /// The bounds of `at_most`.
    pub bounds: Vec<Bound>,
    /// The properties that the row was to measure, where it ran.
    pub properties: Vec<PropertyCheck>,
    /// Whether the row has an analysis.
    pub explained: bool,
}

impl Judgement {
    /// Judges a finished row.
    #[must_use]
    pub fn of(row: &Row, provenance: Provenance, record: &Record) -> Self {
        let mut judgement = Self::of_error(row, provenance, record.error.as_ref());
        let bounds = row.at_most.iter().map(|(quantity, &at_most)| Bound {
            quantity: quantity.clone(),
            at_most: Some(at_most),
            value: record.number(quantity),
        });
        judgement.bounds = bounds.collect();
        judgement
    }

    /// Judges the properties that the row `id` was to measure.
    pub fn judge_properties(&mut self, id: &str, properties: &[Property], record: &Record) {
        let all = properties.iter().flat_map(|property| {
            let of_row = property.measured.iter().filter(|(_, m)| m.row == id);
            of_row.map(|(spline, measured)| PropertyCheck {
                property: property.name.clone(),
                spline: spline.clone(),
                bound: Bound {
                    quantity: measured.value.clone(),
                    at_most: measured.at_most,
                    value: record.number(&measured.value),
                },
            })
        });
        self.properties = all.collect();
    }

    fn of_error(row: &Row, provenance: Provenance, error: Option<&VertexError>) -> Self {
        let mut judgement = Self::without_figures(row, Verdict::NotComparable);
        judgement.ratio = error.and_then(|error| ratio_to_printed(row, error));
        if let (Provenance::Real, Some(ratio)) = (provenance, judgement.ratio) {
            judgement.verdict = match ratio {
                _ if ratio < 1.0 - row.tolerance => Verdict::Better,
                _ if ratio > 1.0 + row.tolerance => Verdict::Worse,
                _ => Verdict::Reproduced,
            };
        }
        if let (Some(recorded), Some(error)) = (row.recorded, error) {
            let ratio = error.mean / recorded.error;
            judgement.recorded_ratio = Some(ratio);
            judgement.regression = match ratio {
                _ if ratio < 1.0 - recorded.tolerance => Regression::Improved,
                // Written so that a ratio that is not a number counts as regressed.
                _ if ratio <= 1.0 + recorded.tolerance => Regression::Kept,
                _ => Regression::Regressed,
            };
        }
        judgement
    }

    /// Returns the judgement of a row that gave no figures.
    #[must_use]
    pub fn without_figures(row: &Row, verdict: Verdict) -> Self {
        Self {
            verdict,
            ratio: None,
            regression: Regression::NotRecorded,
            recorded_ratio: None,
            claim_holds: None,
            bounds: Vec::new(),
            properties: Vec::new(),
            explained: !row.analysis.trim().is_empty(),
        }
    }

    /// Returns why this row makes the whole run end with an error, if it does.
    #[must_use]
    pub fn failure(&self) -> Option<String> {
        let differs = matches!(self.verdict, Verdict::Better | Verdict::Worse);
        let why = match self.missed() {
            _ if self.verdict == Verdict::Failed => "failed",
            _ if self.regression == Regression::Regressed => "worse than our recorded value",
            Some(missed) => return Some(missed),
            None if self.claim_holds == Some(false) => "not more accurate than it should be",
            None if differs && !self.explained => "differs from the paper without an analysis",
            None => return None,
        };
        Some(why.to_owned())
    }

    /// Returns the first bound or property that does not hold.
    fn missed(&self) -> Option<String> {
        let of_bound = self.bounds.iter().find_map(Bound::missed);
        of_bound.or_else(|| {
            self.properties.iter().find_map(|check| {
                let missed = check.bound.missed()?;
                Some(format!("{} of {}: {missed}", check.property, check.spline))
            })
        })
    }
}

/// Returns our error over the printed one; for decibels, the ratio of root mean squares.
fn ratio_to_printed(row: &Row, error: &VertexError) -> Option<f64> {
    match (row.printed.error, row.printed.psnr_db, error.psnr_db) {
        (Some(printed), _, _) => Some(error.mean / printed),
        (None, Some(printed), Some(ours)) => Some(10f64.powf((printed - ours) / 20.0)),
        _ => None,
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::experiment::tests::parse_with;
    use crate::experiment::{Experiment, Recorded};
    use crate::record::tests::sample;

    pub(crate) fn row(printed: Option<f64>, recorded: Option<f64>, analysis: &str) -> Row {
        let text = "schema = \"msplines.experiment/1\"\npaper = \"p\"\nitem = \"i\"\ntitle = \
                    \"t\"\n[[row]]\nid = \"a\"\nlabel = \"A\"\nmethod = \"biharmonic\"\nmodel = \
                    \"m\"\nknots = \"5\"\n";
        let mut row = Experiment::parse(text, "p/i.toml")
            .expect("a good row")
            .rows
            .remove(0);
        row.printed.error = printed;
        row.tolerance = 0.1;
        row.recorded = recorded.map(|error| Recorded {
            error,
            tolerance: 0.05,
        });
        row.analysis = analysis.to_owned();
        row
    }

    pub(crate) fn error(mean: f64) -> VertexError {
        let kind = "vertices".to_owned();
        VertexError {
            kind,
            mean,
            rms: mean,
            max: mean,
            scale: 1.0,
            psnr_db: Some(30.0),
        }
    }

    fn verdict(ours: f64) -> Verdict {
        Judgement::of_error(
            &row(Some(1.0), None, ""),
            Provenance::Real,
            Some(&error(ours)),
        )
        .verdict
    }

    #[test]
    fn a_real_model_is_judged_on_both_sides_of_the_tolerance() {
        assert_eq!(verdict(0.89), Verdict::Better);
        assert_eq!(verdict(0.91), Verdict::Reproduced);
        assert_eq!(verdict(1.09), Verdict::Reproduced);
        assert_eq!(verdict(1.11), Verdict::Worse);
    }

    #[test]
    fn a_difference_fails_only_without_an_analysis() {
        for ours in [0.5, 2.0] {
            let judge = |analysis: &str| {
                Judgement::of_error(
                    &row(Some(1.0), None, analysis),
                    Provenance::Real,
                    Some(&error(ours)),
                )
                .failure()
            };
            assert!(judge("").is_some() && judge(" \n").is_some());
            assert_eq!(judge("their mesh is finer"), None);
        }
        assert_eq!(
            Judgement::of_error(
                &row(Some(1.0), None, ""),
                Provenance::Real,
                Some(&error(1.0))
            )
            .failure(),
            None
        );
    }

    #[test]
    fn a_stand_in_is_never_judged_against_the_paper() {
        let judgement = Judgement::of_error(
            &row(Some(1.0), None, ""),
            Provenance::StandIn,
            Some(&error(9.0)),
        );
        assert_eq!(judgement.verdict, Verdict::NotComparable);
        assert_eq!(judgement.ratio, Some(9.0));
        assert_eq!(judgement.failure(), None);
    }

    #[test]
    fn an_analysis_does_not_excuse_a_regression() {
        let judge = |ours: f64| {
            Judgement::of_error(
                &row(None, Some(1.0), "why"),
                Provenance::StandIn,
                Some(&error(ours)),
            )
        };
        assert_eq!(judge(0.94).regression, Regression::Improved);
        assert_eq!(judge(1.04).regression, Regression::Kept);
        assert_eq!(judge(1.06).regression, Regression::Regressed);
        assert!(judge(1.06).failure().is_some() && judge(f64::NAN).failure().is_some());
        assert_eq!(judge(0.94).failure(), None);
    }

    #[test]
    fn six_decibels_are_a_factor_of_two() {
        let mut row = row(None, None, "");
        row.printed.psnr_db = Some(24.0);
        let ratio = Judgement::of_error(&row, Provenance::StandIn, Some(&error(1.0)))
            .ratio
            .expect("a ratio");
        assert!((ratio - 0.501).abs() < 1e-3, "{ratio}");
    }

    #[test]
    fn what_did_not_run_is_no_failure_but_a_crash_is() {
        let row = row(Some(1.0), None, "");
        assert_eq!(
            Judgement::without_figures(&row, Verdict::NotRun).failure(),
            None
        );
        assert!(
            Judgement::without_figures(&row, Verdict::Failed)
                .failure()
                .is_some()
        );
    }

    #[test]
    fn a_bound_fails_where_the_value_exceeds_it_or_is_missing() {
        let judge = |quantity: &str, at_most: f64| {
            let mut row = row(None, None, "");
            row.at_most.insert(quantity.to_owned(), at_most);
            Judgement::of(&row, Provenance::Generated, &sample()).failure()
        };
        assert_eq!(judge("error.max", 0.001), None);
        let text = judge("error.max", 0.000_9).expect("exceeded");
        assert_eq!(text, "error.max is 1e-3, not at most 9e-4");
        let text = judge("checks.none", 1.0).expect("missing");
        assert_eq!(text, "checks.none is missing, not at most 1e0");
    }

    #[test]
    fn a_property_fails_the_row_that_measured_it_and_no_other() {
        let text = "[[property]]\nname = \"unity\"\nmeasured = { \"B\" = { row = \"a\", value = \
                    \"error.max\", at_most = 9e-4 } }\n";
        let properties = parse_with("", text).expect("a property").properties;
        let judge = |id: &str| {
            let mut judgement = Judgement::of(&row(None, None, ""), Provenance::Real, &sample());
            judgement.judge_properties(id, &properties, &sample());
            judgement.failure()
        };
        let missed = "unity of B: error.max is 1e-3, not at most 9e-4";
        assert_eq!(judge("a").as_deref(), Some(missed));
        assert_eq!(judge("b"), None);
    }
}
