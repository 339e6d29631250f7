//! Writes what comparisons with other people's code found into `docs/references.md`.
//!
//! Deviations differ in their last digits from machine to machine, so that a check looks at what is
//! compared with what, and at the bounds.

use std::collections::BTreeSet;
use std::fs;

use msplines_compare::report::references::{self, Reference};

use crate::tree;

/// Where `cargo xtask test reference` gathers what its tests left.
pub(crate) const RECORDS: &str = "target/reference.json";
/// The page.
const PAGE: &str = "docs/references.md";
/// Line before the generated table.
const BEGIN: &str = "<!-- references:begin -->";
/// Line after the generated table.
const END: &str = "<!-- references:end -->";

/// Arguments of `cargo xtask references`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Change nothing; fail if the page shows other comparisons or bounds.
    #[arg(long)]
    check: bool,
    /// Some libraries are not here: what the page shows beyond the records is no fault.
    #[arg(long, requires = "check")]
    partial: bool,
}

/// Which comparisons should have left a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Expected {
    /// All of the page.
    All,
    /// Those whose libraries are there.
    Some,
}

/// Writes or checks the page.
pub(crate) fn run(args: &Args) -> Result<(), String> {
    if args.check && args.partial {
        return check(Expected::Some);
    }
    if args.check {
        return check(Expected::All);
    }
    tree::rewrite(PAGE, [BEGIN, END], &references::markdown(&records()?))?;
    println!("wrote {PAGE}");
    Ok(())
}

/// Fails if the page does not show the comparisons that were made, with their bounds.
fn check(expected: Expected) -> Result<(), String> {
    let (records, page) = (records()?, text()?);
    compare(&records, &page, expected)?;
    println!("ok     {PAGE} shows {} comparisons", records.len());
    Ok(())
}

fn records() -> Result<Vec<Reference>, String> {
    references::read(&tree::root().join(RECORDS)).map_err(|e| e.to_string())
}

fn text() -> Result<String, String> {
    let path = tree::root().join(PAGE);
    fs::read_to_string(path).map_err(|e| format!("cannot read {PAGE}: {e}"))
}

/// What two machines agree on: quantity, library, bound and its reason.
type Row = [String; 4];

fn compare(records: &[Reference], page: &str, expected: Expected) -> Result<(), String> {
    let made = rows(&references::markdown(records));
    let shown = page
        .split_once(BEGIN)
        .and_then(|(_, rest)| rest.split_once(END));
    let (shown, _) = shown.ok_or_else(|| format!("{PAGE} has no {BEGIN} and {END}"))?;
    let shown = rows(shown);
    let quantities = |rows: Vec<&Row>| {
        rows.iter()
            .map(|r| r[0].as_str())
            .collect::<Vec<_>>()
            .join(", ")
    };
    let new: Vec<&Row> = made.difference(&shown).collect();
    let gone: Vec<&Row> = shown.difference(&made).collect();
    if !new.is_empty() {
        let new = quantities(new);
        return Err(format!(
            "{PAGE} does not show {new} as compared: run `cargo xtask references`"
        ));
    }
    if expected == Expected::All && !gone.is_empty() {
        let gone = quantities(gone);
        return Err(format!(
            "{PAGE} shows {gone}, which nothing compared: run `cargo xtask test reference`, then \
             `cargo xtask references`"
        ));
    }
    Ok(())
}

/// Returns what the rows of a table in Markdown say, deviations and versions apart.
fn rows(table: &str) -> BTreeSet<Row> {
    let lines = table.lines().filter(|line| line.starts_with("| ")).skip(2);
    let row = |line: &str| {
        let line = line.trim_start_matches("| ").trim_end_matches(" |");
        let cells: Vec<&str> = line.split(" | ").collect();
        let &[quantity, reference, _, _, _, bound, why] = &cells[..] else {
            return None;
        };
        let library = reference
            .rsplit_once(' ')
            .map_or(reference, |(name, _)| name);
        Some([quantity, library, bound, why].map(str::to_owned))
    };
    lines.filter_map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(quantity: &str, version: &str, deviation: f64, bound: f64) -> Reference {
        Reference {
            quantity: quantity.to_owned(),
            reference: format!("Library {version}"),
            meshes: vec![version.to_owned()],
            largest_deviation: Some(deviation),
            at: "torus".to_owned(),
            bound,
            why_this_bound: "1 + |x|".to_owned(),
        }
    }

    fn page(records: &[Reference]) -> String {
        format!(
            "By hand.\n{BEGIN}\n{}{END}\n",
            references::markdown(records)
        )
    }

    #[test]
    fn versions_and_digits_may_differ_and_quantities_and_bounds_may_not() {
        let one = |quantity, bound| vec![record(quantity, "1.0", 1e-13, bound)];
        let shown = page(&one("area", 1e-12));
        let compare = |records: &[Reference], expected| compare(records, &shown, expected);
        let other = [record("area", "2.0", 3e-13, 1e-12)];
        assert_eq!(compare(&other, Expected::All), Ok(()));
        for records in [one("volume", 1e-12), one("area", 1e-11)] {
            let error = compare(&records, Expected::Some).err().unwrap_or_default();
            assert!(error.contains(&records[0].quantity), "{error}");
        }
        assert_eq!(compare(&[], Expected::Some), Ok(()));
        let error = compare(&[], Expected::All).err().unwrap_or_default();
        assert!(error.contains("shows area"), "{error}");
    }
}
