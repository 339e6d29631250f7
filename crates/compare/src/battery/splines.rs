//! Spline files with every field taken away or spoiled, one at a time.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use super::inputs::Bench;
use super::subjects::SPLINES;
use super::{BatteryError, Group, Trial};

/// A step into a JSON value.
#[derive(Clone, Debug, PartialEq)]
enum Step {
    Field(String),
    Item(usize),
}

/// Returns the cases of all spline files.
pub(super) fn trials(bench: &Bench) -> Result<Vec<Trial>, BatteryError> {
    let mut trials = Vec::new();
    for (name, _) in SPLINES {
        let bytes = bench.read(&format!("{name}.json"))?;
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let spline: Value = serde_json::from_str(&text).map_err(|e| BatteryError::Input {
            name: format!("{name}.json"),
            reason: e.to_string(),
        })?;
        for (number, (case, spoiled)) in spoiled(&text, &spline).into_iter().enumerate() {
            let file = format!("{name}-{number}.json");
            bench.write(&file, spoiled.as_bytes())?;
            let arguments = ["evaluate", &file, "--output=o.ply", "--report=r.json"];
            trials.push(Trial {
                group: Group::Splines,
                case,
                method: format!("evaluate {name}.json"),
                arguments: arguments.map(str::to_owned).to_vec(),
                bounds: None,
            });
        }
    }
    Ok(trials)
}

/// Returns the spoiled texts of a spline file, each with what was done to it.
fn spoiled(text: &str, spline: &Value) -> Vec<(String, String)> {
    let mut half = text.len() / 2;
    while !text.is_char_boundary(half) {
        half += 1;
    }
    let whole = [
        ("empty file", ""),
        ("cut in the middle", &text[..half]),
        ("no object", "[1, 2]"),
        ("nothing in it", "{}"),
    ];
    let mut all: Vec<_> = whole
        .map(|(case, text)| (case.to_owned(), text.to_owned()))
        .into();
    let mut paths = Vec::new();
    let mut seen = BTreeSet::new();
    collect(spline, &mut Vec::new(), &mut seen, &mut paths);
    for path in &paths {
        for (what, value) in values(at(spline, path)) {
            let mut changed = spline.clone();
            set(&mut changed, path, value);
            all.push((format!("{} {what}", told(path)), changed.to_string()));
        }
    }
    all
}

/// Collects one path of each kind: items of a list are of one kind.
fn collect(
    value: &Value,
    path: &mut Vec<Step>,
    seen: &mut BTreeSet<String>,
    paths: &mut Vec<Vec<Step>>,
) {
    if !path.is_empty() && seen.insert(told(path)) {
        paths.push(path.clone());
    }
    let is_told = path.first() == Some(&Step::Field("options".to_owned()));
    let mut go = |step: Step, value: &Value| {
        path.push(step);
        collect(value, path, seen, paths);
        path.pop();
    };
    match value {
        // What a spline was fitted with is only told, and by each method in its own way.
        _ if is_told => {}
        Value::Object(fields) => fields
            .iter()
            .for_each(|(k, v)| go(Step::Field(k.clone()), v)),
        Value::Array(items) => {
            // The first items show what all are; the last one, too, where they differ.
            let ends = items.iter().enumerate().take(2);
            ends.for_each(|(i, v)| go(Step::Item(i), v));
        }
        _ => {}
    }
}

fn told(path: &[Step]) -> String {
    let mut text = String::new();
    for step in path {
        match step {
            Step::Field(name) if text.is_empty() => text.push_str(name),
            Step::Field(name) => text.extend([".", name]),
            Step::Item(_) => text.push_str("[]"),
        }
    }
    text
}

/// Returns what to put in the place of a value; `None` takes it away.
fn values(value: &Value) -> Vec<(&'static str, Option<Value>)> {
    let mut all = vec![("taken away", None), ("null", Some(Value::Null))];
    match value {
        Value::Number(_) => all.extend([
            ("= -1", Some(json!(-1))),
            ("= 0", Some(json!(0))),
            ("= 0.5", Some(json!(0.5))),
            ("= 1e308", Some(json!(1e308))),
            ("= 4294967295", Some(json!(u32::MAX))),
            ("= 18446744073709551615", Some(json!(u64::MAX))),
        ]),
        Value::Array(items) => {
            all.push(("emptied", Some(json!([]))));
            let shorter = &items[..items.len().saturating_sub(1)];
            all.push(("one shorter", Some(json!(shorter))));
            let longer: Vec<&Value> = items.iter().chain(items.last()).collect();
            all.push(("one longer", Some(json!(longer))));
            if let [first, _, rest @ ..] = items.as_slice() {
                let twice: Vec<&Value> = [first, first].into_iter().chain(rest).collect();
                all.push(("first twice", Some(json!(twice))));
            }
        }
        Value::String(text) => {
            all.push(("emptied", Some(json!(""))));
            all.push(("unknown", Some(json!("unknown"))));
            let shorter: String = text
                .chars()
                .take(text.chars().count().saturating_sub(5))
                .collect();
            all.push(("cut", Some(json!(shorter))));
        }
        Value::Object(_) => all.push(("emptied", Some(json!({})))),
        Value::Bool(b) => all.push(("turned", Some(json!(!b)))),
        Value::Null => all.push(("= 1", Some(json!(1)))),
    }
    all
}

fn at<'a>(value: &'a Value, path: &[Step]) -> &'a Value {
    path.iter().fold(value, |value, step| match step {
        Step::Field(name) => &value[name],
        Step::Item(index) => &value[*index],
    })
}

fn set(value: &mut Value, path: &[Step], new: Option<Value>) {
    let Some((last, before)) = path.split_last() else {
        return;
    };
    let parent = before.iter().fold(value, |value, step| match step {
        Step::Field(name) => &mut value[name],
        Step::Item(index) => &mut value[*index],
    });
    match (last, parent, new) {
        (Step::Field(name), Value::Object(fields), Some(new)) => {
            fields.insert(name.clone(), new);
        }
        (Step::Field(name), Value::Object(fields), None) => {
            fields.remove(name);
        }
        (Step::Item(index), Value::Array(items), Some(new)) => items[*index] = new,
        (Step::Item(index), Value::Array(items), None) => {
            items.remove(*index);
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::spoiled;

    #[test]
    fn every_field_is_spoiled_in_its_own_ways() {
        let text = r#"{"a":{"b":[[1,2],[3,4]]},"c":"word"}"#;
        let all = spoiled(text, &serde_json::from_str(text).expect("JSON"));
        let of = |case: &str| {
            let found = all.iter().find(|(c, _)| c == case);
            found.map_or("none", |(_, text)| text.as_str())
        };
        assert_eq!(of("a taken away"), r#"{"c":"word"}"#);
        assert_eq!(of("a.b one shorter"), r#"{"a":{"b":[[1,2]]},"c":"word"}"#);
        assert_eq!(
            of("a.b[][] = -1"),
            r#"{"a":{"b":[[-1,2],[3,4]]},"c":"word"}"#
        );
        assert_eq!(of("a.b[] emptied"), r#"{"a":{"b":[[],[3,4]]},"c":"word"}"#);
        assert_eq!(
            of("c unknown"),
            r#"{"a":{"b":[[1,2],[3,4]]},"c":"unknown"}"#
        );
        // Four of the whole, five or six of each of the three lists, eight of numbers, five of texts, three of objects.
        assert_eq!(all.len(), 4 + 3 + 6 + 6 + 8 + 5);
    }
}
