//! Every file that is broken on purpose: a result or a reason, never a crash or a NaN.

use std::path::{Path, PathBuf};

use crate::workbench::{Ran, Workbench, models};

/// Files of more bytes are large.
const LARGE: u64 = 200_000;
/// Files that fit as they are.
const CLEAN: [&str; 2] = ["igea_tristrips_raw.ply", "made_far_from_origin.obj"];
/// Files that fit once they are repaired.
const REPAIRABLE: [&str; 6] = [
    "bun_zipper_raw.ply",
    "many_small_holes.ply",
    "made_mixed_orientation.ply",
    "made_degenerate.ply",
    "made_triangle_soup.ply",
    "bones_26_components.off",
];

/// Checks that a run ended with a result or a reason.
pub(crate) fn check(ran: &Ran, what: &str) {
    assert!([0, 3, 4].contains(&ran.code), "{what}: {ran:?}");
    assert!(!ran.err.contains("panicked"), "{what}: {}", ran.err);
    if ran.code != 0 {
        let message = ran.err.lines().find(|line| line.starts_with("error: "));
        assert!(
            message.is_some_and(|line| line.len() > 20),
            "{what}: {}",
            ran.err
        );
    }
}

fn check_outputs(workbench: &Workbench, what: &str) {
    let soup = workbench.soup("o.ply");
    let finite = soup
        .positions
        .iter()
        .all(|p| p.iter().all(|x| x.is_finite()));
    assert!(finite && !soup.positions.is_empty(), "{what}: not finite");
    // JSON has no NaN: serde_json writes null, which no field of a number reads back from.
    let record: msplines_compare::record::Record =
        serde_json::from_slice(&workbench.bytes("r.json")).expect(what);
    assert!(
        record.error.is_some_and(|error| error.mean.is_finite()),
        "{what}"
    );
}

fn battery(workbench: &Workbench, path: &Path) {
    let name = path
        .file_name()
        .expect("a file")
        .to_string_lossy()
        .into_owned();
    let file = path.to_string_lossy().into_owned();
    // What is tested is how a run ends: few knots do where there are many vertices.
    let size = path.metadata().expect("readable").len();
    let share = if size > LARGE { "0.1%" } else { "3%" };
    for repair in [false, true] {
        let with = |mut arguments: Vec<&'static str>| {
            arguments.extend(repair.then_some("--repair"));
            arguments
        };
        for output in [vec!["info"], vec!["info", "--json"]] {
            let arguments = with(output);
            let ran = workbench.run_on(arguments.iter().copied().chain([file.as_str()]));
            check(&ran, &format!("{arguments:?} {name}"));
            assert!(
                !ran.out.to_lowercase().contains("nan\n"),
                "{name}: {}",
                ran.out
            );
        }
        let fits = [
            with(vec![
                "fit",
                "biharmonic",
                "--knots",
                share,
                "--effort",
                "fast",
            ]),
            with(vec!["fit", "ls-mesh", "--controls", share]),
        ];
        for fit in fits {
            // On a sound file of many vertices repair changes nothing, and each run takes long.
            let is_known = size > LARGE && CLEAN.contains(&name.as_str());
            if is_known && repair == fit.contains(&"biharmonic") {
                continue;
            }
            let what = format!("{fit:?} {name}");
            let outputs = ["-o", "o.ply", "--report", "r.json", file.as_str()];
            let ran = workbench.run_on(fit.iter().copied().chain(outputs));
            check(&ran, &what);
            let expected =
                CLEAN.contains(&name.as_str()) || (repair && REPAIRABLE.contains(&name.as_str()));
            assert!(!expected || ran.code == 0, "{what}: {}", ran.err);
            if ran.code == 0 {
                check_outputs(workbench, &what);
            }
        }
    }
}

/// Returns the broken files of the model library, if there is one.
pub(crate) fn broken_files() -> Option<Vec<PathBuf>> {
    let folder = models()?.join("hostile");
    let entries = std::fs::read_dir(folder).ok()?;
    let mut files: Vec<_> = entries
        .map(|entry| entry.expect("readable").path())
        .collect();
    files.sort();
    Some(files)
}

/// Tries every file, each in one of two folders.
pub(crate) fn each_of(files: &[PathBuf], battery: fn(&Workbench, &Path)) {
    std::thread::scope(|scope| {
        for half in 0..2 {
            let files = files.iter().skip(half).step_by(2);
            scope.spawn(move || {
                let workbench = Workbench::new();
                files.for_each(|path| battery(&workbench, path));
            });
        }
    });
}

#[test]
fn broken_files_give_a_result_or_a_reason() {
    match broken_files() {
        Some(files) => each_of(&files, battery),
        None => println!("not run: hostile"),
    }
}
