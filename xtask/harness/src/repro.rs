//! Reproduces the tables and figures of the papers: a thin caller of the comparison harness.

use std::path::{Path, PathBuf};
use std::time::Instant;

use msplines_compare::campaign::{Campaign, Report, Reuse};
use msplines_compare::display::{Display, Verbosity};
use msplines_compare::report::drawing::{DrawingOptions, Views, draw};
use msplines_compare::report::references::{self, Reference, ReferencesError};
use msplines_compare::report::viewer::{Viewer, bundle};
use msplines_compare::report::{self, PageOptions};
use msplines_compare::row_process::{RowProgram, answer};

use crate::references::RECORDS;
use crate::tree::root;

/// Arguments of `cargo xtask repro`.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Only this paper, such as hou2017.
    paper: Option<String>,
    /// Only this table or figure of it, such as table1.
    item: Option<String>,
    /// Only this row of it, and the rows it needs.
    wanted: Option<String>,
    /// Folder of the models; $MSPLINES_MODELS, else data/models, where absent.
    #[arg(long, value_name = "DIR")]
    models: Option<PathBuf>,
    /// Run the long rows too.
    #[arg(long)]
    full: bool,
    /// Folder for finished rows and the report.
    #[arg(long, value_name = "DIR", default_value = "report")]
    out: PathBuf,
    /// Run rows again that an earlier run finished.
    #[arg(long)]
    fresh: bool,
    /// Run only rows that failed; take all others as they are stored, from whatever build.
    #[arg(long, conflicts_with = "fresh")]
    only_failed: bool,
    /// Run no row; write the report of those that are stored, from whatever build.
    #[arg(long, conflicts_with_all = ["fresh", "only_failed"])]
    stored: bool,
    /// Rows at the same time; with more than one, times are not comparable.
    #[arg(long, value_name = "N", default_value_t = 1)]
    jobs: usize,
    /// Threads of each row; all cores, shared among the jobs, where absent. Results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: Option<u32>,
    /// Seconds after which any row is given up, where that is sooner than its own limit.
    #[arg(long, value_name = "SECONDS")]
    time_limit: Option<f64>,
    /// Leave out the 3D views, which need Node.js.
    #[arg(long)]
    still: bool,
    /// Write docs/results as well, which --full does when every row ran; not with an item.
    #[arg(long)]
    write_docs: bool,
    /// Run one row in this process: the file that asks and the file for the answer.
    #[arg(long, hide = true, num_args = 2, value_names = ["REQUEST", "ANSWER"])]
    row: Option<Vec<PathBuf>>,
}

/// Runs the experiments, writes the report and says what is wrong, if anything is.
pub(crate) fn run(args: &Args) -> Result<(), String> {
    let process_start = Instant::now();
    if let Some([asked, answered]) = args.row.as_deref() {
        return answer(asked, answered, process_start).map_err(|e| e.to_string());
    }
    let root = root();
    let campaign = campaign(args, &root)?;
    let report = campaign
        .run(&Display::new(Verbosity::Normal))
        .map_err(|e| e.to_string())?;
    print!("{}", report::terminal(&report));
    let mut written = write(&report, args, &root)?;
    let is_whole = args.item.is_none();
    if is_whole && (args.write_docs || args.full && is_complete(&report)) {
        written.extend(write_docs(&report, &root)?);
    }
    for path in written {
        println!("wrote {}", path.display());
    }
    let ended = conclude(&report);
    println!("the report: {}", args.out.join("index.html").display());
    ended
}

fn campaign(args: &Args, root: &Path) -> Result<Campaign, String> {
    let program = std::env::current_exe().map_err(|e| format!("this program has no path: {e}"))?;
    let arguments = ["repro", "--row"].map(str::to_owned).to_vec();
    Ok(Campaign {
        root: root.to_owned(),
        paper: args.paper.clone(),
        item: args.item.clone(),
        row: args.wanted.clone(),
        time_limit: args.time_limit,
        models: args.models.clone(),
        full: args.full,
        out: args.out.clone(),
        reuse: match (args.fresh, args.only_failed, args.stored) {
            (true, ..) => Reuse::Nothing,
            (_, true, _) => Reuse::AllButFailed,
            (_, _, true) => Reuse::Everything,
            _ => Reuse::Finished,
        },
        jobs: args.jobs,
        threads: args.threads.map(|threads| threads as usize),
        program: RowProgram {
            fingerprint: program.clone(),
            program,
            arguments,
        },
    })
}

/// Side of the pictures in a report, in pixels.
const PICTURE: usize = 800;

/// Draws the pictures and writes the report, and says how long that took.
fn write(report: &Report, args: &Args, root: &Path) -> Result<Vec<PathBuf>, String> {
    let started = Instant::now();
    let viewer = if args.still {
        Viewer::Absent("--still asked for them".to_owned())
    } else {
        bundle(&args.out.join("viewer"))
    };
    if let Viewer::Absent(reason) = &viewer {
        println!("surfaces in the report are still pictures: {reason}");
    }
    let options = PageOptions {
        experiments: &root.join("data/experiments"),
        pixels: PICTURE,
        viewer: &viewer,
        references: &compared(root)?,
    };
    let written = report::write(report, &args.out, &options).map_err(|e| e.to_string())?;
    println!("report made in {:.1} s", started.elapsed().as_secs_f64());
    Ok(written)
}

/// Returns what comparisons with other people's code found, if they ran here.
fn compared(root: &Path) -> Result<Vec<Reference>, String> {
    match references::read(&root.join(RECORDS)) {
        Err(ReferencesError::Absent { .. }) => Ok(Vec::new()),
        found => found.map_err(|e| e.to_string()),
    }
}

/// Returns whether every row ran.
fn is_complete(report: &Report) -> bool {
    let mut rows = report.items.iter().flat_map(|item| &item.rows);
    rows.all(|row| row.result.record().is_some())
}

/// The figures that the README shows, with their papers and items; drawn from generated surfaces, as all
/// that is committed.
const SHOWN: [(&str, &str, &str); 5] = [
    ("hou2017", "generated", "hou2017-generated-surfaces.png"),
    ("wang2016", "figure5", "wang2016-figure5-figure5.png"),
    ("kim2014", "figure1", "kim2014-figure1-bumpy-sphere.png"),
    ("he2005", "figure4", "he2005-figure4-genus-2.png"),
    ("he2006", "figure2", "he2006-figure2-overview.png"),
];
/// Side of its pictures in pixels.
const SHOWN_PICTURE: usize = 360;

fn write_docs(report: &Report, root: &Path) -> Result<Vec<PathBuf>, String> {
    let mut written = Vec::new();
    let mut put = |path: PathBuf, bytes: &[u8]| {
        report::replace(&path, bytes).map_err(|e| format!("{}: {e}", path.display()))?;
        written.push(path);
        Ok::<(), String>(())
    };
    let options = DrawingOptions {
        pixels: SHOWN_PICTURE,
        views: Views::Still,
    };
    let mut generated = report.clone();
    let is_shown = |paper: &str, item: &str| SHOWN.iter().any(|s| (s.0, s.1) == (paper, item));
    generated
        .items
        .retain(|item| is_shown(&item.paper, &item.item));
    for (name, png) in draw(&generated, options).sheets(&generated) {
        if SHOWN.iter().any(|shown| shown.2 == name) {
            put(root.join("docs/pictures").join(name), &png)?;
        }
    }
    for paper in report::papers(report) {
        let path = root.join("docs/results").join(format!("{paper}.md"));
        put(path, report::markdown(report, &paper).as_bytes())?;
    }
    Ok(written)
}

fn conclude(report: &Report) -> Result<(), String> {
    let failures = report.failures();
    let rows = report.items.iter().flat_map(|item| &item.rows);
    let (ran, all) = (
        rows.clone().filter(|r| r.result.record().is_some()).count(),
        rows.count(),
    );
    println!("{ran} of {all} rows ran, {} failed", failures.len());
    if failures.is_empty() {
        Ok(())
    } else {
        Err(failures.join("\nerror: "))
    }
}
