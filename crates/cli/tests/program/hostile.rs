//! Everything that is wrong on purpose: a result or a reason, never a crash or a NaN.

use std::path::Path;

use msplines_compare::battery::{self, Battery, Extent};
use msplines_compare::display::{Display, Verbosity};

use crate::workbench::models;

/// A sample of `cargo xtask battery`, with the program of this profile: nothing may be broken, and every
/// case must end as recorded.
#[test]
fn the_battery_ends_as_recorded() {
    let files = models().map(|models| models.join("hostile"));
    let battery = Battery {
        program: env!("CARGO_BIN_EXE_msplines").into(),
        files: files.filter(|folder| folder.is_dir()),
        jobs: 2,
        extent: Extent::Sample,
    };
    if battery.files.is_none() {
        println!("not run: hostile");
    }
    let rows = battery::run(&battery, &Display::new(Verbosity::Quiet)).expect("the battery runs");
    let recorded = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/battery.json");
    let recorded = battery::recorded(&recorded).expect("a recorded battery");
    let mut wrong = battery::faults(&rows);
    wrong.extend(battery::changes(&rows, &recorded, Extent::Sample));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
