//! Relative links in Markdown resolve.

use super::Finding;
use crate::tree::{self, File};

/// Finds relative links to files that do not exist.
pub(super) fn check(files: &[File]) -> Vec<Finding> {
    let root = tree::root();
    let exists = |path: &str| files.iter().any(|f| f.path == path) || root.join(path).exists();
    let pages = files.iter().filter(|f| f.path.ends_with(".md"));
    pages.flat_map(|file| broken_links(file, exists)).collect()
}

fn broken_links(file: &File, exists: impl Fn(&str) -> bool) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut fenced = false;
    for (index, line) in file.text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        }
        if fenced {
            continue;
        }
        for target in targets(line) {
            let path = target.split('#').next().unwrap_or_default();
            if path.is_empty() || target.contains("://") || target.starts_with("mailto:") {
                continue;
            }
            if !exists(&resolve(&file.path, path)) {
                let text = format!("links to `{target}`, which does not exist");
                findings.push(Finding::new(file, index + 1, text));
            }
        }
    }
    findings
}

/// Returns the targets of the links `[text](target)` of a line, outside of code spans.
fn targets(line: &str) -> Vec<&str> {
    let mut found = Vec::new();
    for (at, _) in line.match_indices("](") {
        let ticks = line[..at].matches('`').count();
        // An odd number of ticks before it: the bracket stands inside of a code span.
        if ticks % 2 == 1 {
            continue;
        }
        let rest = &line[at + 2..];
        if let Some(end) = rest.find(')') {
            found.push(rest[..end].trim());
        }
    }
    found
}

/// Returns `path` as seen from the project's root, for a link in the file `from`.
fn resolve(from: &str, path: &str) -> String {
    let mut parts: Vec<&str> = from.split('/').collect();
    parts.pop();
    for part in path.split('/') {
        match part {
            ".." => {
                parts.pop();
            }
            "." | "" => {}
            name => parts.push(name),
        }
    }
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::{broken_links, resolve};
    use crate::tree::File;

    #[test]
    fn a_link_is_resolved_from_its_page() {
        assert_eq!(
            resolve("docs/papers/a.md", "../../crates/x.rs"),
            "crates/x.rs"
        );
        assert_eq!(resolve("README.md", "./docs/a.md"), "docs/a.md");
    }

    #[test]
    fn a_broken_link_is_found_and_others_are_left_alone() {
        let text = "[a](docs/a.md) [b](gone.md#x)\n[c](https://example.org) [d](#here) `[e](no.md)`\n```\n[f](no.md)\n```";
        let findings = broken_links(&File::new("README.md", text), |path| path == "docs/a.md");
        assert_eq!(findings.len(), 1);
        assert!(findings[0].text.contains("gone.md"));
    }
}
