//! Figures drawn from the rows of an experiment that need no model.

use std::path::Path;
use std::time::Instant;

use msplines_common::progress::unobserved;
use msplines_compare::campaign::{ItemReport, Report, RowReport, RowResult, Sources, Times};
use msplines_compare::case::Input;
use msplines_compare::experiment::{Ancestors, Experiment, Row};
use msplines_compare::machine::Machine;
use msplines_compare::models::Provenance;
use msplines_compare::output::write_row_files;
use msplines_compare::record::Tool;
use msplines_compare::report::PageOptions;
use msplines_compare::report::viewer::Viewer;
use msplines_compare::run::run;
use msplines_compare::verdict::Judgement;

/// Returns the text of a figure of a paper.
pub(crate) fn text(paper: &str, item: &str) -> String {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/experiments");
    let file = data.join(paper).join(format!("{item}.toml"));
    std::fs::read_to_string(file).expect("an experiment")
}

/// Runs a row into `folder` and judges it.
fn ran(row: &Row, folder: &Path) -> RowReport {
    let surface = row.surface.as_deref().expect("a generated row");
    let input = row.generated(surface).expect("a surface");
    let case = row.case(input.clone(), &Ancestors::default());
    let output = run(&case.expect("a case"), Instant::now(), &mut unobserved());
    let output = output.unwrap_or_else(|error| panic!("{}: {error}", row.id));
    let files = folder.join(&row.id);
    write_row_files(&files, &output).expect("written");
    let judgement = Judgement::of(row, Provenance::Generated, &output.record);
    assert_eq!(judgement.failure(), None, "{}", row.id);
    RowReport {
        provenance: Provenance::Generated,
        command: String::new(),
        judgement,
        result: RowResult::Done(Box::new(output.record)),
        trace: None,
        sources: Some(Sources {
            input: match input {
                Input::Surface(surface) => Input::Surface(surface),
                other => panic!("{other:?} is no surface"),
            },
            files,
            view: None,
        }),
        row: row.clone(),
    }
}

/// Runs the generated rows of an experiment, draws its figures of them, and returns its page.
pub(crate) fn page(text: &str) -> String {
    let mut experiment = Experiment::parse(text, "paper/item.toml").expect("an experiment");
    experiment.rows.retain(|row| row.surface.is_some());
    let kept = |row: &str| experiment.rows.iter().any(|r| r.id == row);
    experiment
        .figures
        .retain(|figure| figure.panels.iter().all(|panel| kept(&panel.row)));
    assert!(!experiment.figures.is_empty(), "{}", experiment.item);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let rows = experiment.rows.iter().map(|row| ran(row, folder.path()));
    let report = Report {
        schema: String::new(),
        tool: Tool::this(),
        machine: Machine::this(),
        times: Times::Comparable,
        seconds: 0.0,
        items: vec![ItemReport {
            rows: rows.collect(),
            paper: experiment.paper,
            item: experiment.item,
            title: experiment.title,
            notes: experiment.notes,
            seconds: 0.0,
            columns: experiment.columns,
            properties: experiment.properties,
            figures: experiment.figures,
            plots: experiment.plots,
        }],
    };
    let options = PageOptions {
        experiments: folder.path(),
        pixels: 60,
        viewer: &Viewer::Absent("a test".to_owned()),
        references: &[],
    };
    msplines_compare::report::write(&report, folder.path(), &options).expect("written");
    std::fs::read_to_string(folder.path().join("index.html")).expect("a page")
}
