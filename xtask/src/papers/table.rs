//! The generated tables.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::citation::Citation;
use super::contents::Paper;

/// Line before a generated table.
pub(super) const BEGIN: &str = "<!-- citations:begin -->";
/// Line after a generated table.
pub(super) const END: &str = "<!-- citations:end -->";

/// Returns a page with what stands between its two markers replaced, or nothing without markers.
pub(super) fn replace(page: &str, table: &str) -> Option<String> {
    let (before, rest) = page.split_once(BEGIN)?;
    let (_, after) = rest.split_once(END)?;
    Some(format!("{before}{BEGIN}\n{table}{END}{after}"))
}

/// Returns the table of a paper: what claims each of its items.
pub(super) fn of_paper(paper: &Paper, citations: &[&Citation]) -> String {
    let mut out = String::from("| item | what | code | deviation |\n|---|---|---|---|\n");
    let mut unclaimed = Vec::new();
    for item in &paper.items {
        let own: Vec<_> = citations
            .iter()
            .filter(|c| c.items.contains(&item.id))
            .collect();
        for citation in &own {
            push_row(&mut out, &item.id, &item.what, citation);
        }
        if own.is_empty() && item.unclaimed.is_empty() {
            unclaimed.push(item.id.as_str());
        } else if own.is_empty() {
            push_cells(&mut out, &[&item.id, &item.what, "", &item.unclaimed]);
        }
    }
    for (place, citation) in elsewhere(paper, citations) {
        push_row(&mut out, &place, "", citation);
    }
    if !unclaimed.is_empty() {
        out.push_str(&format!("\nNothing claims {}.\n", unclaimed.join(", ")));
    }
    out
}

/// Returns the citations of sections, tables and figures, and those that name no place, by place.
fn elsewhere<'a>(paper: &Paper, citations: &[&'a Citation]) -> Vec<(String, &'a Citation)> {
    let is_item = |place: &String| paper.items.iter().any(|item| item.id == *place);
    let mut rows = Vec::new();
    for citation in citations.iter().filter(|c| !c.items.iter().any(is_item)) {
        rows.push((citation.items.join(", "), *citation));
    }
    rows.sort_by(|a, b| (&a.0, &a.1.name).cmp(&(&b.0, &b.1.name)));
    rows
}

/// Returns the table of the sources that have no page of their own.
pub(super) fn of_others(citations: &[&Citation]) -> String {
    let mut out = String::from("| source | place | code | deviation |\n|---|---|---|---|\n");
    let mut by_key: BTreeMap<&str, Vec<&Citation>> = BTreeMap::new();
    for citation in citations {
        by_key.entry(&citation.key).or_default().push(citation);
    }
    for (key, own) in by_key {
        for citation in own {
            push_row(&mut out, key, &citation.items.join(", "), citation);
        }
    }
    out
}

fn push_row(out: &mut String, first: &str, second: &str, citation: &Citation) {
    let code = format!("[`{}`](../../{})", citation.name, citation.path);
    push_cells(out, &[first, second, &code, &citation.deviation]);
}

fn push_cells(out: &mut String, cells: &[&str]) {
    for cell in cells {
        let cell = cell.replace('|', "\\|");
        let separator = if cell.is_empty() { "" } else { " " };
        // Writing to a string does not fail.
        let _ = write!(out, "|{separator}{cell} ");
    }
    out.push_str("|\n");
}

#[cfg(test)]
mod tests {
    use super::{BEGIN, END, push_cells, replace};

    #[test]
    fn only_what_stands_between_the_markers_is_replaced() {
        let page = format!("a\n{BEGIN}\nold\n{END}\nb\n");
        let table = "new\n";
        let expected = format!("a\n{BEGIN}\nnew\n{END}\nb\n");
        assert_eq!(replace(&page, table).as_deref(), Some(expected.as_str()));
        assert_eq!(replace("no markers", table), None);
    }

    #[test]
    fn a_bar_in_a_cell_does_not_end_it() {
        let mut out = String::new();
        push_cells(&mut out, &["|x|", ""]);
        assert_eq!(out, "| \\|x\\| | |\n");
    }
}
