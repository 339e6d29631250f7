//! Every option of every command at and beyond its limits, as `options.toml` lists them.

use std::collections::{BTreeMap, BTreeSet};

use serde::Deserialize;

use super::defects::replaced;
use super::inputs::Bench;
use super::law::Bounds;
use super::subjects::SUBJECTS;
use super::{BatteryError, Group, Trial};

/// The lists.
const LISTS: &str = include_str!("options.toml");
/// The only value of options that are there or not.
const FLAG: &str = "present";

/// What is tried.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Lists {
    /// Values of options of one kind.
    kinds: BTreeMap<String, Vec<String>>,
    command: Vec<Command>,
}

/// The options of a command.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Command {
    /// A name among the subjects, or the beginning of a command on a spline file.
    name: String,
    /// Name and kind of each option, and values at its own limits.
    options: Vec<Vec<String>>,
    /// Options that contradict or need each other.
    #[serde(default)]
    together: Vec<String>,
}

fn lists() -> Result<Lists, BatteryError> {
    toml::from_str(LISTS).map_err(|error| BatteryError::Input {
        name: "options.toml".to_owned(),
        reason: error.to_string(),
    })
}

/// Options by which a result may be moved anywhere.
const MOVING: [&str; 12] = [
    "--factors",
    "--factor",
    "--with",
    "--move",
    "--insert",
    "--turn",
    "--scale",
    "--control",
    "--pull",
    "--data",
    "--attributes",
    "--within",
];

/// Returns whether an option of a command, such as `fit biharmonic`, is tried by any case.
#[must_use]
pub fn is_tried(command: &str, option: &str) -> bool {
    // That the lists can be read is tested.
    let commands = lists().map_or_else(|_| Vec::new(), |lists| lists.command);
    let after = |name: &str| name.strip_prefix(command).map(|rest| rest.chars().next());
    let alike = commands
        .iter()
        .filter(|c| matches!(after(&c.name), Some(None | Some(' ' | ','))));
    let mut tried = alike.flat_map(|c| {
        let alone = c
            .options
            .iter()
            .filter_map(|o| o.first())
            .map(String::as_str);
        alone.chain(c.together.iter().flat_map(|t| t.split([' ', '='])))
    });
    tried.any(|name| name == option)
}

/// Returns all cases of options.
pub(super) fn trials(bench: &Bench) -> Result<Vec<Trial>, BatteryError> {
    let Lists { kinds, command } = lists()?;
    let mut trials = Vec::new();
    for Command {
        name,
        options,
        together,
    } in &command
    {
        let base = Base::of(bench, name);
        for tried in options {
            let [option, kind, limits @ ..] = tried.as_slice() else {
                continue;
            };
            let values = kinds.get(kind).map_or(&[][..], Vec::as_slice);
            let cases = option_cases(option, values, limits);
            trials.extend(cases.iter().map(|case| base.trial(case)));
        }
        trials.extend(together.iter().map(|options| base.trial(options)));
    }
    // The same case may come from two lists.
    let mut seen = BTreeSet::new();
    trials.retain(|trial| seen.insert((trial.method.clone(), trial.case.clone())));
    Ok(trials)
}

/// Returns an option with each of its values, and given twice.
fn option_cases(option: &str, values: &[String], limits: &[String]) -> Vec<String> {
    let with = |value: &String| format!("{option}={value}");
    if values == [FLAG] {
        return vec![
            option.to_owned(),
            format!("{option}=yes"),
            format!("{option} {option}"),
        ];
    }
    let mut cases: Vec<String> = values.iter().chain(limits).map(with).collect();
    let one = limits
        .first()
        .or(values.get(1))
        .map(with)
        .unwrap_or_default();
    cases.push(format!("{one} {one}"));
    cases
}

/// A command that works, to which options are given.
struct Base {
    name: String,
    command: String,
    bounds: Option<Bounds>,
}

/// What commands on spline files write and need.
const SPLINE_OUTPUTS: &str = "--output=o.ply --report=r.json";

impl Base {
    fn of(bench: &Bench, name: &str) -> Self {
        if let Some(subject) = SUBJECTS.iter().find(|s| s.name == name) {
            let command = subject.arguments(subject.command, subject.input, "");
            return Self {
                name: name.to_owned(),
                command: command.join(" "),
                bounds: Some(bench.draft(subject.input).bounds()),
            };
        }
        let needed = match name.split(' ').next() {
            Some("edit") => " --move=0,0,0:0,0,0",
            Some("combine") => " --with=biharmonic.json:1",
            Some("deform") => " --move=0,0,0=0,0,0",
            _ => "",
        };
        Self {
            name: name.to_owned(),
            command: format!("{name}{needed} {SPLINE_OUTPUTS}"),
            bounds: None,
        }
    }

    fn trial(&self, options: &str) -> Trial {
        let names = options
            .split(' ')
            .map(|word| word.split('=').next().unwrap_or_default());
        let mut command = names.clone().fold(self.command.clone(), |command, name| {
            replaced(&command, name, "")
        });
        // One choice of knots is enough, unless both are asked for.
        if names.clone().any(|name| name == "--knots-from")
            && !names.clone().any(|n| n == "--knots")
        {
            command = replaced(&command, "--knots", "");
        }
        for (option, other) in [
            ("--tolerance", "--control-points"),
            ("--levels", "--spans"),
            ("--cells", "--spacing"),
        ] {
            if names.clone().any(|name| name == option) {
                command = replaced(&command, other, "");
            }
        }
        let moves = names.clone().any(|name| MOVING.contains(&name));
        let arguments = command
            .split(' ')
            .chain(options.split(' '))
            .map(str::to_owned);
        Trial {
            group: Group::Options,
            case: options.to_owned(),
            method: self.name.clone(),
            arguments: arguments.collect(),
            bounds: self.bounds.filter(|_| !moves),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_option_has_a_kind_that_is_listed() {
        let lists = lists().expect("the lists can be read");
        for command in &lists.command {
            for option in &command.options {
                assert!(
                    lists.kinds.contains_key(&option[1]),
                    "{}: {option:?}",
                    command.name
                );
            }
        }
    }

    #[test]
    fn options_are_found_by_command() {
        assert!(is_tried("fit ls-mesh", "--weight"));
        assert!(is_tried("evaluate", "--level"));
        assert!(is_tried("reshape", "--within"));
        assert!(!is_tried("fit ls-mesh", "--fairness"));
    }

    #[test]
    fn a_trial_takes_the_place_of_what_the_command_says() {
        let base = Base {
            name: "x".to_owned(),
            command: "fit x m.obj --knots=1 --spans=2".to_owned(),
            bounds: None,
        };
        assert_eq!(
            base.trial("--knots=nan").arguments,
            ["fit", "x", "m.obj", "--spans=2", "--knots=nan"]
        );
        assert_eq!(
            base.trial("--levels=1..2")
                .arguments
                .last()
                .map(String::as_str),
            Some("--levels=1..2")
        );
        assert_eq!(base.trial("--levels=1..2").arguments.len(), 5);
    }
}
