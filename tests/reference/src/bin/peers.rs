//! Other libraries on the same work: what `cargo xtask peers` starts.
//!
//! `peers PYTHON OUT [TASK...] [--models DIR] [--mba DIR] [--rounds N] [--missing PACKAGE=REASON]`
//! prints each row as it is there and writes OUT.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::PathBuf;
use std::{env, fs};

use msplines_compare::peers::Side;
use msplines_reference::peers::{Settings, run};

type Failure = Box<dyn Error>;

fn main() -> Result<(), Failure> {
    let (settings, out) = arguments(env::args().skip(1))?;
    let peers = run(&settings, &mut |row| {
        let seconds = |side: &Option<Side>| {
            let side = side.as_ref();
            side.map_or("none".to_owned(), |side| format!("{:.4}", side.median()))
        };
        println!(
            "{}, {}, {}: {} CPU s here, {} in {}{}",
            row.task,
            row.input,
            row.step,
            seconds(&row.ours),
            seconds(&row.theirs),
            row.peer,
            row.absent
                .as_ref()
                .map_or(String::new(), |why| format!(" ({why})")),
        );
    })?;
    fs::write(out, serde_json::to_string_pretty(&peers)?)?;
    Ok(())
}

fn arguments(mut given: impl Iterator<Item = String>) -> Result<(Settings, PathBuf), Failure> {
    let mut positional = || {
        given
            .next()
            .ok_or("usage: peers PYTHON OUT [TASK...] [OPTION...]")
    };
    let (python, out) = (positional()?.into(), positional()?.into());
    let mut settings = Settings {
        python,
        models: None,
        mba: None,
        rounds: 5,
        wanted: Vec::new(),
        missing: BTreeMap::new(),
    };
    while let Some(argument) = given.next() {
        let mut value = || given.next().ok_or(format!("{argument} needs a value"));
        match argument.as_str() {
            "--models" => settings.models = Some(value()?.into()),
            "--mba" => settings.mba = Some(value()?.into()),
            "--rounds" => settings.rounds = value()?.parse()?,
            "--missing" => {
                let told = value()?;
                let (package, reason) = told.split_once('=').ok_or("--missing PACKAGE=REASON")?;
                settings
                    .missing
                    .insert(package.to_owned(), reason.to_owned());
            }
            _ => settings.wanted.push(argument),
        }
    }
    Ok((settings, out))
}
