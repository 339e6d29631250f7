//! The project's folder, and its pages with generated parts.

use std::path::{Path, PathBuf};

use msplines_compare::report;

/// Returns the root of the project.
pub(crate) fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.ancestors().nth(2).unwrap_or(here).to_owned()
}

/// Writes a page anew, with another text between two of its lines.
pub(crate) fn rewrite(page: &str, marks: [&str; 2], text: &str) -> Result<(), String> {
    let path = root().join(page);
    let told = |error: std::io::Error| format!("{page}: {error}");
    let old = std::fs::read_to_string(&path).map_err(told)?;
    let [begin, end] = marks;
    let new = replace_between(&old, marks, text)
        .ok_or_else(|| format!("{page} has no {begin} and {end}"))?;
    report::replace(&path, new.as_bytes()).map_err(|error| format!("{page}: {error}"))
}

/// Returns a page with what stands between two lines replaced, or nothing without them.
fn replace_between(page: &str, [begin, end]: [&str; 2], text: &str) -> Option<String> {
    let (before, rest) = page.split_once(begin)?;
    let (_, after) = rest.split_once(end)?;
    Some(format!("{before}{begin}\n{text}{end}{after}"))
}

#[cfg(test)]
mod tests {
    use super::replace_between;

    #[test]
    fn a_table_takes_the_place_of_an_older_one() {
        let page = "head\n<!-- a -->\nold\n<!-- b -->\ntail\n";
        let marks = ["<!-- a -->", "<!-- b -->"];
        let new = replace_between(page, marks, "new\n");
        assert_eq!(new, Some(page.replace("old", "new")));
        assert_eq!(replace_between("no marks", marks, "new\n"), None);
    }
}
