//! The layer graph: a crate uses only layers below its own.

use toml::{Table, Value};

use super::Finding;
use crate::tree::File;

/// Layer of each package folder, from the bottom.
const LAYERS: [(&str, u8); 18] = [
    ("crates/common", 1),
    ("crates/conformal", 2),
    ("crates/io", 2),
    ("crates/biharmonic", 3),
    ("crates/ls-mesh", 3),
    ("crates/powell-sabin", 3),
    ("crates/sparse-manifold", 3),
    ("crates/t-spline", 3),
    ("crates/trivariate", 3),
    ("crates/picture", 3),
    ("crates/compare", 4),
    ("crates/manifold-splines", 4),
    ("crates/cli", 5),
    ("xtask", 5),
    ("xtask/harness", 5),
    ("tests", 5),
    ("tests/reference", 5),
    ("tests/fuzz", 6),
];

/// The method crates, one spline each.
pub(super) const METHODS: [&str; 6] = [
    "crates/biharmonic",
    "crates/ls-mesh",
    "crates/powell-sabin",
    "crates/sparse-manifold",
    "crates/t-spline",
    "crates/trivariate",
];

/// Packages that may depend on `io`: those that touch files. Others may in their tests.
const READERS: [&str; 8] = [
    "crates/compare",
    "crates/manifold-splines",
    "crates/cli",
    "xtask",
    "xtask/harness",
    "tests",
    "tests/fuzz",
    "tests/reference",
];

/// Finds dependencies on the same or a higher layer.
pub(super) fn check(files: &[File]) -> Vec<Finding> {
    let manifests = files.iter().filter(|f| f.path.ends_with("/Cargo.toml"));
    manifests.flat_map(check_manifest).collect()
}

fn check_manifest(file: &File) -> Vec<Finding> {
    let folder = file.package();
    let Some(own) = layer(folder) else {
        return vec![Finding::new(
            file,
            0,
            "has no layer; give it one in xtask/src/tidy/layers.rs",
        )];
    };
    let manifest: Table = match file.text.parse() {
        Ok(manifest) => manifest,
        Err(error) => return vec![Finding::new(file, 0, format!("is not TOML: {error}"))],
    };
    let mut findings = Vec::new();
    for (section, name) in dependencies(&manifest) {
        let Some(other) = folder_of(&name) else {
            continue;
        };
        let Some(below) = layer(&other) else { continue };
        let of_tests = section == "dev-dependencies";
        // A room beside `io` may read its test models; `io` knows none of them.
        let reads_in_tests = of_tests && other == "crates/io" && below == own;
        if other != folder && below >= own && !reads_in_tests {
            findings.push(Finding::new(
                file,
                0,
                format!("{folder} (layer {own}) depends on {other} (layer {below}); it may use only layers below its own"),
            ));
        } else if other == "crates/io" && !of_tests && !READERS.contains(&folder) {
            let text = format!("{folder} depends on {other}; it sees values, never files");
            findings.push(Finding::new(file, 0, text));
        }
    }
    findings
}

fn layer(folder: &str) -> Option<u8> {
    LAYERS
        .iter()
        .find(|(name, _)| *name == folder)
        .map(|&(_, layer)| layer)
}

/// Returns the folder of a package of this project.
fn folder_of(package: &str) -> Option<String> {
    match package {
        "manifold-splines" => Some("crates/manifold-splines".to_owned()),
        "msplines-tests" => Some("tests".to_owned()),
        "msplines-fuzz" => Some("tests/fuzz".to_owned()),
        "msplines-reference" => Some("tests/reference".to_owned()),
        "msplines-harness" => Some("xtask/harness".to_owned()),
        "xtask" => Some("xtask".to_owned()),
        _ => package
            .strip_prefix("msplines-")
            .map(|name| format!("crates/{name}")),
    }
}

/// Returns all dependencies of a manifest with the section they stand in.
fn dependencies(manifest: &Table) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let targets = manifest.get("target").and_then(Value::as_table);
    let tables = targets
        .into_iter()
        .flat_map(Table::values)
        .filter_map(Value::as_table);
    for table in tables.chain([manifest]) {
        for section in ["dependencies", "dev-dependencies", "build-dependencies"] {
            let Some(entries) = table.get(section).and_then(Value::as_table) else {
                continue;
            };
            for (name, value) in entries {
                let package = value.get("package").and_then(Value::as_str).unwrap_or(name);
                found.push((section.to_owned(), package.to_owned()));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::{METHODS, check, layer};
    use crate::tree::File;

    fn findings(path: &str, text: &str) -> usize {
        check(&[File::new(path, text)]).len()
    }

    #[test]
    fn a_lower_layer_may_be_used_and_a_neighbour_may_not() {
        let path = "crates/biharmonic/Cargo.toml";
        assert_eq!(
            findings(path, "[dependencies]\nmsplines-common.workspace = true\n"),
            0
        );
        assert_eq!(
            findings(path, "[dependencies]\nmsplines-ls-mesh.workspace = true\n"),
            1
        );
        assert_eq!(
            findings(
                path,
                "[dev-dependencies]\nmsplines-compare.workspace = true\n"
            ),
            1
        );
        let renamed = "[dependencies]\nother = { package = \"msplines-t-spline\", path = \"x\" }\n";
        assert_eq!(findings(path, renamed), 1);
    }

    #[test]
    fn a_method_reads_files_only_in_its_tests() {
        let path = "crates/ls-mesh/Cargo.toml";
        assert_eq!(
            findings(path, "[dependencies]\nmsplines-io.workspace = true\n"),
            1
        );
        assert_eq!(
            findings(path, "[dev-dependencies]\nmsplines-io.workspace = true\n"),
            0
        );
    }

    #[test]
    fn a_neighbour_of_io_reads_files_only_in_its_tests() {
        let path = "crates/conformal/Cargo.toml";
        for (section, found) in [("dependencies", 1), ("dev-dependencies", 0)] {
            let text = format!("[{section}]\nmsplines-io.workspace = true\n");
            assert_eq!(findings(path, &text), found);
        }
        let method = "[dev-dependencies]\nmsplines-picture.workspace = true\n";
        assert_eq!(findings(path, method), 1);
    }

    #[test]
    fn a_new_crate_needs_a_layer() {
        assert_eq!(findings("crates/other/Cargo.toml", ""), 1);
        assert!(METHODS.iter().all(|method| layer(method) == Some(3)));
    }
}
