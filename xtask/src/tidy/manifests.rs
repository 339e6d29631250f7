//! Manifests take version, licence and lints from the workspace.

use toml::{Table, Value};

use super::Finding;
use crate::tree::File;

/// Fields every package takes from the workspace.
const INHERITED: [&str; 5] = ["version", "edition", "rust-version", "license", "authors"];
/// Fields a published package takes from the workspace as well.
const PUBLISHED: [&str; 2] = ["categories", "keywords"];
/// The package of C++ bindings needs `unsafe`, so it states lints of its own.
const OWN_LINTS: [&str; 1] = ["tests/reference"];

/// Finds manifests that state what the workspace states, or miss it.
pub(super) fn check(files: &[File]) -> Vec<Finding> {
    let manifests = files.iter().filter(|f| f.path.ends_with("/Cargo.toml"));
    manifests.flat_map(check_manifest).collect()
}

fn check_manifest(file: &File) -> Vec<Finding> {
    let Ok(manifest) = file.text.parse::<Table>() else {
        return Vec::new();
    };
    let package = manifest
        .get("package")
        .and_then(Value::as_table)
        .cloned()
        .unwrap_or_default();
    let mut findings = Vec::new();
    let mut complain = |text: String| findings.push(Finding::new(file, 0, text));

    let published = package
        .get("publish")
        .and_then(Value::as_bool)
        .unwrap_or(true);
    let more: &[&str] = if published { &PUBLISHED } else { &[] };
    for field in INHERITED.iter().chain(more) {
        if !package.get(*field).is_some_and(from_workspace) {
            complain(format!("needs `{field}.workspace = true`"));
        }
    }
    if !package.get("description").is_some_and(Value::is_str) {
        complain("needs a description".to_owned());
    }
    let lints = manifest.get("lints").is_some_and(from_workspace);
    if !lints && !OWN_LINTS.contains(&file.package()) {
        complain("needs `[lints]` with `workspace = true`".to_owned());
    }
    let name = package
        .get("name")
        .and_then(Value::as_str)
        .unwrap_or_default();
    let expected = match file.package() {
        "crates/manifold-splines" => "manifold-splines".to_owned(),
        "xtask" => "xtask".to_owned(),
        folder => format!("msplines-{}", folder.rsplit('/').next().unwrap_or_default()),
    };
    if name != expected {
        complain(format!(
            "is named `{name}`; its folder asks for `{expected}`"
        ));
    }
    findings
}

fn from_workspace(value: &Value) -> bool {
    value.get("workspace").and_then(Value::as_bool) == Some(true)
}

#[cfg(test)]
mod tests {
    use super::check;
    use crate::tree::File;

    const GOOD: &str = r#"
        [package]
        name = "msplines-io"
        description = "Readers and writers"
        version.workspace = true
        edition.workspace = true
        rust-version.workspace = true
        license.workspace = true
        authors.workspace = true
        categories.workspace = true
        keywords.workspace = true
        [lints]
        workspace = true
    "#;

    #[test]
    fn the_citation_names_this_version() {
        let path = crate::tree::root().join("CITATION.cff");
        let text = std::fs::read_to_string(path).expect("a citation file");
        let line = concat!("version: ", env!("CARGO_PKG_VERSION"));
        assert!(text.lines().any(|found| found == line), "no `{line}`");
    }

    fn count(text: &str) -> usize {
        check(&[File::new("crates/io/Cargo.toml", text)]).len()
    }

    #[test]
    fn a_manifest_that_follows_the_workspace_passes() {
        assert_eq!(count(GOOD), 0);
    }

    #[test]
    fn missing_lints_own_licence_and_wrong_name_are_found() {
        assert_eq!(
            count(&GOOD.replace("[lints]\n        workspace = true", "")),
            1
        );
        assert_eq!(
            count(&GOOD.replace("license.workspace = true", "license = \"GPL-3.0\"")),
            1
        );
        assert_eq!(count(&GOOD.replace("msplines-io", "io")), 1);
        assert_eq!(
            count(&GOOD.replace("keywords.workspace = true", "publish = false")),
            0
        );
    }
}
