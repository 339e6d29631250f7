//! Which rows run, run again, or are taken from the store.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use msplines_compare::campaign::{Campaign, Reuse, RowResult};
use msplines_compare::display::{Display, Verbosity};

use crate::project::{EXPERIMENT, Project, RECORD, campaign, results, run, without_times};

/// Names the folder for [`a_campaign_to_be_killed`].
const KILLED: &str = "MSPLINES_CAMPAIGN_TO_BE_KILLED";

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
        .args(["--exact", "rows::a_campaign_to_be_killed", "--ignored"])
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
