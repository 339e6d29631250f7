//! What the cited papers contain, and which sources there are.

use std::collections::BTreeSet;

use toml::{Table, Value};

/// A paper with a page of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Paper {
    /// Key in the bibliography.
    pub(super) key: String,
    /// Name of its page in `docs/papers`, without the ending.
    pub(super) page: String,
    /// Its equations, algorithms and theorems.
    pub(super) items: Vec<Item>,
}

/// An equation, an algorithm or a theorem of a paper.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Item {
    /// Its number, such as `Eq. (11)`.
    pub(super) id: String,
    /// What it states.
    pub(super) what: String,
    /// Why no code claims it, where none should.
    pub(super) unclaimed: String,
}

impl Paper {
    /// Returns whether `place` is numbered like an item of this paper but is not among them.
    pub(super) fn lacks(&self, place: &str) -> bool {
        let numbered = ["Eq.", "Alg.", "Theorem"]
            .iter()
            .any(|kind| place.starts_with(kind));
        numbered && self.items.iter().all(|item| item.id != place)
    }
}

/// Reads the list of papers.
pub(super) fn read(text: &str) -> Result<Vec<Paper>, String> {
    let table: Table = text
        .parse()
        .map_err(|error| format!("papers.toml: {error}"))?;
    tables(&table, "paper").map(read_paper).collect()
}

fn read_paper(table: &Table) -> Result<Paper, String> {
    let items = tables(table, "item").map(|item| {
        let unclaimed = string(item, "unclaimed").unwrap_or_default();
        Ok(Item {
            id: string(item, "id")?,
            what: string(item, "what")?,
            unclaimed,
        })
    });
    Ok(Paper {
        key: string(table, "key")?,
        page: string(table, "page")?,
        items: items.collect::<Result<_, String>>()?,
    })
}

fn tables<'a>(table: &'a Table, name: &str) -> impl Iterator<Item = &'a Table> {
    let entries = table.get(name).and_then(Value::as_array);
    entries.into_iter().flatten().filter_map(Value::as_table)
}

fn string(table: &Table, name: &str) -> Result<String, String> {
    let value = table.get(name).and_then(Value::as_str);
    value
        .map(str::to_owned)
        .ok_or_else(|| format!("papers.toml: an entry has no `{name}`"))
}

/// Returns the keys of a BibTeX file.
pub(super) fn bibliography_keys(text: &str) -> BTreeSet<String> {
    let entries = text.lines().filter_map(|line| line.strip_prefix('@'));
    let keys = entries.filter_map(|entry| entry.split_once('{')?.1.split_once(','));
    keys.map(|(key, _)| key.trim().to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::{bibliography_keys, read};

    #[test]
    fn keys_of_a_bibliography_are_found() {
        let keys =
            bibliography_keys("@article{A2000,\n title = {x},\n}\n% @book{No}\n@book{B, }\n");
        assert_eq!(keys.into_iter().collect::<Vec<_>>(), ["A2000", "B"]);
    }

    #[test]
    fn an_entry_without_its_number_is_an_error() {
        let text = "[[paper]]\nkey = \"K\"\npage = \"k\"\n[[paper.item]]\nwhat = \"x\"\n";
        assert!(read(text).is_err_and(|error| error.contains("`id`")));
    }
}
