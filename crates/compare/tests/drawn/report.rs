//! Reports of rows that a test ran, and their pages: several tests include this file.

use std::path::{Path, PathBuf};

use msplines_compare::campaign::{ItemReport, Report, RowReport, RowResult, Sources, Times};
use msplines_compare::case::Input;
use msplines_compare::experiment::{Experiment, Row};
use msplines_compare::machine::Machine;
use msplines_compare::models::Provenance;
use msplines_compare::record::{Record, Tool};
use msplines_compare::report::viewer::Viewer;
use msplines_compare::report::{PageOptions, write};
use msplines_compare::verdict::Judgement;

/// Returns the report of a generated row that gave a record, and files in a folder.
pub(crate) fn of_row(row: &Row, record: Record, input: Input, files: PathBuf) -> RowReport {
    RowReport {
        provenance: Provenance::Generated,
        command: String::new(),
        judgement: Judgement::of(row, Provenance::Generated, &record),
        result: RowResult::Done(Box::new(record)),
        trace: None,
        sources: Some(Sources {
            input,
            files,
            view: None,
        }),
        row: row.clone(),
    }
}

/// Returns the report of one experiment whose rows have these.
pub(crate) fn of_item(experiment: Experiment, rows: Vec<RowReport>) -> Report {
    Report {
        schema: String::new(),
        tool: Tool::this(),
        machine: Machine::this(),
        times: Times::Comparable,
        seconds: 0.0,
        items: vec![ItemReport {
            paper: experiment.paper,
            item: experiment.item,
            title: experiment.title,
            notes: experiment.notes,
            seconds: 0.0,
            columns: experiment.columns,
            rows,
            properties: experiment.properties,
            figures: experiment.figures,
            plots: experiment.plots,
        }],
    }
}

/// Writes a report into a folder and returns its page, on which panels are so many pixels wide.
pub(crate) fn page(report: &Report, folder: &Path, pixels: usize, viewer: &Viewer) -> String {
    let options = PageOptions {
        experiments: folder,
        pixels,
        viewer,
        references: &[],
    };
    write(report, folder, &options).expect("written");
    std::fs::read_to_string(folder.join("index.html")).expect("a page")
}
