//! What kills left, counted.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use serde::Serialize;
use serde_json::Value;

/// The files of a folder by their names below it.
pub(super) type Files = BTreeMap<String, Vec<u8>>;

/// Fields of records that say when and how fast something ran, or hash those that do.
const OF_TIMES: [&str; 6] = [
    "seconds",
    "cpu",
    "peak_rss_bytes",
    "history",
    "machine",
    "digest",
];

/// What the kills of one phase left.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Tally {
    /// What was killed.
    pub(super) phase: String,
    /// Kills that met a running program.
    pub(super) kills: u32,
    /// Runs that had ended before their moment came.
    pub(super) ended_before: u32,
    /// Final names that hold what they held before.
    pub(super) whole_old: u32,
    /// Final names that hold what an undisturbed run gives.
    pub(super) whole_new: u32,
    /// Final names without a file, where there was none before either.
    pub(super) absent: u32,
    /// Final names that hold anything else.
    pub(super) damaged: u32,
    /// Files under temporary names.
    pub(super) leftovers: u32,
    /// Files under temporary names after the next run.
    pub(super) leftovers_after: u32,
    /// What is wrong.
    pub(super) faults: Vec<String>,
}

impl Tally {
    /// Returns an empty tally.
    pub(super) fn new(phase: impl Into<String>) -> Self {
        Self {
            phase: phase.into(),
            ..Self::default()
        }
    }

    /// Counts what lies under a final name.
    pub(super) fn count(
        &mut self,
        name: &str,
        found: Option<&[u8]>,
        old: Option<&[u8]>,
        new: &[u8],
    ) {
        match found {
            Some(bytes) if old == Some(bytes) => self.whole_old += 1,
            Some(bytes) if is_same(name, bytes, new) => self.whole_new += 1,
            Some(bytes) if old.is_some_and(|old| is_same(name, bytes, old)) => self.whole_old += 1,
            None if old.is_none() => self.absent += 1,
            Some(bytes) => self.damage(format!("{name} is damaged, {} bytes", bytes.len())),
            None => self.damage(format!("{name} is lost")),
        }
    }

    /// Counts a damage.
    fn damage(&mut self, what: String) {
        self.damaged += 1;
        self.fault(what);
    }

    /// Notes what is wrong.
    pub(super) fn fault(&mut self, what: impl AsRef<str>) {
        let kill = self.kills + self.ended_before;
        let text = format!("{}, kill {kill}: {}", self.phase, what.as_ref());
        self.faults.push(text);
    }
}

/// Whether a file holds what an undisturbed run gives, times apart.
pub(super) fn is_same(name: &str, found: &[u8], expected: &[u8]) -> bool {
    if found == expected {
        return true;
    }
    let value = |bytes: &[u8]| serde_json::from_slice(bytes).ok().map(without_times);
    name.ends_with(".json") && value(found).is_some_and(|found| Some(found) == value(expected))
}

fn without_times(mut value: Value) -> Value {
    forget_times(&mut value);
    value
}

fn forget_times(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            fields.retain(|name, _| !OF_TIMES.contains(&name.as_str()));
            fields.values_mut().for_each(forget_times);
        }
        Value::Array(values) => values.iter_mut().for_each(forget_times),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
}

/// Returns whether a name below a folder is one that no finished file has.
pub(super) fn is_temporary(name: &str) -> bool {
    let parts = name.split('/');
    let mut marked = parts.map(|part| part.starts_with(".msplines-") || part.ends_with(".part"));
    marked.any(|is_marked| is_marked)
}

/// Reads all files of a folder and of those in it; none where it is missing.
pub(super) fn files(folder: &Path) -> Result<Files, String> {
    let mut files = Files::new();
    collect(folder, "", &mut files).map_err(|e| format!("{}: {e}", folder.display()))?;
    Ok(files)
}

fn collect(folder: &Path, below: &str, files: &mut Files) -> std::io::Result<()> {
    if !folder.is_dir() {
        return Ok(());
    }
    for entry in folder.read_dir()? {
        let entry = entry?;
        let name = format!("{below}{}", entry.file_name().to_string_lossy());
        if entry.file_type()?.is_dir() {
            collect(&entry.path(), &format!("{name}/"), files)?;
        } else {
            files.insert(name, std::fs::read(entry.path())?);
        }
    }
    Ok(())
}

/// Returns a table with a line for every phase.
pub(super) fn table(phases: &[Tally]) -> String {
    let mut text = format!(
        "{:<24} {:>6} {:>6} {:>9} {:>9} {:>7} {:>8} {:>9} {:>6}\n",
        "phase",
        "kills",
        "late",
        "whole-old",
        "whole-new",
        "absent",
        "damaged",
        "leftovers",
        "after",
    );
    for phase in phases {
        let _ = writeln!(
            text,
            "{:<24} {:>6} {:>6} {:>9} {:>9} {:>7} {:>8} {:>9} {:>6}",
            phase.phase,
            phase.kills,
            phase.ended_before,
            phase.whole_old,
            phase.whole_new,
            phase.absent,
            phase.damaged,
            phase.leftovers,
            phase.leftovers_after,
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_new_absent_and_damaged_are_told_apart() {
        let mut tally = Tally::new("p");
        tally.count("a", Some(b"new"), Some(b"old"), b"new");
        tally.count("a", Some(b"old"), Some(b"old"), b"new");
        tally.count("a", None, None, b"new");
        assert!(tally.faults.is_empty());
        tally.count("a", Some(b"ne"), Some(b"old"), b"new");
        tally.count("a", None, Some(b"old"), b"new");
        let counts = (
            tally.whole_new,
            tally.whole_old,
            tally.absent,
            tally.damaged,
        );
        assert_eq!(counts, (1, 1, 1, 2));
        assert_eq!(tally.faults.len(), 2);
    }

    #[test]
    fn records_may_differ_in_times_only() {
        let [one, two] = [b"{\"a\":[{\"seconds\":1}]}", b"{\"a\":[{\"seconds\":2}]}"];
        assert!(is_same("r.json", one, two) && !is_same("r.csv", one, two));
        assert!(!is_same("r.json", one, b"{\"a\":[{\"b\":2}]}"));
        assert!(!is_same("r.json", &one[..9], one));
        assert!(!is_same("r.json", b"{", b"["));
    }

    #[test]
    fn temporary_names_are_known() {
        assert!(is_temporary(".msplines-x.tmp") && is_temporary("rows/k.part/surface.ply"));
        assert!(!is_temporary("rows/k.json") && !is_temporary("surface.ply"));
    }
}
