//! The project's text files as one value, so that a check can be tested on a few lines of text.

use std::fs;
use std::path::{Path, PathBuf};

/// A text file of the project.
#[derive(Clone, Debug)]
pub(crate) struct File {
    /// Path from the project's root, with `/` between the parts.
    pub(crate) path: String,
    /// Its text.
    pub(crate) text: String,
}

impl File {
    /// Returns a file of this path and text, as a test needs it.
    #[cfg(test)]
    pub(crate) fn new(path: &str, text: &str) -> Self {
        Self {
            path: path.to_owned(),
            text: text.to_owned(),
        }
    }

    /// Returns whether this is Rust source.
    pub(crate) fn is_rust(&self) -> bool {
        self.path.ends_with(".rs")
    }

    /// Returns the folder of the member package that holds this file: `crates/common` or `xtask`.
    pub(crate) fn package(&self) -> &str {
        let nested = [
            "crates/",
            "tests/fuzz/",
            "tests/reference/",
            "xtask/harness/",
        ];
        let is_nested = nested.iter().any(|folder| self.path.starts_with(folder));
        let depth = if is_nested { 2 } else { 1 };
        match self.path.match_indices('/').nth(depth - 1) {
            Some((end, _)) => &self.path[..end],
            None => "",
        }
    }

    /// Returns whether this is a test, a benchmark or an example and no part of a library.
    pub(crate) fn is_apart(&self) -> bool {
        self.path.starts_with("tests/")
            || self.path.ends_with("/tests.rs")
            || ["/tests/", "/benches/", "/examples/"]
                .iter()
                .any(|part| self.path.contains(part))
    }
}

/// Folders that hold nothing of the project's own.
const SKIPPED: [&str; 4] = [".git", "target", "data/models", "report"];
/// Endings of the files that are read.
const ENDINGS: [&str; 11] = [
    ".rs", ".toml", ".md", ".bib", ".cc", ".h", ".js", ".mjs", ".cff", ".yml", ".ci/run",
];

/// Returns the root of the project.
pub(crate) fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent()
        .map_or_else(|| here.to_owned(), Path::to_owned)
}

/// Reads all text files of the project under `root`, sorted by path.
pub(crate) fn read(root: &Path) -> Result<Vec<File>, String> {
    let mut files = Vec::new();
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        let told = |error| format!("cannot read {}: {error}", folder.display());
        for entry in fs::read_dir(&folder).map_err(told)? {
            let path = entry.map_err(told)?.path();
            let name = name_from(root, &path);
            if SKIPPED.contains(&name.as_str()) {
                continue;
            }
            if path.is_dir() {
                folders.push(path);
            } else if ENDINGS.iter().any(|ending| name.ends_with(ending)) {
                let text = fs::read_to_string(&path)
                    .map_err(|error| format!("cannot read {name}: {error}"))?;
                files.push(File { path: name, text });
            }
        }
    }
    files.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(files)
}

/// Writes a file beside its place and renames it.
pub(crate) fn write(file: &File) -> Result<(), String> {
    let told = |error| format!("cannot write {}: {error}", file.path);
    let path = root().join(&file.path);
    let beside = path.with_extension("new");
    fs::write(&beside, &file.text).map_err(told)?;
    fs::rename(&beside, &path).map_err(told)
}

fn name_from(root: &Path, path: &Path) -> String {
    let inside = path.strip_prefix(root).unwrap_or(path);
    let parts: Vec<_> = inside.iter().map(|part| part.to_string_lossy()).collect();
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::File;

    #[test]
    fn a_file_knows_its_package() {
        let package = |path| File::new(path, "").package().to_owned();
        assert_eq!(package("crates/common/src/lib.rs"), "crates/common");
        assert_eq!(package("xtask/src/main.rs"), "xtask");
        assert_eq!(package("xtask/harness/src/main.rs"), "xtask/harness");
        assert_eq!(package("tests/contract.rs"), "tests");
        assert_eq!(package("tests/reference/src/lib.rs"), "tests/reference");
        assert_eq!(package("tests/fuzz/src/lib.rs"), "tests/fuzz");
        assert_eq!(package("README.md"), "");
    }
}
