//! What a case may end with: a result that is finite and within bounds, or a refusal with place and remedy.

use std::fmt;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::process::{End, Ended};
use crate::error::exit;

/// Diagonals of the sound input's box beyond which a result is garbage: splines swing out a little where
/// data is missing, and a solve of a singular system a thousandfold.
const MARGIN: f64 = 3.0;
/// Digits of the longest number that a message may spell out: one of 64 bits, or a double to its last place.
const MOST_DIGITS: usize = 24;
/// Fields of records that have no number in some sound runs.
const OPTIONAL: [&str; 5] = [
    "log_variance",
    "co_closedness",
    "conjugation_defect",
    "c1_jump_cap_max",
    "c2_jump_cap_max",
];
/// Lists of a spline file in which some things have no number: vertices that lie on no cylinder.
const PARTIAL_LIST: &str = "vertices";
/// Words by which a message names a place, before a number.
const PLACES: [&str; 15] = [
    "vertex",
    "vertices",
    "face",
    "edge",
    "line",
    "row",
    "point",
    "points",
    "curve",
    "cell",
    "tetrahedron",
    "byte",
    "corner",
    "movement",
    "at (",
];
/// Words by which a message tells of all of an input.
const WHOLES: [&str; 7] = [
    "genus",
    "the surface",
    "stopped before",
    "has no ",
    "control points are fewer",
    "edges sharper",
    "membrane",
];
/// Words by which a message says what to do.
const REMEDIES: [&str; 36] = [
    "give ",
    "use ",
    "leave ",
    "remove ",
    "--repair",
    "choose ",
    "keep ",
    "raise ",
    "lower ",
    "try ",
    "check ",
    "merge ",
    "mend ",
    "cut ",
    "export ",
    "refine ",
    "close ",
    "--help",
    "write ",
    "name ",
    "take ",
    "fit ",
    "add ",
    "ask for ",
    "from 0",
    "join ",
    "replace ",
    "must ",
    "split ",
    "allow ",
    "reconstruct",
    "at least ",
    "at most ",
    "connect ",
    "correct ",
    "move ",
];

/// How a case ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// A result that is finite and within bounds.
    Accepted,
    /// The same, stopped early and marked.
    Stopped,
    /// A refusal of the command.
    Usage,
    /// A refusal of the input.
    Input,
    /// A refusal by the method.
    Method,
    /// Anything else, as the text says.
    Broken(String),
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Accepted => f.write_str("accepted"),
            Self::Stopped => f.write_str("accepted, stopped early"),
            Self::Usage => f.write_str("usage refused"),
            Self::Input => f.write_str("input refused"),
            Self::Method => f.write_str("method refused"),
            Self::Broken(fault) => write!(f, "BROKEN: {fault}"),
        }
    }
}

/// Where a result may lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    pub(super) inner: [[f64; 3]; 2],
}

impl Bounds {
    /// Returns bounds around the finite ones of these points.
    pub(super) fn around(points: impl Iterator<Item = [f64; 3]>) -> Self {
        let finite = points.filter(|p| p.iter().all(|x| x.is_finite()));
        let none = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        let inner = finite.fold(none, |[low, high], p| {
            [0, 1].map(|side| {
                [0, 1, 2].map(|d| {
                    if side == 0 {
                        p[d].min(low[d])
                    } else {
                        p[d].max(high[d])
                    }
                })
            })
        });
        Self { inner }
    }

    fn hold(&self, point: [f64; 3]) -> bool {
        let [low, high] = self.inner;
        let squares = (0..3).map(|d| (high[d] - low[d]).powi(2));
        let margin = MARGIN * squares.sum::<f64>().sqrt();
        (0..3).all(|d| (low[d] - margin..=high[d] + margin).contains(&point[d]))
    }
}

/// Returns how a process ended by the law, and what it said.
pub(super) fn judge(
    ended: &Ended,
    bounds: Option<Bounds>,
    given: &[String],
    folder: &Path,
) -> (Outcome, String) {
    let code = match &ended.end {
        End::Fault(fault) => return (Outcome::Broken(fault.clone()), last_words(&ended.err)),
        End::Code(code) => *code,
    };
    if ended.err.contains("panicked") {
        return (
            Outcome::Broken("it panicked".to_owned()),
            last_words(&ended.err),
        );
    }
    let outcome = match u8::try_from(code) {
        Ok(exit::SUCCESS) => Outcome::Accepted,
        Ok(exit::STOPPED) => Outcome::Stopped,
        Ok(exit::USAGE) => Outcome::Usage,
        Ok(exit::INPUT) => Outcome::Input,
        Ok(exit::METHOD) => Outcome::Method,
        _ => {
            let fault = format!("it ended with {code}, which is no exit code");
            return (Outcome::Broken(fault), last_words(&ended.err));
        }
    };
    if matches!(outcome, Outcome::Accepted | Outcome::Stopped) {
        let is_nan = |line: &str| line.to_lowercase().ends_with("nan");
        let told = ended.out.lines().any(is_nan);
        let told = told.then(|| "it tells of NaN".to_owned());
        return match told.or_else(|| result_fault(folder, bounds)) {
            Some(fault) => (Outcome::Broken(fault), warnings(folder).join(" / ")),
            None => (outcome, warnings(folder).join(" / ")),
        };
    }
    let message = refusal(&ended.err);
    match message_fault(&message, &ended.err, given).or_else(|| left_behind(folder)) {
        Some(fault) => (Outcome::Broken(fault), message),
        None => (outcome, message),
    }
}

/// Returns the last line of what a crashed process said.
fn last_words(err: &str) -> String {
    let mut telling = err
        .lines()
        .filter(|line| line.contains("panicked") || line.contains("memory"));
    telling
        .next_back()
        .or(err.lines().next_back())
        .unwrap_or_default()
        .to_owned()
}

/// Returns the refusal without the lines that every usage error ends with.
fn refusal(err: &str) -> String {
    let lines = err.lines().skip_while(|line| !line.starts_with("error: "));
    let lines = lines.map(str::trim).filter(|line| !line.is_empty());
    let kept: Vec<&str> = lines
        .take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more information"))
        .collect();
    let text = kept.join(" ");
    text.strip_prefix("error: ").unwrap_or(&text).to_owned()
}

fn message_fault(message: &str, all: &str, given: &[String]) -> Option<String> {
    let lower = message.to_lowercase();
    let after = |word: &str| {
        let found = lower.match_indices(word);
        found
            .map(|(at, _)| lower[at + word.len()..].trim_start())
            .any(|rest| rest.starts_with(|c: char| c.is_ascii_digit() || c == '[' || c == '-'))
    };
    // Handles, say, are of the whole surface.
    let is_of_whole = WHOLES.iter().any(|word| lower.contains(word));
    let names_place = is_of_whole
        || given.iter().any(|word| is_named(&lower, word))
        || lower.contains("--")
        || PLACES.iter().any(|word| after(word));
    let has_remedy = REMEDIES.iter().any(|word| lower.contains(word)) || all.contains("--help");
    let digits = message
        .split(|c: char| !c.is_ascii_digit())
        .map(str::len)
        .max();
    if message.is_empty() {
        Some("it gave no reason".to_owned())
    } else if digits > Some(MOST_DIGITS) {
        Some("its message spells a number out".to_owned())
    } else if !names_place {
        Some("its message names no place".to_owned())
    } else if !has_remedy {
        Some("its message names no remedy".to_owned())
    } else {
        None
    }
}

/// Whether a message names a file, or an option by its name or its value.
fn is_named(message: &str, given: &str) -> bool {
    let names = |word: &str| !word.is_empty() && message.contains(&word.to_lowercase());
    match given.strip_prefix("--") {
        None => given.contains('.') && names(given),
        Some(option) => {
            let (name, value) = option.split_once('=').unwrap_or((option, ""));
            // A file may stand before a factor.
            let value = value.split(':').next().unwrap_or_default();
            names(value) || names(name.trim_end_matches('s').replace('-', " ").as_str())
        }
    }
}

/// Names of the files that a case may write.
pub(super) const OUTPUTS: [&str; 4] = ["o.ply", "o.json", "o.npy", "r.json"];

fn left_behind(folder: &Path) -> Option<String> {
    let left = OUTPUTS.iter().find(|name| folder.join(name).exists());
    left.map(|name| format!("it failed and left {name} behind"))
}

fn result_fault(folder: &Path, bounds: Option<Bounds>) -> Option<String> {
    surface_fault(&folder.join("o.ply"), bounds)
        .or_else(|| spline_fault(&folder.join("o.json")))
        .or_else(|| record_fault(&folder.join("r.json")))
}

fn surface_fault(path: &Path, bounds: Option<Bounds>) -> Option<String> {
    if !path.exists() {
        return None;
    }
    let soup = match msplines_io::read_soup(path) {
        Ok(soup) => soup,
        Err(error) => return Some(format!("its surface cannot be read: {error}")),
    };
    let points = || soup.positions.iter().map(|p| [p.x, p.y, p.z]).enumerate();
    if soup.positions.is_empty() {
        return Some("its surface is empty".to_owned());
    }
    if let Some((v, _)) = points().find(|(_, p)| p.iter().any(|x| !x.is_finite())) {
        return Some(format!("its surface is not finite at vertex {v}"));
    }
    let out = bounds.and_then(|bounds| points().find(|(_, p)| !bounds.hold(*p)));
    out.map(|(v, p)| format!("vertex {v} of its surface lies far outside, at {p:?}"))
}

fn read_json(path: &Path) -> Option<Result<Value, String>> {
    let bytes = std::fs::read(path).ok()?;
    Some(serde_json::from_slice(&bytes).map_err(|e| e.to_string()))
}

/// JSON has no NaN: it is written as null, which no list of numbers may hold.
fn spline_fault(path: &Path) -> Option<String> {
    match read_json(path)? {
        Err(error) => Some(format!("its spline cannot be read: {error}")),
        Ok(value) if has_null_in_list(&value) => Some("its spline is not finite".to_owned()),
        Ok(_) => None,
    }
}

fn has_null_in_list(value: &Value) -> bool {
    match value {
        Value::Array(list) => list.iter().any(|v| v.is_null() || has_null_in_list(v)),
        Value::Object(fields) => {
            let mut whole = fields.iter().filter(|(name, _)| *name != PARTIAL_LIST);
            whole.any(|(_, value)| has_null_in_list(value))
        }
        _ => false,
    }
}

fn record_fault(path: &Path) -> Option<String> {
    let value = match read_json(path)? {
        Err(error) => return Some(format!("its record cannot be read: {error}")),
        Ok(value) => value,
    };
    let record: crate::record::Record = match serde_json::from_value(value.clone()) {
        Err(error) => return Some(format!("its record is not finite: {error}")),
        Ok(record) => record,
    };
    let none = record.checks.iter().find(|(name, value)| {
        (value.is_null() || has_null_in_list(value)) && !OPTIONAL.contains(&name.as_str())
    });
    if let Some((name, _)) = none {
        return Some(format!("its check `{name}` is no number"));
    }
    let flips = record.number("checks.flips").unwrap_or(0.0);
    if record.method != "conformal" {
        return None;
    }
    let distortion = record.number("checks.conformal_k_mean");
    if flips > 0.0 {
        Some(format!("its atlas turns {flips} faces over"))
    } else if distortion.is_none_or(|k| k < 1.0) {
        Some(format!(
            "its angles are distorted by {distortion:?}, which cannot be"
        ))
    } else {
        None
    }
}

fn warnings(folder: &Path) -> Vec<String> {
    let record = read_json(&folder.join("r.json")).and_then(Result::ok);
    let list = record.as_ref().and_then(|r| r["warnings"].as_array());
    let text = |v: &Value| v.as_str().map(str::to_owned);
    list.map_or_else(Vec::new, |list| list.iter().filter_map(text).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ended(code: i32, err: &str) -> Ended {
        Ended {
            end: End::Code(code),
            out: String::new(),
            err: err.to_owned(),
        }
    }

    fn given() -> Vec<String> {
        ["fit", "a.ply", "--control-points=7"]
            .map(str::to_owned)
            .to_vec()
    }

    #[test]
    fn files_options_and_their_values_are_places() {
        for (message, named) in [
            ("A.ply is empty", true),
            ("9 control points", true),
            ("7 is too much", true),
            ("fit fails", false),
        ] {
            let message = message.to_lowercase();
            assert_eq!(
                given().iter().any(|word| is_named(&message, word)),
                named,
                "{message}"
            );
        }
    }

    fn judged(ended: &Ended) -> Outcome {
        judge(ended, None, &given(), Path::new("no such folder")).0
    }

    #[test]
    fn refusals_need_a_place_and_a_remedy() {
        let good = ended(3, "x: read\nerror: a.ply: face 7 is turned; use --repair\n");
        assert_eq!(judged(&good), Outcome::Input);
        for (text, fault) in [
            ("", "no reason"),
            ("error: it is bad; remove it\n", "no place"),
            ("error: face 7 is bad\n", "no remedy"),
        ] {
            let Outcome::Broken(found) = judged(&ended(4, text)) else {
                panic!("{text}");
            };
            assert!(found.contains(fault), "{found}");
        }
    }

    #[test]
    fn panics_crashes_and_unknown_codes_are_broken() {
        let crash = Ended {
            end: End::Fault("it crashed".to_owned()),
            ..ended(0, "")
        };
        let panic = ended(101, "thread 'main' panicked at x.rs:1\n");
        for ended in [crash, panic, ended(1, "error: a.ply: use another")] {
            assert!(matches!(judged(&ended), Outcome::Broken(_)), "{ended:?}");
        }
    }

    #[test]
    fn usage_errors_lose_their_closing_lines() {
        let text = "error: invalid value '0' for '--x <N>': 0 is not in 1..=9\n\nFor more information, try '--help'.\n";
        let (outcome, message) = judge(&ended(2, text), None, &given(), Path::new("none"));
        assert_eq!(outcome, Outcome::Usage);
        assert_eq!(
            message,
            "invalid value '0' for '--x <N>': 0 is not in 1..=9"
        );
    }

    #[test]
    fn results_are_finite_and_near_their_input() {
        let folder = tempfile::tempdir().expect("a folder");
        let bounds = Bounds::around([[0.0; 3], [1.0, 0.0, 0.0], [f64::NAN; 3]].into_iter());
        let result = |ply: &str, json: &str| {
            let header = "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
            std::fs::write(
                folder.path().join("o.ply"),
                format!("{header}{ply}\n3 0 0 0\n"),
            )
            .expect("written");
            std::fs::write(folder.path().join("o.json"), json).expect("written");
            result_fault(folder.path(), Some(bounds))
        };
        assert_eq!(result("3.9 0 0", "{\"a\": null, \"b\": [1]}"), None);
        assert!(result("4.1 0 0", "{}").is_some_and(|f| f.contains("far outside")));
        assert!(result("nan 0 0", "{}").is_some_and(|f| f.contains("not finite")));
        assert!(result("0 0 0", "{\"b\": [[null]]}").is_some_and(|f| f.contains("not finite")));
    }
}
