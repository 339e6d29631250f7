//! What a report of a campaign shows.

use msplines_compare::campaign::Report;
use msplines_compare::report::references::Reference;
use msplines_compare::report::viewer::Viewer;
use msplines_compare::report::{self, PageOptions};

use crate::project::{EXPERIMENT, Project, without_times};

/// Writes a report in every form, and returns its page.
fn written(project: &Project, report: &Report) -> String {
    written_beside(project, report, &[])
}

/// The same, with comparisons with other code.
fn written_beside(project: &Project, report: &Report, references: &[Reference]) -> String {
    let options = PageOptions {
        experiments: &project.path("data/experiments"),
        pixels: 100,
        viewer: &Viewer::Absent("none here".to_owned()),
        references,
    };
    let written = report::write(report, &project.path("report"), &options).expect("written");
    assert_eq!(written.len(), 4);
    std::fs::read_to_string(project.path("report/index.html")).expect("written")
}

#[test]
fn a_report_is_written_in_every_form() {
    let project = Project::new();
    let report = project.run();
    let text = report::terminal(&report);
    for part in [
        "0.0400 %",
        "not comparable",
        "not run: absent",
        "more accurate than one",
        "kept",
    ] {
        assert!(text.contains(part), "no `{part}` in\n{text}");
    }
    let page = report::markdown(&report, "p");
    assert!(
        page.contains("All answers \\| come from a script."),
        "{page}"
    );
    assert!(page.contains("| One | 9 | 1 | - | 0.0400 % |"), "{page}");
    let page = written(&project, &report);
    for part in [
        "<b>3</b> of 5 rows ran",
        "cargo xtask repro p i one",
        "Figure &lt;of&gt; two rows",
        "not run: absent",
        "Surfaces are still pictures here: none here",
        "data-value=\"0.0004\"",
    ] {
        assert!(page.contains(part), "no `{part}` in\n{page}");
    }
    let json = std::fs::read(project.path("report/report.json")).expect("written");
    let read: Report = serde_json::from_slice(&json).expect("JSON");
    assert_eq!(without_times(read), without_times(report));
    let csv = std::fs::read_to_string(project.path("report/report.csv")).expect("written");
    let judged = "p,i,one,bumpy-sphere,generated,biharmonic,1,error_mean,fraction,,0.0004,,0,not comparable,kept,";
    assert!(csv.lines().any(|line| line.starts_with(judged)), "{csv}");
}

/// Columns, which stand before the rows, and properties, which stand after them.
const COLUMNS: &str = r#"
columns = ["checks.knots", { path = "error.max", title = "largest", as = "percent" },
  { path = "seconds.phases.fit", title = "fit", as = "seconds" }]
"#;
const PROPERTIES: &str = r#"
[[property]]
name = "Partition of unity"
printed = { "Biharmonic <B>" = "Yes", "Tensor product" = "Yes" }
measured = { "Biharmonic <B>" = { row = "one", value = "error.max", at_most = 0.001, says = "largest error {value}" } }
remark = "Held to rounding."

[[property]]
name = "Any | topology"
printed = { "Biharmonic <B>" = "Yes", "Tensor product" = "No" }
measured = { "Biharmonic <B>" = { row = "three", value = "error.max", at_most = 1 }, "Loop" = { row = "two", value = "checks.knots", at_most = 0.5, says = "{value} knots" } }
"#;

#[test]
fn columns_and_properties_are_shown_in_every_form() {
    let project = Project::new();
    let text = EXPERIMENT.replacen("[[row]]", &format!("{COLUMNS}[[row]]"), 1) + PROPERTIES;
    std::fs::write(project.path("data/experiments/p/i.toml"), text).expect("written");
    let report = project.run();
    let missed = "p i two: Any | topology of Loop: checks.knots is 1e0, not at most 5e-1";
    assert_eq!(report.failures(), [missed]);
    let page = report::markdown(&report, "p");
    for line in [
        "| recorded | regression | checks.knots | largest | fit |",
        "| 0.0400 % (+5 %) | kept | 1 | 0.1000 % | 1.00 s |",
        "| not run: absent | - | - | - | - | - |",
        "| property | Biharmonic <B> | Tensor product (printed) | Loop | remark |",
        "| Partition of unity | Yes<br>largest error 0.001, at most 0.001: ok | Yes | - | Held to rounding. |",
        "| Any \\| topology | Yes<br>three: not run | No | -<br>1 knots, at most 0.5: MISSED |  |",
    ] {
        assert!(page.contains(line), "no `{line}` in\n{page}");
    }
    let text = report::terminal(&report);
    for part in [
        "Properties: what is printed",
        "at most 0.5: MISSED",
        "1.00 s",
    ] {
        assert!(text.contains(part), "no `{part}` in\n{text}");
    }
    let page = written(&project, &report);
    for part in [
        "<th scope=\"col\">Biharmonic &lt;B&gt;</th>",
        "<th scope=\"col\">Tensor product<br><small>printed</small></th>",
        "<a class=\"mark ok\" href=\"#p-i-one\">largest error 0.001, at most 0.001: ok</a>",
        "<a class=\"mark missed\" href=\"#p-i-two\">1 knots, at most 0.5: missed</a>",
        "<a class=\"mark not-run\" href=\"#p-i-three\">three: not run</a>",
        "<button type=\"button\">largest</button>",
        "Any | topology of Loop: checks.knots is 1e0",
    ] {
        assert!(page.contains(part), "no `{part}` in\n{page}");
    }
}

#[test]
fn comparisons_with_other_code_are_shown_or_how_to_make_them() {
    let project = Project::new();
    let report = project.run();
    let page = written(&project, &report);
    assert!(
        page.contains("<code>cargo xtask test reference</code> compares"),
        "{page}"
    );
    let found = Reference {
        quantity: "area <of> a face".to_owned(),
        reference: "Some Library 5.5".to_owned(),
        meshes: vec!["torus".to_owned()],
        largest_deviation: Some(2.5e-13),
        at: "torus".to_owned(),
        bound: 1e-12,
        why_this_bound: "rounding".to_owned(),
    };
    let page = written_beside(&project, &report, &[found]);
    for part in [
        "<th scope=\"row\">area &lt;of&gt; a face</th>",
        ">2.5e-13</td>",
        "<caption>Largest deviations from code that nobody here wrote</caption>",
    ] {
        assert!(page.contains(part), "no `{part}` in\n{page}");
    }
    assert!(!page.contains("<code>cargo xtask test reference</code> compares"));
}

#[test]
fn titles_of_a_table_stand_above_their_cells() {
    let project = Project::new();
    let page = written(&project, &project.run());
    // No evaluation and no printed times: columns that nobody fills are left out of both.
    let costs = page.split("id=\"p-i-costs\"").nth(1).expect("a table");
    let (head, body) = costs.split_once("<tbody>").expect("a body");
    let line = body.split("</tr>").next().expect("a line");
    let cells = line.matches("<td").count() + line.matches("<th").count();
    assert_eq!(head.matches("<th ").count(), cells);
    assert!(!head.contains("T_k paper"));
}
