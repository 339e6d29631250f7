//! The folder that cases run in: sound inputs, files of numbers, and those of the library of models.

use std::path::{Path, PathBuf};

use msplines_common::mesh::shapes::{self, Opening};

use super::draft::Draft;
use super::law::{Bounds, OUTPUTS, judge};
use super::process::{self, End};
use super::subjects::{SPLINES, SUBJECTS, Subject};
use super::{Battery, BatteryError, Group, REPAIRED, Row, Trial};

/// A folder of its own for the cases of one worker.
pub(super) struct Bench {
    folder: tempfile::TempDir,
    program: PathBuf,
}

/// Files of more bytes have many vertices.
const SMALL: u64 = 200_000;
/// The sound inputs.
const SOUND: [&str; 8] = [
    "mesh.obj",
    "torus.obj",
    "ball.obj",
    "ring.obj",
    "solid.mesh",
    "box.obj",
    "net.obj",
    "patch.obj",
];

impl Bench {
    /// Returns a folder with the sound inputs, the splines that are fitted to them, and files of numbers.
    pub(super) fn new(battery: &Battery) -> Result<Self, BatteryError> {
        let folder = tempfile::tempdir().map_err(|source| BatteryError::Folder {
            path: std::env::temp_dir(),
            source,
        })?;
        Ok(Self {
            folder,
            program: battery.program.clone(),
        })
    }

    /// Fills the folder.
    pub(super) fn fill(&self) -> Result<(), BatteryError> {
        for name in SOUND {
            self.write(name, self.draft(name).text().as_bytes())?;
        }
        for (name, text) in self.numbers() {
            self.write(name, text.as_bytes())?;
        }
        for (name, command) in SPLINES {
            let line = format!("{command} --output={name}.json");
            let arguments: Vec<String> = line.split(' ').map(str::to_owned).collect();
            let ended = self.run(&arguments)?;
            if ended.end != End::Code(0) {
                return Err(BatteryError::Program {
                    arguments: line,
                    reason: ended.err.trim().to_owned(),
                });
            }
        }
        Ok(())
    }

    /// Returns a sound input.
    pub(super) fn draft(&self, name: &str) -> Draft {
        match name {
            "torus.obj" => Draft::of_triangles(&shapes::torus(1.0, 0.4, 300)),
            "ball.obj" => Draft::of_triangles(&shapes::sphere(92)),
            "ring.obj" => Draft::of_triangles(&shapes::torus(1.0, 0.4, 80)),
            "solid.mesh" => Draft::of_tets(&shapes::box_solid([3; 3])),
            "box.obj" => Draft::of_polygons(&shapes::box_surface([2; 3])),
            "patch.obj" => Draft::of_triangles(&shapes::height_field(100)),
            "net.obj" => Draft::of_curves(&shapes::mushroom_network(4, Opening::Closed).network),
            _ => Draft::of_triangles(&shapes::bumpy_sphere(362)),
        }
    }

    /// Returns files of numbers beside the meshes: for every vertex of `mesh.obj`, places, edges.
    fn numbers(&self) -> Vec<(&'static str, String)> {
        let mesh = self.draft("mesh.obj");
        let count = mesh.positions.len();
        let every = mesh.positions.iter().step_by(9);
        let mut places: Vec<String> = every.map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
        let knots = places.concat();
        places.push(places[0].clone());
        let rows = |text: &str| text.repeat(count);
        let heights = mesh
            .positions
            .iter()
            .map(|p| format!("{}\n", p[2]))
            .collect();
        let edge = &self.draft("box.obj").cells[0];
        let [a, b] = [edge[0] + 1, edge[1] + 1];
        vec![
            ("knots.obj", knots),
            ("twice.obj", places.concat()),
            ("heights.txt", heights),
            ("ones.txt", rows("1\n")),
            ("zeros.txt", rows("0\n")),
            ("minus.txt", rows("-1\n")),
            ("nan.txt", rows("nan\n")),
            ("huge.txt", rows("1e308\n")),
            ("short.txt", "1\n2\n3\n".to_owned()),
            ("words.txt", "one two three\n".to_owned()),
            ("empty.txt", String::new()),
            ("far.txt", "0 999999\n".to_owned()),
            ("loop.txt", "0 0\n".to_owned()),
            ("broken.npy", "\u{93}NUMPY".to_owned()),
            ("at.txt", "0 0 0\n0.5 0.5 0.5\n".to_owned()),
            ("outside.txt", "0 0 0\n0 1.5 0\n".to_owned()),
            ("edge.creases", format!("{a} {b} 10\n")),
            ("twice.creases", format!("{a} {b} 10\n{a} {b} 3\n")),
            ("nan.creases", format!("{a} {b} nan\n")),
            ("minus.creases", format!("{a} {b} -1\n")),
            ("far.creases", "1 999 10\n".to_owned()),
        ]
    }

    /// Copies all files of another folder.
    pub(super) fn copy_from(&self, other: &Self) -> Result<(), BatteryError> {
        let failed = |path: &Path| {
            let path = path.to_owned();
            move |source| BatteryError::Folder { path, source }
        };
        let from = other.folder.path();
        for entry in std::fs::read_dir(from).map_err(failed(from))? {
            let path = entry.map_err(failed(from))?.path();
            let name = path.file_name().unwrap_or_default();
            std::fs::copy(&path, self.folder.path().join(name)).map_err(failed(&path))?;
        }
        Ok(())
    }

    /// Writes an input.
    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), BatteryError> {
        let path = self.folder.path().join(name);
        std::fs::write(&path, bytes).map_err(|source| BatteryError::Folder { path, source })
    }

    /// Reads a file of the folder.
    pub(super) fn read(&self, name: &str) -> Result<Vec<u8>, BatteryError> {
        let path = self.folder.path().join(name);
        std::fs::read(&path).map_err(|source| BatteryError::Folder { path, source })
    }

    fn run(&self, arguments: &[String]) -> Result<process::Ended, BatteryError> {
        let ended = process::run(&self.program, arguments, self.folder.path());
        ended.map_err(|error| BatteryError::Program {
            arguments: arguments.join(" "),
            reason: error.to_string(),
        })
    }

    /// Runs a case and returns how it ended.
    pub(super) fn meet(&self, trial: &Trial) -> Row {
        for name in OUTPUTS {
            // Most cases leave nothing.
            let _ = std::fs::remove_file(self.folder.path().join(name));
        }
        let (outcome, message) = match self.run(&trial.arguments) {
            Ok(ended) => judge(&ended, trial.bounds, &trial.arguments, self.folder.path()),
            Err(error) => (super::Outcome::Broken(error.to_string()), String::new()),
        };
        Row {
            group: trial.group,
            case: trial.case.clone(),
            method: trial.method.clone(),
            outcome,
            message,
        }
    }
}

/// Returns the cases of the broken files in a folder, which are copied beside the other inputs.
pub(super) fn file_trials(bench: &Bench, folder: &Path) -> Result<Vec<Trial>, BatteryError> {
    let failed = |source| BatteryError::Folder {
        path: folder.to_owned(),
        source,
    };
    let entries = std::fs::read_dir(folder).map_err(failed)?;
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    let mut trials = Vec::new();
    for path in paths {
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let bytes = std::fs::read(&path).map_err(failed)?;
        bench.write(&name, &bytes)?;
        let bounds = msplines_io::read_soup(&path)
            .ok()
            .map(|soup| Bounds::around(soup.positions.iter().map(|p| [p.x, p.y, p.z])));
        let size = bytes.len() as u64;
        // What is tested is how a run ends: few knots do where there are many vertices.
        let share = if size > SMALL { "0.1%" } else { "10%" };
        let fitting = SUBJECTS.iter().filter(|subject| subject.files_up_to > size);
        for subject in fitting {
            trials.extend(
                ["", REPAIRED].map(|repair| file_trial(subject, &name, [share, repair], bounds)),
            );
        }
    }
    Ok(trials)
}

fn file_trial(
    subject: &Subject,
    name: &str,
    [share, repair]: [&str; 2],
    bounds: Option<Bounds>,
) -> Trial {
    let command = subject.command.replace("10%", share);
    Trial {
        group: Group::Files,
        case: name.to_owned(),
        method: format!("{}{repair}", subject.name),
        arguments: subject.arguments(&command, name, repair),
        bounds,
    }
}
