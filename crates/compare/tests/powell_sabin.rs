//! The figures of He2005 that need no model: their rows run, their bounds hold, and every panel is drawn.

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

/// Returns the text of a figure of the paper.
fn text(item: &str) -> String {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/experiments/he2005");
    std::fs::read_to_string(data.join(format!("{item}.toml"))).expect("an experiment")
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
fn page(text: &str) -> String {
    let mut experiment = Experiment::parse(text, "he2005/item.toml").expect("an experiment");
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
    };
    msplines_compare::report::write(&report, folder.path(), &options).expect("written");
    std::fs::read_to_string(folder.path().join("index.html")).expect("a page")
}

#[test]
fn every_panel_of_the_generated_figures_is_drawn() {
    // Figures 1 and 8 are of the same kinds, on larger surfaces.
    for item in [
        "figure2", "figure3", "figure4", "figure5", "figure6", "figure7", "holes",
    ] {
        let page = page(&text(item));
        assert!(!page.contains("class=\"missing\""), "{item}: {page}");
    }
}

#[test]
fn panels_that_a_row_cannot_fill_say_what_to_write() {
    let head =
        "schema = \"msplines.experiment/1\"\npaper = \"he2005\"\nitem = \"i\"\ntitle = \"t\"\n";
    let row =
        "[[row]]\nid = \"a\"\nlabel = \"A\"\nsurface = \"torus-500\"\nmethod = \"powell-sabin\"\n";
    let atlas = row.replace("powell-sabin", "conformal");
    let figure = "[[figure]]\nid = \"f\"\ncaption = \"\"\n[[figure.panel]]\nrow = \"a\"\n";
    for (row, show, why) in [
        (row, "show = \"refinement\"", "layout = &quot;plane&quot;"),
        (row, "show = \"charts\"", "give their places"),
        (
            row,
            "show = \"spline\"\nclose = { mark = 0, radius = 0.1 }",
            "no mark 0",
        ),
        (
            &atlas,
            "show = \"control-triangles\"",
            "only Powell-Sabin splines",
        ),
        (&atlas, "show = \"isophotes\"", "exact normals"),
    ] {
        let page = page(&format!("{head}{row}{figure}{show}\n"));
        assert!(page.contains(why), "{show}: {page}");
    }
    for close in [
        "{ radius = 0.1 }",
        "{ mark = 0, at = [0, 0, 0], radius = 0.1 }",
        "{ mark = 0, radius = 0.0 }",
    ] {
        let text = format!("{head}{row}{figure}show = \"spline\"\nclose = {close}\n");
        let error = Experiment::parse(&text, "he2005/i.toml")
            .expect_err(close)
            .to_string();
        assert!(error.contains("`close` needs"), "{error}");
    }
}
