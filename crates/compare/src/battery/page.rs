//! The battery as a page and as a table for a terminal.

use std::collections::BTreeMap;
use std::fmt::Write;

use comfy_table::ContentArrangement;
use comfy_table::presets::UTF8_FULL_CONDENSED;

use super::defects::DEFECTS;
use super::peers::{MEASURED, MEASUREMENT, PEERS};
use super::{Group, Outcome, Row};

/// Groups with their titles and what is said of them.
const GROUPS: [(Group, &str, &str); 4] = [
    (
        Group::Meshes,
        "Twelve defects",
        "Each is put into a sound mesh, control mesh, network or solid.",
    ),
    (
        Group::Files,
        "Broken files",
        "Files of the library of models, as found or made.",
    ),
    (
        Group::Options,
        "Options at and beyond their limits",
        "Everything else about the command and its input is sound.",
    ),
    (
        Group::Splines,
        "Spoiled spline files",
        "Every field of every spline file, taken away or spoiled, one at a time.",
    ),
];
/// The method of the table beside the peers.
const SHOWN: &str = "fit biharmonic";

/// Returns how many rows of each group ended how, for a terminal.
#[must_use]
pub fn terminal(rows: &[Row]) -> String {
    let mut drawn = comfy_table::Table::new();
    drawn.load_style(UTF8_FULL_CONDENSED);
    drawn.set_content_arrangement(ContentArrangement::Dynamic);
    drawn.set_header(HEADER);
    for line in counted(rows) {
        drawn.add_row(line);
    }
    drawn.to_string()
}

const HEADER: [&str; 8] = [
    "cases",
    "command",
    "accepted",
    "stopped",
    "usage refused",
    "input refused",
    "method refused",
    "broken",
];

/// Returns a line for every group and command with the numbers of its outcomes.
fn counted(rows: &[Row]) -> Vec<Vec<String>> {
    let mut counts: BTreeMap<(Group, &str), [usize; 6]> = BTreeMap::new();
    for row in rows {
        let kind = match row.outcome {
            Outcome::Accepted => 0,
            Outcome::Stopped => 1,
            Outcome::Usage => 2,
            Outcome::Input => 3,
            Outcome::Method => 4,
            Outcome::Broken(_) => 5,
        };
        counts.entry((row.group, &row.method)).or_default()[kind] += 1;
    }
    let title = |group: Group| GROUPS.iter().find(|g| g.0 == group).map_or("", |g| g.1);
    let line = |((group, method), kinds): ((Group, &str), [usize; 6])| {
        let start = [title(group).to_owned(), method.to_owned()];
        start
            .into_iter()
            .chain(kinds.map(|n| n.to_string()))
            .collect()
    };
    counts.into_iter().map(line).collect()
}

/// Returns the page.
#[must_use]
pub fn markdown(rows: &[Row]) -> String {
    let mut text = String::from(INTRODUCTION);
    let methods: std::collections::BTreeSet<&str> =
        rows.iter().map(|r| r.method.as_str()).collect();
    let broken = rows
        .iter()
        .filter(|r| matches!(r.outcome, Outcome::Broken(_)))
        .count();
    let _ = writeln!(
        text,
        "{} cases of {} commands were run, {broken} of them broken.\n",
        rows.len(),
        methods.len()
    );
    table(&mut text, &HEADER, counted(rows).into_iter());
    beside_peers(&mut text, rows);
    for (group, title, about) in GROUPS {
        let _ = writeln!(text, "\n## {title}\n\n{about}");
        if group == Group::Files && !rows.iter().any(|row| row.group == group) {
            text.push_str("\nnot run: the library of models was not there.\n");
        }
        if group == Group::Splines {
            text.push_str("\nThe rows are in data/battery.json alone.\n");
            continue;
        }
        listed(&mut text, rows.iter().filter(|row| row.group == group));
    }
    text
}

const INTRODUCTION: &str = "# The hostile battery

<!-- Written by `cargo xtask battery --write-docs`. -->

What `msplines` says when something is wrong, case by case. Each case runs the program in a process of its own. It passes with a result
whose positions are finite and no farther than three diagonals from the input's box, or with a refusal that names the place and says what to
do: the command cannot be meant so (exit code 2), the input is refused (3), or the method cannot take it (4). A crash, a run of more than a
minute or 4 GiB, a number that is none, a surface far away, or a message without place or remedy would be broken. The same rows are in
[data/battery.json](../data/battery.json), against which `cargo xtask battery` compares all, and the tests a sample of options, spline files and repaired inputs.

";

fn table(text: &mut String, header: &[&str], lines: impl Iterator<Item = Vec<String>>) {
    let _ = writeln!(
        text,
        "| {} |\n|{}",
        header.join(" | "),
        "---|".repeat(header.len())
    );
    for line in lines {
        let cells: Vec<String> = line.iter().map(|cell| cell.replace('|', "\\|")).collect();
        let _ = writeln!(text, "| {} |", cells.join(" | "));
    }
}

/// Adds the twelve defects beside what the peers made of them.
fn beside_peers(text: &mut String, rows: &[Row]) {
    let _ = writeln!(text, "\n## Beside other tools\n\n{MEASUREMENT}\n");
    let of = |case: &str, method: &str| {
        let found = rows.iter().find(|r| {
            (r.group, r.case.as_str(), r.method.as_str()) == (Group::Meshes, case, method)
        });
        found.map_or_else(
            || "not applicable".to_owned(),
            |row| row.outcome.to_string(),
        )
    };
    let repaired = format!("{SHOWN} --repair");
    let header = [&["defect", "here", "here, `--repair`"][..], &PEERS].concat();
    let lines = DEFECTS.iter().zip(MEASURED).map(|(case, peers)| {
        let start = [(*case).to_owned(), of(case, SHOWN), of(case, &repaired)];
        start.into_iter().chain(peers.map(str::to_owned)).collect()
    });
    table(text, &header, lines);
    let _ = writeln!(
        text,
        "\n\"Here\" is `msplines {SHOWN}` on a mesh of 362 vertices; the other commands follow."
    );
}

/// Adds rows by command, those that ended alike together.
fn listed<'a>(text: &mut String, rows: impl Iterator<Item = &'a Row>) {
    let mut by_method: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        by_method.entry(&row.method).or_default().push(row);
    }
    for (method, rows) in by_method {
        let _ = writeln!(text, "\n### `msplines {method}`\n");
        let mut lines: Vec<(Vec<&str>, &Row)> = Vec::new();
        for row in rows {
            let alike = lines
                .iter_mut()
                .find(|(_, r)| (&r.outcome, &r.message) == (&row.outcome, &row.message));
            match alike {
                Some((cases, _)) => cases.push(&row.case),
                None => lines.push((vec![&row.case], row)),
            }
        }
        let lines = lines.into_iter().map(|(cases, row)| {
            let cases: Vec<String> = cases.iter().map(|case| format!("`{case}`")).collect();
            vec![
                cases.join("<br>"),
                row.outcome.to_string(),
                escaped(&row.message),
            ]
        });
        table(text, &["case", "outcome", "message"], lines);
    }
}

/// Returns a message as a cell shows it: nothing in it is markup.
fn escaped(message: &str) -> String {
    if message.is_empty() {
        return String::new();
    }
    let fence = if message.contains('`') { "``" } else { "`" };
    let pad = if message.starts_with('`') || message.ends_with('`') {
        " "
    } else {
        ""
    };
    format!("{fence}{pad}{message}{pad}{fence}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_ended_alike_stand_together() {
        let row = |case: &str, message: &str| Row {
            group: Group::Options,
            case: case.to_owned(),
            method: "info".to_owned(),
            outcome: Outcome::Usage,
            message: message.to_owned(),
        };
        let rows = [
            row("--a=1", "no"),
            row("--a=2", "no"),
            row("--b", "it's `c`"),
        ];
        let page = markdown(&rows);
        assert!(
            page.contains("| `--a=1`<br>`--a=2` | usage refused | `no` |"),
            "{page}"
        );
        assert!(
            page.contains("| `--b` | usage refused | `` it's `c` `` |"),
            "{page}"
        );
        assert!(
            page.contains("3 cases of 1 commands were run, 0 of them broken"),
            "{page}"
        );
        assert!(terminal(&rows).contains("info"));
    }
}
