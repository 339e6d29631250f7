//! A project of one experiment, whose rows a script answers.

use std::path::{Path, PathBuf};

use msplines_compare::campaign::{Campaign, Report, Reuse, RowResult};
use msplines_compare::display::{Display, Verbosity};
use msplines_compare::row_process::RowProgram;

pub(crate) const EXPERIMENT: &str = r#"
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

pub(crate) const RECORD: &str = r#"{"record":{"schema":"msplines.run/1","tool":{"version":"0","commit":"c","rustc":"r"},
"method":"biharmonic","input":{"file":"bumpy-sphere","sha256":"0","kind":"triangles","vertices":9,"faces":9,
"cells":0,"genus":0,"boundary_loops":0},"options":{},"outcome":"converged","dofs":3,"domain_bytes":9,
"error":{"kind":"vertices","mean":0.0004,"rms":0.0005,"max":0.001,"scale":1.0,"psnr_db":60.0},
"error_unit_cube":null,"distance":null,"checks":{"knots":1},
"seconds":{"total":1.5,"cpu":1.0,"phases":{"fit":1.0}},"peak_rss_bytes":1048576,"threads":1,"seed":0,
"warnings":[]}}"#;

/// A folder with an experiment, and a script for its rows.
pub(crate) struct Project {
    pub(crate) folder: tempfile::TempDir,
}

impl Project {
    pub(crate) fn new() -> Self {
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

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn runs(&self) -> usize {
        std::fs::read_to_string(self.path("log")).map_or(0, |log| log.lines().count())
    }

    pub(crate) fn run(&self) -> Report {
        run(&campaign(self.folder.path()))
    }
}

pub(crate) fn campaign(root: &Path) -> Campaign {
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
        threads: None,
        time_limit: None,
        program: interpreter,
    }
}

pub(crate) fn run(campaign: &Campaign) -> Report {
    campaign
        .run(&Display::new(Verbosity::Quiet))
        .expect("a campaign")
}

/// Returns a report without what differs between two runs of the same rows.
pub(crate) fn without_times(mut report: Report) -> Report {
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

pub(crate) fn results(report: &Report) -> Vec<&RowResult> {
    report.items[0].rows.iter().map(|row| &row.result).collect()
}
