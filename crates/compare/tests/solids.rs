//! Solids as rows of experiments: run, written, and drawn.

use std::path::Path;
use std::time::Instant;

use msplines_common::progress::unobserved;
use msplines_compare::campaign::{ItemReport, Report, RowReport, RowResult, Sources, Times};
use msplines_compare::case::Input;
use msplines_compare::experiment::{Ancestors, Experiment};
use msplines_compare::machine::Machine;
use msplines_compare::models::Provenance;
use msplines_compare::output::write_row_files;
use msplines_compare::record::{InputKind, Tool};
use msplines_compare::report::PageOptions;
use msplines_compare::report::viewer::Viewer;
use msplines_compare::run::{RunOutput, run};
use msplines_compare::verdict::Judgement;

const HEAD: &str = r#"
schema = "msplines.experiment/1"
paper = "p"
item = "i"
title = "solids"
columns = [{ path = "checks.degenerate_4", title = "degenerate" }]

[[row]]
id = "a"
label = "A"
surface = "SURFACE"
method = "trivariate"
solid = { spans = 4, fit = "least-squares", spacing = { along_diagonal = 12.0 }, validate_at = [4], cells = 2, sampling = { even = { interior = 6000, surface = 4000, surface_weight = 1.0 } }, cut = { axis = 1, keep = 0.7 } }
printed = { checks = { degenerate_4 = 3650 } }
"#;

fn experiment(surface: &str, panels: &[&str]) -> Experiment {
    let figure = "[[figure]]\nid = \"f\"\ncaption = \"c\"\n";
    let panel = |fields: &&str| format!("[[figure.panel]]\nrow = \"a\"\n{fields}\n");
    let panels: String = panels.iter().map(panel).collect();
    let text = HEAD.replace("SURFACE", surface);
    Experiment::parse(&format!("{text}{figure}{panels}"), "p/i.toml").expect("an experiment")
}

fn ran(experiment: &Experiment) -> (Input, RunOutput) {
    let row = &experiment.rows[0];
    let name = row.surface.as_deref().expect("a name");
    let input = row.generated(name).expect("a solid");
    let case = row.case(input.clone(), &Ancestors::default());
    let case = case.expect("a case");
    let output = run(&case, Instant::now(), &mut unobserved()).expect("a result");
    (input, output)
}

/// Writes the page of a row that ran, with its pictures.
fn page(experiment: Experiment, input: Input, output: RunOutput, folder: &Path) -> String {
    let files = folder.join("files");
    write_row_files(&files, &output).expect("written");
    let row = experiment.rows[0].clone();
    let report = RowReport {
        provenance: Provenance::Generated,
        command: String::new(),
        judgement: Judgement::of(&row, Provenance::Generated, &output.record),
        result: RowResult::Done(Box::new(output.record)),
        trace: None,
        sources: Some(Sources {
            input,
            files,
            view: None,
        }),
        row,
    };
    let report = Report {
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
            rows: vec![report],
            properties: experiment.properties,
            figures: experiment.figures,
            plots: experiment.plots,
        }],
    };
    let options = PageOptions {
        experiments: folder,
        pixels: 300,
        viewer: &Viewer::Script("// none".to_owned()),
        references: &[],
    };
    msplines_compare::report::write(&report, folder, &options).expect("written");
    std::fs::read_to_string(folder.join("index.html")).expect("a page")
}

const TILES: &str = "show = \"field\"\non = \"input\"\nfield = \"tile\"\ncolours = \"cells\"";
const SPLINE: &str = "show = \"spline\"\nedges = \"domain\"";
const CUT: &str = "show = \"field\"\non = \"cut\"\nfield = \"scaled_jacobian\"\nedges = \"domain\"";

#[test]
fn a_solid_is_drawn_with_tiles_lines_and_cut_open() {
    let experiment = experiment("bumpy-sphere-500", &[TILES, SPLINE, CUT]);
    let (input, output) = ran(&experiment);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("solids");
    let page = page(experiment, input, output, &folder);
    assert!(!page.contains("class=\"missing\""), "{page}");
    assert_eq!(page.matches("data-surface=").count(), 3);
    assert!(page.contains("degenerate, paper") && page.contains("3650"));
}

#[test]
fn a_panel_of_a_solid_that_cannot_be_drawn_says_why() {
    let error = "show = \"error\"";
    let absent = "show = \"field\"\non = \"cut\"\nfield = \"curvature\"";
    let experiment = experiment("box-2x2x2", &[error, absent]);
    let (input, output) = ran(&experiment);
    assert_eq!(output.record.input.kind, InputKind::Tets);
    assert_eq!(output.record.input.cells, 48);
    assert_eq!(output.record.dofs, 3 * 343);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let page = page(experiment, input, output, folder.path());
    assert!(page.contains("on the input instead"), "{page}");
    assert!(page.contains("no attribute `curvature`; there are: u, v, w, face, tile"));
}

#[test]
fn fields_that_contradict_each_other_are_refused() {
    let parse = |from: &str, to: &str| {
        let text = HEAD
            .replace("SURFACE", "bumpy-sphere-500")
            .replace(from, to);
        Experiment::parse(&text, "p/i.toml")
            .expect_err(to)
            .to_string()
    };
    let other = parse("\"trivariate\"", "\"ls-mesh\"\nknots = \"3%\"");
    assert!(
        other.contains("`solid` goes with trivariate splines"),
        "{other}"
    );
    let knots = parse("id = \"a\"", "id = \"a\"\nknots = \"30\"");
    assert!(knots.contains("has no knots"), "{knots}");
    let name = parse("bumpy-sphere-500", "box-0x1x1");
    assert!(name.contains("box-4x3x2"), "{name}");
    let field = parse("spans = 4", "spans = 4, knots = 3");
    assert!(field.contains("knots"), "{field}");
}
