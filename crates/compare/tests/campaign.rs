//! Campaigns over rows that a shell script answers: what is stored, resumed, judged and written.

#![cfg(unix)]

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use msplines_compare::campaign::{Campaign, Report, Reuse, RowResult};
use msplines_compare::display::{Display, Verbosity};
use msplines_compare::report::viewer::Viewer;
use msplines_compare::report::{self, PageOptions};
use msplines_compare::row_process::RowProgram;

const EXPERIMENT: &str = r#"
schema = "msplines.experiment/1"
paper = "p"
item = "i"
title = "two surfaces, a missing model and a long row"
notes = "All answers | come from a script."

[[row]]
id = "one"
label = "One"
surface = "bumpy-sphere"
method = "biharmonic"
knots = "1"
recorded = { error = 0.0004, tolerance = 0.05 }
analysis = "none needed"

[[row]]
id = "two"
label = "Two"
surface = "bumpy-sphere"
method = "ls-mesh"
knots = "2"
more_accurate_than = "one"

[[row]]
id = "three"
label = "Three"
model = "absent"
method = "biharmonic"
knots = "3"
printed = { error = 0.001 }
tolerance = 0.1

[[row]]
id = "after"
label = "After"
surface = "bumpy-sphere"
method = "biharmonic"
knots_from = "one"
compared_with = "one"
at_most = { "error.max" = 0.001, "checks.knots" = 1 }

[[row]]
id = "four"
label = "Four"
surface = "bumpy-sphere"
method = "biharmonic"
knots = "4"
full_only = true

[[figure]]
id = "f"
caption = "Figure <of> two rows"
[[figure.panel]]
row = "one"
show = "spline"
[[figure.panel]]
row = "three"
show = "error"
"#;

const MODELS: &str = r#"
schema = "msplines.models/1"

[[model]]
name = "absent"
file = "absent.ply"
real = true
status = "never there"
vertices = 4
faces = 4
genus = 0
boundary_loops = 0
sha256 = "00"
origin = "nobody"
terms = "none"
processing = "none"
"#;

/// Answers with `record.json` and two files, with half the error for row two; counts its runs in
/// `log`; while a file `crash` or `hang` lies in the folder, row two does that instead.
const SCRIPT: &str = r#"
cd "$(dirname "$0")"
echo run >> log
files=$(sed 's/.*"files":"\([^"]*\)".*/\1/' "$1")
mkdir -p "$files"
cp surface.ply knots.ply "$files"
if grep -q '"count":2' "$1"; then
    if [ -e crash ]; then echo 'out of luck' >&2; exit 101; fi
    while [ -e hang ]; do sleep 0.05; done
    sed 's/"mean":0.0004/"mean":0.0002/' record.json > "$2.part"
else
    cp record.json "$2.part"
fi
mv "$2.part" "$2"
"#;

const RECORD: &str = r#"{"record":{"schema":"msplines.run/1","tool":{"version":"0","commit":"c","rustc":"r"},
"method":"biharmonic","input":{"file":"bumpy-sphere","sha256":"0","kind":"triangles","vertices":9,"faces":9,
"cells":0,"genus":0,"boundary_loops":0},"options":{},"outcome":"converged","dofs":3,"domain_bytes":9,
"error":{"kind":"vertices","mean":0.0004,"rms":0.0005,"max":0.001,"scale":1.0,"psnr_db":60.0},
"error_unit_cube":null,"distance":null,"checks":{"knots":1},
"seconds":{"total":1.5,"cpu":1.0,"phases":{"fit":1.0}},"peak_rss_bytes":1048576,"threads":1,"seed":0,
"warnings":[]}}"#;

/// Names the folder for [`a_campaign_to_be_killed`].
const KILLED: &str = "MSPLINES_CAMPAIGN_TO_BE_KILLED";

struct Project {
    folder: tempfile::TempDir,
}

impl Project {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let put = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
            std::fs::write(path, text).expect("written");
        };
        put("data/experiments/p/i.toml", EXPERIMENT);
        put("data/models.toml", MODELS);
        put("row.sh", SCRIPT);
        put("record.json", RECORD);
        put("surface.ply", "a surface");
        put("knots.ply", "its knots");
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn runs(&self) -> usize {
        std::fs::read_to_string(self.path("log")).map_or(0, |log| log.lines().count())
    }

    fn run(&self) -> Report {
        run(&campaign(self.folder.path()))
    }
}

fn campaign(root: &Path) -> Campaign {
    // The script itself stands for the program, so that its bytes are part of the key.
    let program = root.join("row.sh");
    let interpreter = RowProgram {
        program: "/bin/sh".into(),
        arguments: vec![program.display().to_string()],
        fingerprint: program,
    };
    Campaign {
        root: root.to_owned(),
        paper: None,
        item: None,
        row: None,
        models: Some(root.join("models")),
        full: false,
        out: root.join("report"),
        reuse: Reuse::Finished,
        jobs: 1,
        time_limit: None,
        program: interpreter,
    }
}

fn run(campaign: &Campaign) -> Report {
    campaign
        .run(&Display::new(Verbosity::Quiet))
        .expect("a campaign")
}

/// Returns a report without what differs between two runs of the same rows.
fn without_times(mut report: Report) -> Report {
    report.seconds = 0.0;
    for item in &mut report.items {
        item.seconds = 0.0;
        for row in &mut item.rows {
            row.sources = None;
            if let Some(trace) = &mut row.trace {
                trace.seconds = 0.0;
                trace.history.clear();
            }
        }
    }
    report
}

fn results(report: &Report) -> Vec<&RowResult> {
    report.items[0].rows.iter().map(|row| &row.result).collect()
}

#[test]
fn rows_run_are_judged_and_are_not_run_again() {
    let project = Project::new();
    let report = project.run();
    let found = results(&report);
    assert!(matches!(found[0], RowResult::Done(_)) && matches!(found[1], RowResult::Done(_)));
    assert_eq!(found[2], &RowResult::NotRun("absent".to_owned()));
    assert!(matches!(found[3], RowResult::Done(_)));
    assert_eq!(found[4], &RowResult::NotRun("only with --full".to_owned()));
    assert_eq!(report.items[0].rows[1].judgement.claim_holds, Some(true));
    assert_eq!(report.failures(), Vec::<String>::new());
    assert_eq!(project.runs(), 3);
    assert_eq!(without_times(project.run()), without_times(report.clone()));
    assert_eq!(project.runs(), 3);
    let fresh = Campaign {
        reuse: Reuse::Nothing,
        ..campaign(project.folder.path())
    };
    assert_eq!(without_times(run(&fresh)), without_times(report));
    assert_eq!(project.runs(), 6);
    let full = Campaign {
        full: true,
        jobs: 2,
        ..campaign(project.folder.path())
    };
    assert!(matches!(results(&run(&full))[4], RowResult::Done(_)));
}

#[test]
fn a_crash_is_a_failed_row_and_only_it_runs_again() {
    let project = Project::new();
    std::fs::write(project.path("crash"), "").expect("written");
    let report = project.run();
    assert!(matches!(results(&report)[1], RowResult::Failed(why) if why.contains("out of luck")));
    let failures = report.failures();
    assert_eq!(failures.len(), 1);
    assert!(failures[0].starts_with("p i two: failed: "), "{failures:?}");
    let only_failed = || Campaign {
        reuse: Reuse::AllButFailed,
        ..campaign(project.folder.path())
    };
    assert_eq!(run(&only_failed()).failures().len(), 1);
    assert_eq!(project.runs(), 4);
    std::fs::remove_file(project.path("crash")).expect("removed");
    assert_eq!(run(&only_failed()).failures(), Vec::<String>::new());
    assert_eq!(project.runs(), 5);
    assert_eq!(project.run().failures(), Vec::<String>::new());
    assert_eq!(project.runs(), 5);
}

#[test]
fn a_row_that_others_need_runs_with_them_and_its_failure_is_theirs() {
    let project = Project::new();
    let only = Campaign {
        row: Some("after".to_owned()),
        ..campaign(project.folder.path())
    };
    let report = run(&only);
    assert_eq!(results(&report).len(), 2);
    assert!(
        results(&report)
            .iter()
            .all(|r| matches!(r, RowResult::Done(_)))
    );
    let unknown = Campaign {
        row: Some("none".to_owned()),
        ..only
    };
    let error = unknown.run(&Display::new(Verbosity::Quiet));
    let text = error.expect_err("no such row").to_string();
    assert!(
        text.contains("no row `none`") && text.contains("after"),
        "{text}"
    );
    std::fs::write(project.path("record.json"), "{").expect("written");
    let fresh = Campaign {
        reuse: Reuse::Nothing,
        ..campaign(project.folder.path())
    };
    let report = run(&fresh);
    let needs = "needs row one, which has no result";
    assert_eq!(results(&report)[3], &RowResult::NotRun(needs.to_owned()));
}

#[test]
fn a_row_that_two_items_show_runs_once() {
    let project = Project::new();
    let again = EXPERIMENT.replace("item = \"i\"", "item = \"j\"");
    std::fs::write(project.path("data/experiments/p/j.toml"), again).expect("written");
    let fresh = Campaign {
        reuse: Reuse::Nothing,
        ..campaign(project.folder.path())
    };
    let report = run(&fresh);
    assert_eq!(project.runs(), 3);
    assert_eq!(
        report.items[0].rows[0].result,
        report.items[1].rows[0].result
    );
}

#[test]
fn stored_rows_of_another_build_are_taken_only_when_asked_for() {
    let project = Project::new();
    project.run();
    let script = std::fs::read_to_string(project.path("row.sh")).expect("a script");
    std::fs::write(project.path("row.sh"), script + "# another build\n").expect("written");
    let stored = Campaign {
        reuse: Reuse::Everything,
        full: true,
        ..campaign(project.folder.path())
    };
    let report = run(&stored);
    assert_eq!(project.runs(), 3);
    assert!(matches!(results(&report)[0], RowResult::Done(_)));
    let absent = RowResult::NotRun("not in the store".to_owned());
    assert_eq!(results(&report)[4], &absent);
    project.run();
    assert_eq!(project.runs(), 6);
}

#[test]
fn a_false_claim_and_a_regression_fail() {
    let project = Project::new();
    let worse = RECORD.replace("0.0004", "0.0005");
    std::fs::write(project.path("record.json"), worse).expect("written");
    let failures = project.run().failures();
    assert_eq!(failures.len(), 2, "{failures:?}");
    assert!(
        failures[0].contains("p i one: worse than our recorded value"),
        "{failures:?}"
    );
    assert!(
        failures[1].contains("p i two: not more accurate"),
        "{failures:?}"
    );
}

#[test]
fn a_damaged_row_is_set_aside_and_runs_again() {
    let project = Project::new();
    project.run();
    let rows = || std::fs::read_dir(project.path("report/rows")).expect("readable");
    for entry in rows() {
        let path = entry.expect("readable").path();
        if path.is_file() {
            std::fs::write(path, "{").expect("written");
        }
    }
    assert_eq!(project.run().failures(), Vec::<String>::new());
    assert_eq!(project.runs(), 6);
    let damaged = rows().filter(|entry| {
        let path = entry.as_ref().expect("readable").path();
        path.extension()
            .is_some_and(|extension| extension == "damaged")
    });
    assert_eq!(damaged.count(), 3);
}

#[test]
fn a_killed_campaign_continues_where_it_stopped() {
    let project = Project::new();
    std::fs::write(project.path("hang"), "").expect("written");
    let mut child = Command::new(std::env::current_exe().expect("this test"))
        .args(["--exact", "a_campaign_to_be_killed", "--ignored"])
        .env(KILLED, project.folder.path())
        .stdout(Stdio::null())
        .spawn()
        .expect("started");
    let started = Instant::now();
    while project.runs() < 2 {
        assert!(
            started.elapsed() < Duration::from_secs(60),
            "the second row never started"
        );
        std::thread::sleep(Duration::from_millis(10));
    }
    child.kill().expect("killed");
    child.wait().expect("gone");
    std::fs::remove_file(project.path("hang")).expect("removed");
    assert_eq!(project.run().failures(), Vec::<String>::new());
    // The first row is from the killed run: the second one ran again, the third for the first time.
    assert_eq!(project.runs(), 4);
    let undisturbed = Project::new().run();
    assert_eq!(without_times(project.run()), without_times(undisturbed));
}

#[test]
#[ignore = "the child of a_killed_campaign_continues_where_it_stopped"]
fn a_campaign_to_be_killed() {
    if let Some(root) = std::env::var_os(KILLED) {
        run(&campaign(Path::new(&root)));
    }
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
    let options = PageOptions {
        experiments: &project.path("data/experiments"),
        pixels: 100,
        viewer: &Viewer::Absent("none here".to_owned()),
    };
    let written = report::write(&report, &project.path("report"), &options).expect("written");
    assert_eq!(written.len(), 4);
    let page = std::fs::read_to_string(project.path("report/index.html")).expect("written");
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
    let options = PageOptions {
        experiments: &project.path("data/experiments"),
        pixels: 100,
        viewer: &Viewer::Absent("none here".to_owned()),
    };
    report::write(&report, &project.path("report"), &options).expect("written");
    let page = std::fs::read_to_string(project.path("report/index.html")).expect("written");
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
fn titles_of_a_table_stand_above_their_cells() {
    let project = Project::new();
    let options = PageOptions {
        experiments: &project.path("data/experiments"),
        pixels: 100,
        viewer: &Viewer::Absent("none here".to_owned()),
    };
    report::write(&project.run(), &project.path("report"), &options).expect("written");
    let page = std::fs::read_to_string(project.path("report/index.html")).expect("written");
    // No evaluation and no printed times: columns that nobody fills are left out of both.
    let costs = page.split("id=\"p-i-costs\"").nth(1).expect("a table");
    let (head, body) = costs.split_once("<tbody>").expect("a body");
    let line = body.split("</tr>").next().expect("a line");
    let cells = line.matches("<td").count() + line.matches("<th").count();
    assert_eq!(head.matches("<th ").count(), cells);
    assert!(!head.contains("T_k paper"));
}

#[test]
fn the_experiments_of_the_project_can_be_read_and_name_known_models() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let manifest = msplines_compare::models::Manifest::read(&data.join("models.toml"));
    let manifest = manifest.expect("a manifest");
    let folder = data.join("experiments");
    let all = msplines_compare::experiment::experiments(&folder, None, None).expect("experiments");
    for experiment in &all {
        for model in experiment
            .rows
            .iter()
            .filter_map(|row| row.model.as_deref())
        {
            let (paper, item) = (&experiment.paper, &experiment.item);
            assert!(
                manifest.model(model).is_some(),
                "{paper} {item} names {model}"
            );
        }
    }
    let error = msplines_compare::experiment::experiments(&folder, Some("p"), None);
    assert!(
        error
            .expect_err("no such paper")
            .to_string()
            .contains("hou2017 table1")
    );
}
