//! Panels of fields, drawn from a stored surface with attributes of its own.

use std::path::Path;

use msplines_common::Point3;
use msplines_common::mesh::{VertexAttribute, shapes};
use msplines_compare::campaign::{ItemReport, Report, RowReport, RowResult, Sources, Times};
use msplines_compare::case::Input;
use msplines_compare::experiment::Experiment;
use msplines_compare::machine::Machine;
use msplines_compare::models::Provenance;
use msplines_compare::record::{Record, Tool};
use msplines_compare::report::PageOptions;
use msplines_compare::report::viewer::Viewer;
use msplines_compare::verdict::Judgement;
use msplines_io::{Surface, write_surface};

const SURFACE: &str = "bumpy-sphere-5k";
/// Cells of the partition, which are also knots.
const CELLS: usize = 60;
/// A knot that the pictures show.
const SEEN: usize = 34;

const HEAD: &str = r#"
schema = "msplines.experiment/1"
paper = "p"
item = "i"
title = "fields"

[[row]]
id = "a"
label = "A"
surface = "bumpy-sphere-5k"
method = "biharmonic"
knots = "60"
"#;

const RECORD: &str = r#"{"schema":"msplines.run/1","tool":{"version":"0","commit":"c","rustc":"r"},
"method":"biharmonic","input":{"file":"bumpy-sphere-5k","sha256":"0","kind":"triangles","vertices":9,"faces":9,
"cells":0,"genus":0,"boundary_loops":0},"options":{},"outcome":"converged","dofs":3,"domain_bytes":9,
"error":null,"error_unit_cube":null,"distance":null,"checks":{"knots":60},
"seconds":{"total":1.5,"cpu":1.0,"phases":{"fit":1.0}},"peak_rss_bytes":1048576,"threads":1,"seed":0,
"warnings":[]}"#;

/// Writes the files of a row: a surface with fields, and knots.
fn write_files(folder: &Path) {
    let Ok(Input::Surface(surface)) = SURFACE.parse().map(Input::Surface) else {
        panic!("no surface");
    };
    let mesh = surface.mesh();
    let positions = mesh.positions();
    let knots: Vec<Point3<f64>> = (0..CELLS)
        .map(|k| positions[k * positions.len() / CELLS])
        .collect();
    let attribute = |name: &str, of: &dyn Fn(&Point3<f64>) -> f64| VertexAttribute {
        name: name.to_owned(),
        values: positions.iter().map(of).collect(),
    };
    let away = |p: &Point3<f64>, k: usize| (p - knots[k]).norm_squared();
    let nearest = |p: &Point3<f64>| {
        let order = (0..CELLS).min_by(|&a, &b| away(p, a).total_cmp(&away(p, b)));
        order.map_or(-1.0, |k| k as f64)
    };
    let attributes = [
        attribute("basis", &|p| (-4.0 * away(p, SEEN)).exp()),
        attribute("green_function", &|p| (5.0 * p.x).sin() * p.y - 0.2),
        attribute("cell", &nearest),
        attribute("red", &|p| 0.5 + 0.4 * p.x),
        attribute("green", &|p| 0.5 + 0.4 * p.y),
        attribute("blue", &|p| 0.5 + 0.4 * p.z),
    ];
    let write = |name: &str, surface: &Surface<'_>| {
        write_surface(&folder.join(name), surface).expect("written");
    };
    let surface = Surface {
        positions,
        faces: mesh.faces(),
        attributes: &attributes,
        ..Surface::default()
    };
    write("surface.ply", &surface);
    let points = Surface {
        positions: &knots,
        faces: &[],
        ..Surface::default()
    };
    write("knots.ply", &points);
}

/// Returns the report of one row whose files lie in `files`, with these panels.
fn report(files: &Path, panels: &[&str]) -> Report {
    let figure = "[[figure]]\nid = \"f\"\ncaption = \"c\"\ncolumns = 3\n";
    let panel = |fields: &&str| format!("[[figure.panel]]\nrow = \"a\"\n{fields}\n");
    let panels: String = panels.iter().map(panel).collect();
    let text = format!("{HEAD}{figure}{panels}");
    let experiment = Experiment::parse(&text, "p/i.toml").expect("an experiment");
    let row = experiment.rows[0].clone();
    let record: Record = serde_json::from_str(RECORD).expect("a record");
    let row = RowReport {
        provenance: Provenance::Generated,
        command: String::new(),
        judgement: Judgement::of(&row, Provenance::Generated, &record),
        result: RowResult::Done(Box::new(record)),
        trace: None,
        sources: Some(Sources {
            input: Input::Surface(SURFACE.parse().expect("a surface")),
            files: files.to_owned(),
            view: None,
        }),
        row,
    };
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
            rows: vec![row],
            properties: experiment.properties,
            figures: experiment.figures,
            plots: experiment.plots,
        }],
    }
}

/// Writes the report into `folder` and returns its page and the bytes of its figure.
fn written(report: &Report, folder: &Path, pixels: usize) -> (String, Vec<u8>) {
    let options = PageOptions {
        experiments: folder,
        pixels,
        viewer: &Viewer::Script("// none".to_owned()),
        references: &[],
    };
    msplines_compare::report::write(report, folder, &options).expect("written");
    let page = std::fs::read_to_string(folder.join("index.html")).expect("a page");
    let picture = std::fs::read(folder.join("pictures/p-i-f.png")).unwrap_or_default();
    (page, picture)
}

const BASIS: &str = "show = \"field\"\nfield = \"basis\"\ncolours = \"sequential\"\nknots = true";
const SIGNED: &str = "show = \"field\"\nfield = \"green_function\"\ncolours = \"diverging\"";
const CELL: &str = "show = \"field\"\nfield = \"cell\"\ncolours = \"cells\"\nknots = true";
const VALUES: &str = "show = \"field\"\ncolours = \"values\"";
const PLAIN: &str = "show = \"spline\"\nknots = true";

#[test]
fn every_kind_of_field_is_drawn_and_several_scales_stand_beside_their_panels() {
    let files = tempfile::tempdir().expect("a temporary folder");
    write_files(files.path());
    let report = report(files.path(), &[BASIS, SIGNED, CELL, VALUES, PLAIN]);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fields");
    let (page, picture) = written(&report, &folder, 400);
    assert!(!page.contains("class=\"missing\""), "{page}");
    assert_eq!(page.matches("data-surface=").count(), 5);
    assert_eq!(page.matches("<div class=\"scaled\">").count(), 2);
    for label in ["basis", "green function"] {
        assert!(page.contains(&format!("colour scale: {label}\"")));
    }
    let again = files.path().join("again");
    assert_eq!(written(&report, &again, 400), (page, picture));
}

#[test]
fn panels_of_one_field_share_a_scale_unless_they_ask_for_their_own() {
    let files = tempfile::tempdir().expect("a temporary folder");
    write_files(files.path());
    let bars = |panels: &[&str]| {
        let (page, _) = written(&report(files.path(), panels), files.path(), 60);
        let beside = page.matches("<div class=\"scaled\">").count();
        (page.matches("class=\"bar\"").count(), beside)
    };
    let own = format!("{BASIS}\nscale = \"own\"");
    assert_eq!(bars(&[BASIS, BASIS, CELL]), (1, 0));
    assert_eq!(bars(&[BASIS, &own]), (2, 2));
    assert_eq!(bars(&[BASIS, SIGNED]), (2, 2));
    assert_eq!(bars(&[CELL, VALUES]), (0, 0));
}

#[test]
fn a_panel_that_cannot_be_drawn_says_why_and_the_others_are_drawn() {
    let files = tempfile::tempdir().expect("a temporary folder");
    write_files(files.path());
    let bad = [
        (
            "field = \"bases\"",
            "no attribute `bases`; there are: basis, ",
        ),
        (
            "field = \"basis\"\ncolours = \"cells\"",
            "cells are whole numbers",
        ),
    ];
    for (field, why) in bad {
        let panel = format!("show = \"field\"\n{field}");
        let (page, picture) = written(&report(files.path(), &[&panel, CELL]), files.path(), 60);
        assert!(page.contains(why), "no `{why}` in\n{page}");
        assert_eq!(page.matches("data-surface=").count(), 1);
        assert!(!picture.is_empty());
    }
}

#[test]
fn a_field_needs_no_surface_like_its_domain() {
    let files = tempfile::tempdir().expect("a temporary folder");
    write_files(files.path());
    let mesh = shapes::torus(1.0, 0.3, 200);
    let heights = VertexAttribute {
        name: "height".to_owned(),
        values: mesh.positions().iter().map(|p| p.z).collect(),
    };
    let surface = Surface {
        positions: mesh.positions(),
        faces: mesh.faces(),
        attributes: &[heights],
        ..Surface::default()
    };
    write_surface(&files.path().join("surface.ply"), &surface).expect("written");
    let field = "show = \"field\"\nfield = \"height\"\nedges = \"domain\"\nknots = true";
    let error = "show = \"error\"";
    let (page, _) = written(&report(files.path(), &[field, error]), files.path(), 60);
    assert_eq!(page.matches("data-surface=").count(), 1);
    assert!(page.contains("its files are missing"), "{page}");
}
