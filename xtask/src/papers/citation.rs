//! Citations in doc comments.

use crate::tree::File;

/// A citation of one source by one item of the code.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Citation {
    /// Key of the source.
    pub(super) key: String,
    /// Places in the source: `Eq. (11)`, `Alg. 1`, `§6`.
    pub(super) items: Vec<String>,
    /// What is done differently, or nothing.
    pub(super) deviation: String,
    /// File that cites.
    pub(super) path: String,
    /// One-based line of the citation.
    pub(super) line: usize,
    /// Name of what cites, such as `biharmonic::fit::fit`.
    pub(super) name: String,
}

/// Returns the citations of a Rust file.
pub(super) fn collect(file: &File) -> Vec<Citation> {
    if !file.path.starts_with("crates/") || !file.is_rust() {
        return Vec::new();
    }
    let lines: Vec<&str> = file.text.lines().collect();
    let mut found = Vec::new();
    let mut inside = false;
    let mut entry: Option<(usize, String)> = None;
    for (index, line) in lines.iter().enumerate() {
        let doc = doc_text(line);
        let goes_on = inside && doc.is_some_and(|text| !text.is_empty() && !text.starts_with('#'));
        let starts = doc.is_some_and(|text| text.starts_with('['));
        if !goes_on || starts {
            let ended = entry.take();
            found.extend(
                ended
                    .into_iter()
                    .flat_map(|(at, text)| parse(file, &lines, at, &text)),
            );
        }
        match doc {
            Some(text) if goes_on && starts => entry = Some((index, text.to_owned())),
            Some(text) if goes_on => {
                if let Some((_, whole)) = &mut entry {
                    whole.push(' ');
                    whole.push_str(text);
                }
            }
            Some("# Reference" | "# References") => inside = true,
            Some("") => {}
            _ => inside = false,
        }
    }
    found.extend(
        entry
            .into_iter()
            .flat_map(|(at, text)| parse(file, &lines, at, &text)),
    );
    found
}

/// Returns the text of a doc comment line.
fn doc_text(line: &str) -> Option<&str> {
    let line = line.trim();
    line.strip_prefix("///")
        .or_else(|| line.strip_prefix("//!"))
        .map(str::trim)
}

/// Returns the citations of an entry: one, or several set apart by semicolons.
fn parse(file: &File, lines: &[&str], at: usize, text: &str) -> Vec<Citation> {
    let (places, deviation) = text.split_once("Deviation:").unwrap_or((text, ""));
    let cited = places
        .split(';')
        .filter_map(|part| part.trim().strip_prefix('[')?.split_once(']'));
    let citations = cited.map(|(key, places)| Citation {
        key: key.to_owned(),
        items: places_in(places),
        deviation: without_links(deviation.trim()),
        path: file.path.clone(),
        line: at + 1,
        name: name_of(file, lines, at),
    });
    citations.collect()
}

/// Returns the text with `[text](target)` replaced by its text: targets are meant for rustdoc.
fn without_links(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(middle) = rest.find("](") {
        let (Some(start), Some(length)) = (rest[..middle].rfind('['), rest[middle..].find(')'))
        else {
            break;
        };
        out.push_str(&rest[..start]);
        out.push_str(&rest[start + 1..middle]);
        rest = &rest[middle + length + 1..];
    }
    out + rest
}

/// Returns the places that `Eqs. (1), (2) and Alg. 3, §5.1` names, one by one.
fn places_in(text: &str) -> Vec<String> {
    let mut kind = "";
    let mut places = Vec::new();
    for word in text.split_whitespace() {
        let bare = word.trim_end_matches([',', ';', '.', ':']);
        match bare {
            "Eq" | "Eqs" | "Equation" | "Equations" => kind = "Eq.",
            "Alg" | "Algs" | "Algorithm" | "Algorithms" => kind = "Alg.",
            "Theorem" | "Theorems" => kind = "Theorem",
            "Fig" | "Figs" | "Figure" | "Figures" => kind = "Figure",
            "Table" | "Tables" => kind = "Table",
            "and" => {}
            _ if bare.starts_with('§') => places.push(bare.to_owned()),
            _ if !kind.is_empty() && is_number(bare) => places.push(format!("{kind} {bare}")),
            _ => kind = "",
        }
    }
    places
}

/// Whether this numbers an equation, `(11)`, or an algorithm, `1`.
fn is_number(word: &str) -> bool {
    let bare = word.trim_start_matches('(').trim_end_matches(')');
    bare.starts_with(|c: char| c.is_ascii_digit()) && bare.len() <= 4
}

/// Returns the name of the item that the doc comment around line `at` belongs to.
fn name_of(file: &File, lines: &[&str], at: usize) -> String {
    let module = module_of(&file.path);
    if lines[at].trim_start().starts_with("//!") {
        return module;
    }
    let is_apart = |line: &&&str| {
        let line = line.trim_start();
        !line.starts_with("//") && !line.starts_with("#[") && !line.is_empty()
    };
    let declaration = lines[at..]
        .iter()
        .find(is_apart)
        .copied()
        .unwrap_or_default();
    let words: Vec<&str> = declaration
        .split(|c: char| !c.is_alphanumeric() && c != '_')
        .filter(|word| !word.is_empty())
        .collect();
    let keyword = |word: &&str| ["fn", "struct", "enum", "trait", "type", "mod"].contains(word);
    let name = match words.iter().position(keyword) {
        Some(at) => words.get(at + 1),
        None => words
            .iter()
            .find(|word| !["pub", "crate", "super", "const"].contains(*word)),
    };
    format!("{module}::{}", name.copied().unwrap_or_default())
}

/// Returns `biharmonic::fit` for `crates/biharmonic/src/fit/mod.rs`.
fn module_of(path: &str) -> String {
    let parts: Vec<&str> = path.trim_end_matches(".rs").split('/').collect();
    let names = parts
        .iter()
        .filter(|part| !["crates", "src", "mod", "lib"].contains(*part));
    names
        .map(|name| name.replace('-', "_"))
        .collect::<Vec<_>>()
        .join("::")
}

#[cfg(test)]
mod tests {
    use super::{collect, places_in, without_links};
    use crate::tree::File;

    #[test]
    fn places_are_told_apart() {
        let found = places_in(" Eqs. (1), (2) and (3), Alg. 1 lines 9-12, §5.1, Theorem 2.");
        assert_eq!(
            found,
            [
                "Eq. (1)",
                "Eq. (2)",
                "Eq. (3)",
                "Alg. 1",
                "§5.1",
                "Theorem 2"
            ]
        );
    }

    #[test]
    fn several_sources_may_share_an_entry_and_links_lose_their_targets() {
        let code =
            "/// # Reference\n/// [A2000]; [B2001] §2. Deviation: as [`X`](super::X).\nfn f() {}";
        let found = collect(&File::new("crates/io/src/a.rs", code));
        let keys: Vec<_> = found.iter().map(|c| c.key.as_str()).collect();
        assert_eq!(keys, ["A2000", "B2001"]);
        assert_eq!(found[1].items, ["§2"]);
        assert_eq!(found[0].deviation, "as `X`.");
        assert_eq!(without_links("no (links) [here]"), "no (links) [here]");
    }

    #[test]
    fn a_citation_may_take_several_lines_and_names_what_follows() {
        let code = "\
//! Module.
//!
//! # Reference
//! [Hou2017] §5.

/// Solves.
/// # Reference
/// [Hou2017] Eq. (7). Deviation: two solves
/// instead of one.
/// [Lipman2010] §3.
///
/// # Errors
/// [Link] to elsewhere.
#[must_use]
pub fn solve<T>(x: T) {}
";
        let found = collect(&File::new("crates/ls-mesh/src/fit/mod.rs", code));
        let names: Vec<_> = found
            .iter()
            .map(|c| (c.key.as_str(), c.name.as_str()))
            .collect();
        let solve = "ls_mesh::fit::solve";
        let expected = [
            ("Hou2017", "ls_mesh::fit"),
            ("Hou2017", solve),
            ("Lipman2010", solve),
        ];
        assert_eq!(names, expected);
        assert_eq!(found[1].deviation, "two solves instead of one.");
        assert_eq!(found[1].line, 8);
    }
}
