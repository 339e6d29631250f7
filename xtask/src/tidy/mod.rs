//! Checks the invariants of ARCHITECTURE.md on the text of the project.
//!
//! Each check is a function from the files to findings, so that it can be tested on a bad example
//! of a few lines. The whole set also runs as a unit test.

mod code;
mod effects;
mod layers;
mod links;
mod manifests;
mod order;
mod rooms;
mod style;

use std::fmt;

use crate::tree::{self, File};

/// A place that breaks a rule.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Finding {
    /// Path from the project's root.
    path: String,
    /// One-based line, or 0 for the whole file.
    line: usize,
    /// What is wrong and what to do.
    text: String,
}

impl Finding {
    fn new(file: &File, line: usize, text: impl Into<String>) -> Self {
        Self {
            path: file.path.clone(),
            line,
            text: text.into(),
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => write!(out, "{}: {}", self.path, self.text),
            line => write!(out, "{}:{line}: {}", self.path, self.text),
        }
    }
}

/// A rule, and the check that finds where it is broken.
type Check = (&'static str, fn(&[File]) -> Vec<Finding>);

/// Every check.
const CHECKS: [Check; 8] = [
    ("a crate uses only layers below its own", layers::check),
    (
        "mesh knows no matrices, linalg no geometry; method crates have the same rooms",
        rooms::check,
    ),
    (
        "libraries touch no files, print nothing, read no clocks",
        effects::check,
    ),
    (
        "same input, options and seed give the same bits",
        order::check,
    ),
    (
        "manifests take versions, licence and lints from the workspace",
        manifests::check,
    ),
    ("names and file lengths", style::check),
    (
        "text is free of loose ends and of paths of one machine",
        style::check_text,
    ),
    ("relative links resolve", links::check),
];

/// Prints what breaks a rule, and files that have grown long.
pub(crate) fn run() -> Result<(), String> {
    let files = tree::read(&tree::root())?;
    let mut broken = 0;
    for (rule, check) in CHECKS {
        let findings = check(&files);
        println!(
            "{} {rule}",
            if findings.is_empty() {
                "ok    "
            } else {
                "BROKEN"
            }
        );
        for finding in &findings {
            println!("         {finding}");
        }
        broken += findings.len();
    }
    for (path, lines) in style::long_files(&files) {
        println!("long   {path}: {lines} lines; split it by concept");
    }
    if broken > 0 {
        Err(format!("{broken} places break a rule"))
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::CHECKS;
    use crate::tree;

    #[test]
    fn the_project_is_tidy() -> Result<(), String> {
        let files = tree::read(&tree::root())?;
        assert!(files.len() > 10, "the project's files were not found");
        let findings = CHECKS.iter().flat_map(|(_, check)| check(&files));
        let findings: Vec<_> = findings.map(|finding| finding.to_string()).collect();
        assert!(findings.is_empty(), "\n{}", findings.join("\n"));
        Ok(())
    }
}
