//! Other libraries on the same work: the same input and metric, by turns, processor seconds.
//!
//! `cargo xtask peers` runs it. Each task gives its input to both sides, this project's and a peer's,
//! turn after turn, and judges both results by one function. A peer that cannot be had is a row that
//! says why. What both sides must do first, such as reading files, is not timed.

mod adapter;
mod contest;
mod factor;
mod pursuit;
mod subdivision;
mod surface;
mod volume;

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::PathBuf;

use msplines_common::mesh::{Policy, TriangleMesh, accept, shapes};
use msplines_compare::machine::Machine;
use msplines_compare::peers::{PeerRow, Peers, SCHEMA};

use contest::Contest;

type Failure = Box<dyn Error>;

/// What to compare, and where to find it.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Python with the packages of `python/peers.txt`.
    pub python: PathBuf,
    /// Folder of models; generated surfaces of the same sizes without it.
    pub models: Option<PathBuf>,
    /// Folder that holds `mba/mba.hpp` or `mba.hpp`.
    pub mba: Option<PathBuf>,
    /// Repetitions of short tasks.
    pub rounds: usize,
    /// Parts of the names of tasks; all tasks if there are none.
    pub wanted: Vec<String>,
    /// Packages that could not be installed, and why.
    pub missing: BTreeMap<String, String>,
}

/// A task's name and what runs it.
type Task = (&'static str, fn(&Settings) -> Result<Vec<PeerRow>, Failure>);

const TASKS: [Task; 8] = [
    ("factor-middle", |settings| factor::run(settings, MIDDLE)),
    ("factor-large", |settings| factor::run(settings, LARGE)),
    ("surface-middle", |settings| surface::run(settings, MIDDLE)),
    ("surface-large", |settings| surface::run(settings, LARGE)),
    ("pursuit", pursuit::run),
    ("subdivision", subdivision::run),
    ("multilevel", volume::run_multilevel),
    ("least-squares", volume::run_least_squares),
];

/// Runs the tasks that are wanted, and tells `observer` each row as it is there.
///
/// # Errors
/// A model that cannot be read, a task of unknown name, or what this project refuses.
pub fn run(settings: &Settings, observer: &mut dyn FnMut(&PeerRow)) -> Result<Peers, Failure> {
    let wanted = |name: &str| {
        let mut words = settings.wanted.iter();
        settings.wanted.is_empty() || words.any(|word| name.contains(word.as_str()))
    };
    if !TASKS.iter().any(|(name, _)| wanted(name)) {
        let names: Vec<_> = TASKS.iter().map(|(name, _)| *name).collect();
        return Err(format!("no such task; there are {}", names.join(", ")).into());
    }
    let before = load();
    let mut rows = Vec::new();
    for (_, task) in TASKS.iter().filter(|(name, _)| wanted(name)) {
        let found = task(settings)?;
        found.iter().for_each(&mut *observer);
        rows.extend(found);
    }
    let mut order: Vec<String> = rows.iter().map(|row: &PeerRow| row.task.clone()).collect();
    order.dedup();
    // Both meshes of a task stand together.
    rows.sort_by_key(|row: &PeerRow| order.iter().position(|task| *task == row.task));
    Ok(Peers {
        schema: SCHEMA.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        machine: Machine::this(),
        load: [before, load()],
        threads: 1,
        rows,
    })
}

/// Returns the load of the machine over one, five and fifteen minutes, as far as the system tells.
fn load() -> String {
    let text = fs::read_to_string("/proc/loadavg").unwrap_or_default();
    text.split(' ').take(3).collect::<Vec<_>>().join(" ")
}

/// A model, or a surface of its size.
struct Stand {
    name: String,
    mesh: TriangleMesh,
}

/// The file of a model, and the vertices of a surface of its size.
type Model = (&'static str, usize);

const MIDDLE: Model = ("nefertiti_50k.ply", 49_971);
const LARGE: Model = ("igea_134k.ply", 134_345);

impl Settings {
    /// Returns the model, or a generated surface without a folder of models or without this one.
    fn stand(&self, (name, vertices): Model) -> Result<Stand, Failure> {
        let path = self.models.as_ref().map(|folder| folder.join(name));
        let (name, mesh) = match path.filter(|path| path.exists()) {
            Some(path) => {
                let soup = msplines_io::read_soup(&path)?;
                let known = name.split('_').next().unwrap_or(name);
                (known.to_owned(), accept(&soup, Policy::Refuse)?.mesh)
            }
            None => ("bumpy sphere".to_owned(), shapes::bumpy_sphere(vertices)),
        };
        let name = format!("{name}, {} vertices", mesh.vertex_count());
        Ok(Stand { name, mesh })
    }
}
