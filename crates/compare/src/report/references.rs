//! Comparisons with code that nobody here wrote, as the package `tests/reference` leaves them.

use std::collections::BTreeSet;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::tables::{Cell, NONE, Table};

/// The largest deviation of one quantity from a library, over several meshes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// What was compared.
    pub quantity: String,
    /// Name and version of the library.
    pub reference: String,
    /// What it was compared on.
    pub meshes: Vec<String>,
    /// The largest deviation; none if it was no number.
    pub largest_deviation: Option<f64>,
    /// The mesh with that deviation; empty if there was none anywhere.
    pub at: String,
    /// What the deviation may be.
    pub bound: f64,
    /// What deviations are relative to, and why they may be so large.
    pub why_this_bound: String,
}

/// Why there are no references in a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReferencesError {
    /// The file cannot be read.
    #[error("{path} cannot be read: {source}; `cargo xtask test reference` writes it")]
    Absent {
        /// Its path.
        path: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// It holds something else.
    #[error("{path} is no list of comparisons: {source}; `cargo xtask test reference` writes one")]
    Content {
        /// Its path.
        path: String,
        /// What is wrong with it.
        source: serde_json::Error,
    },
}

impl Reference {
    /// Returns the library's name without its version.
    #[must_use]
    pub fn library(&self) -> &str {
        let name = self.reference.rsplit_once(' ');
        name.map_or(self.reference.as_str(), |(name, _)| name)
    }

    /// Returns the bound as tables show it.
    #[must_use]
    pub fn shown_bound(&self) -> String {
        plain_or_scientific(self.bound)
    }
}

/// Returns the comparisons in a file, by library and quantity.
///
/// # Errors
/// No such file, or another content.
pub fn read(path: &Path) -> Result<Vec<Reference>, ReferencesError> {
    let name = || path.display().to_string();
    let text = std::fs::read(path).map_err(|source| ReferencesError::Absent {
        path: name(),
        source,
    })?;
    let mut found: Vec<Reference> =
        serde_json::from_slice(&text).map_err(|source| ReferencesError::Content {
            path: name(),
            source,
        })?;
    found.sort_by(|a, b| (&a.reference, &a.quantity).cmp(&(&b.reference, &b.quantity)));
    Ok(found)
}

/// Returns the table of comparisons, in their order.
#[must_use]
pub fn table(references: &[Reference]) -> Table {
    let header = [
        "quantity",
        "reference",
        "meshes",
        "largest deviation",
        "at",
        "bound",
        "why",
    ];
    let row = |of: &Reference| {
        let meshes: BTreeSet<&String> = of.meshes.iter().collect();
        let meshes = Some(meshes.len() as f64);
        let deviation = |value: f64| match value {
            0.0 => "0".to_owned(),
            value => format!("{value:.1e}"),
        };
        let at = if of.at.is_empty() { NONE } else { &of.at };
        vec![
            Cell::text(&of.quantity),
            Cell::text(&of.reference),
            Cell::number(meshes, |count| count.to_string()),
            Cell::number(of.largest_deviation, deviation),
            Cell::text(at),
            Cell::number(Some(of.bound), |_| of.shown_bound()),
            Cell::text(&of.why_this_bound),
        ]
    };
    Table {
        title: "Largest deviations from code that nobody here wrote".to_owned(),
        header: header.map(str::to_owned).to_vec(),
        rows: references.iter().map(row).collect(),
    }
}

/// Returns the table of comparisons in Markdown.
#[must_use]
pub fn markdown(references: &[Reference]) -> String {
    let mut text = String::new();
    super::push_markdown_table(&mut text, &table(references));
    text
}

fn plain_or_scientific(value: f64) -> String {
    if value == 0.0 || (1e-2..1e3).contains(&value) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reference(quantity: &str, deviation: Option<f64>, bound: f64) -> Reference {
        Reference {
            quantity: quantity.to_owned(),
            reference: "Some Library 5.5.1".to_owned(),
            meshes: ["a", "b", "a"].map(str::to_owned).to_vec(),
            largest_deviation: deviation,
            at: deviation
                .map_or("b", |d| if d > 0.0 { "b" } else { "" })
                .to_owned(),
            bound,
            why_this_bound: "1 + |x|".to_owned(),
        }
    }

    #[test]
    fn a_file_becomes_a_table() -> Result<(), Box<dyn std::error::Error>> {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("reference.json");
        let error = read(&path).err().map(|e| e.to_string());
        assert!(error.is_some_and(|e| e.contains("`cargo xtask test reference` writes it")));
        let written = [
            reference("second", Some(0.0), 0.0),
            reference("first", Some(1.234e-13), 1e-12),
            reference("third", None, 0.02),
        ];
        std::fs::write(&path, serde_json::to_vec(&written)?)?;
        let found = read(&path)?;
        assert_eq!(found[0].library(), "Some Library");
        let lines = [
            "| first | Some Library 5.5.1 | 2 | 1.2e-13 | b | 1e-12 | 1 + \\|x\\| |",
            "| second | Some Library 5.5.1 | 2 | 0 | - | 0 | 1 + \\|x\\| |",
            "| third | Some Library 5.5.1 | 2 | - | b | 0.02 | 1 + \\|x\\| |",
        ];
        let text = markdown(&found);
        assert_eq!(text.lines().skip(2).take(3).collect::<Vec<_>>(), lines);
        std::fs::write(&path, "{}")?;
        assert!(matches!(read(&path), Err(ReferencesError::Content { .. })));
        Ok(())
    }
}
