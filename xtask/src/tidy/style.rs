//! Names, lengths and loose ends.

use super::Finding;
use super::code::{find_word, library_code, line_of};
use crate::tree::File;

/// Files over this length are listed.
const LONG: usize = 500;
/// Files over this length are refused.
const TOO_LONG: usize = 600;
/// File names that say nothing about what the file holds.
const VAGUE: [&str; 6] = ["utils", "util", "helpers", "helper", "misc", "manager"];
/// Marks of unfinished work.
const LOOSE_ENDS: [&str; 4] = ["TODO", "FIXME", "XXX", "HACK"];
/// Starts of paths that exist on one machine only.
const MACHINE_PATHS: [&str; 5] = ["/tmp/", "/work/", "/home/", "/root/", "/Users/"];
/// This file names what it looks for.
const THIS: &str = "xtask/src/tidy/style.rs";

/// Finds vague file names, files that are too long, and signatures against the conventions.
pub(super) fn check(files: &[File]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for file in files.iter().filter(|f| f.is_rust()) {
        let lines = file.text.lines().count();
        if lines > TOO_LONG {
            let text = format!("has {lines} lines, more than {TOO_LONG}; split it by concept");
            findings.push(Finding::new(file, 0, text));
        }
        let stem = file
            .path
            .rsplit('/')
            .next()
            .and_then(|name| name.strip_suffix(".rs"));
        if stem.is_some_and(|stem| VAGUE.contains(&stem)) {
            findings.push(Finding::new(file, 0, "say in its name what the file holds"));
        }
        if file.path.starts_with("crates/") && !file.is_apart() {
            findings.extend(check_signatures(file));
        }
    }
    findings
}

fn check_signatures(file: &File) -> Vec<Finding> {
    let code = library_code(file);
    let mut findings = Vec::new();
    for at in find_word(&code, "pub").filter(|&at| code[at..].starts_with("pub fn ")) {
        let signature = &code[at..at + code[at..].find(['{', ';']).unwrap_or(0)];
        let name = signature["pub fn ".len()..]
            .split(['(', '<'])
            .next()
            .unwrap_or_default();
        let line = line_of(&code, at);
        if name.starts_with("get_") {
            let text = format!("`{name}`: a getter is named after what it returns");
            findings.push(Finding::new(file, line, text));
        }
        let arguments = signature.split("->").next().unwrap_or_default();
        if find_word(arguments, "bool").any(|at| arguments[..at].ends_with(": ")) {
            let text = format!("`{name}` takes a `bool`; an enum says at the call what is meant");
            findings.push(Finding::new(file, line, text));
        }
    }
    findings
}

/// Finds marks of unfinished work and paths of one machine.
pub(super) fn check_text(files: &[File]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for file in files.iter().filter(|f| f.path != THIS) {
        for (index, line) in file.text.lines().enumerate() {
            for mark in LOOSE_ENDS
                .iter()
                .filter(|mark| find_word(line, mark).next().is_some())
            {
                let text = format!("`{mark}`: finish it, or write it down where plans are kept");
                findings.push(Finding::new(file, index + 1, text));
            }
            for path in MACHINE_PATHS.iter().filter(|path| starts_path(line, path)) {
                let text = format!("`{path}` is a path of one machine");
                findings.push(Finding::new(file, index + 1, text));
            }
        }
    }
    findings
}

/// Whether `path` stands in the line as the start of an absolute path, not inside of another.
fn starts_path(line: &str, path: &str) -> bool {
    line.match_indices(path).any(|(at, _)| {
        let before = line[..at].chars().next_back();
        !before.is_some_and(|c| c.is_alphanumeric() || "._-/}".contains(c))
    })
}

/// Returns the files that have grown long, the longest first.
pub(super) fn long_files(files: &[File]) -> Vec<(String, usize)> {
    let lengths = files.iter().filter(|f| f.is_rust());
    let mut long: Vec<_> = lengths
        .map(|f| (f.path.clone(), f.text.lines().count()))
        .collect();
    long.retain(|(_, lines)| *lines > LONG);
    long.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    long
}

#[cfg(test)]
mod tests {
    use super::{TOO_LONG, check, check_text, long_files};
    use crate::tree::File;

    #[test]
    fn long_files_are_listed_and_longer_ones_refused() {
        let of_length = |lines: usize| [File::new("crates/io/src/a.rs", &"x\n".repeat(lines))];
        assert!(check(&of_length(TOO_LONG)).is_empty());
        assert_eq!(long_files(&of_length(TOO_LONG)).len(), 1);
        assert_eq!(check(&of_length(TOO_LONG + 1)).len(), 1);
    }

    #[test]
    fn vague_names_getters_and_boolean_arguments_are_found() {
        let findings = |path, text| check(&[File::new(path, text)]).len();
        assert_eq!(findings("crates/io/src/utils.rs", ""), 1);
        assert_eq!(
            findings("crates/io/src/a.rs", "pub fn get_mesh() -> u8 { 0 }"),
            1
        );
        assert_eq!(findings("crates/io/src/a.rs", "pub fn f(fast: bool) {}"), 1);
        assert_eq!(
            findings("crates/io/src/a.rs", "pub fn f(x: u8) -> bool { true }"),
            0
        );
    }

    #[test]
    fn unfinished_work_and_paths_of_one_machine_are_found() {
        let findings = |text| check_text(&[File::new("README.md", text)]).len();
        assert_eq!(findings("one TODO here"), 1);
        assert_eq!(findings("see /tmp/x and (/work/y)"), 2);
        assert_eq!(findings("see target/tmp/x and ../work/y"), 0);
    }
}
