//! Kills fits of every method with several outputs and a record.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use msplines_common::mesh::polygon::PolygonMesh;
use msplines_common::mesh::shapes::{self, Opening};
use msplines_common::mesh::{TriangleMesh, curves::CurveNetwork};
use rand_pcg::Pcg64Mcg;

use super::moment::{Ended, Times, Victim, killed, undisturbed};
use super::tally::{Files, Tally, files, is_same, is_temporary};

/// A command on `in.obj`, and the ends of its outputs.
struct Fit {
    name: &'static str,
    arguments: &'static str,
    outputs: &'static [&'static str],
    input: fn() -> String,
}

/// Methods that end in tenths of a second, and between them every format that surfaces and splines are
/// written in. A trivariate fit takes a hundred times as long, and writes by the same function.
const FITS: [Fit; 7] = [
    Fit {
        name: "biharmonic",
        arguments: "fit biharmonic in.obj --knots 30",
        outputs: &["json", "ply", "obj", "vtu", "glb"],
        input: || triangles(&shapes::bumpy_sphere(300)),
    },
    Fit {
        name: "ls-mesh",
        arguments: "fit ls-mesh in.obj --controls 30",
        outputs: &["ply", "json", "glb"],
        input: || triangles(&shapes::torus(1.0, 0.4, 400)),
    },
    Fit {
        name: "powell-sabin",
        arguments: "fit powell-sabin in.obj",
        outputs: &["json", "vtu", "ply", "obj"],
        input: || triangles(&shapes::torus(1.0, 0.4, 200)),
    },
    Fit {
        name: "t-spline",
        arguments: "fit t-spline in.obj --control-points 100",
        outputs: &["step", "json", "vtu"],
        input: || triangles(&shapes::torus(1.0, 0.4, 400)),
    },
    Fit {
        name: "sparse-manifold",
        arguments: "fit sparse-manifold in.obj",
        outputs: &["ply", "json", "obj"],
        input: || quads(&shapes::box_surface([1, 1, 2])),
    },
    Fit {
        name: "curve-network",
        arguments: "fit curve-network in.obj",
        outputs: &["json", "ply"],
        input: || curves(&shapes::mushroom_network(6, Opening::Closed).network),
    },
    Fit {
        name: "conformal",
        arguments: "conformal in.obj",
        outputs: &["json", "obj", "glb"],
        input: || triangles(&shapes::torus(1.0, 0.4, 400)),
    },
];

/// The record of a run.
const RECORD: &str = "r.json";

/// A fit in a folder of its own, with what undisturbed runs give.
struct Bench<'a> {
    fit: &'a Fit,
    program: &'a Path,
    folder: PathBuf,
    old: Files,
    new: Files,
    times: Times,
}

/// Kills each fit in turn, `count` times in all.
pub(super) fn run(
    program: &Path,
    folder: &Path,
    count: u32,
    random: &mut Pcg64Mcg,
) -> Result<Vec<Tally>, String> {
    let mut tallies = Vec::new();
    for (index, fit) in (0_u32..).zip(&FITS) {
        let share = (count + FITS.len() as u32 - 1 - index) / FITS.len() as u32;
        if share == 0 {
            continue;
        }
        let bench = Bench::prepare(fit, program, &folder.join(fit.name))?;
        let mut tally = Tally::new(format!("fit {}", fit.name));
        for trial in 0..share {
            bench.trial(trial, random, &mut tally)?;
        }
        println!(
            "{}: {share} kills, {} faults",
            tally.phase,
            tally.faults.len()
        );
        tallies.push(tally);
    }
    Ok(tallies)
}

impl<'a> Bench<'a> {
    /// Runs the fit on an older mesh, half as large again, and on the mesh itself.
    fn prepare(fit: &'a Fit, program: &'a Path, folder: &Path) -> Result<Self, String> {
        make(folder)?;
        let mut bench = Self {
            fit,
            program,
            folder: folder.to_owned(),
            old: Files::new(),
            new: Files::new(),
            times: Times::default(),
        };
        let text = (fit.input)();
        bench.put(&Files::from([(
            "in.obj".to_owned(),
            scaled(&text).into_bytes(),
        )]))?;
        undisturbed(&mut bench.command(), &[])?;
        bench.old = bench.outputs()?;
        bench.put(&Files::from([("in.obj".to_owned(), text.into_bytes())]))?;
        bench.times = undisturbed(&mut bench.command(), &[bench.folder.clone()])?;
        bench.new = bench.outputs()?;
        for (name, new) in &bench.new {
            let is_told_apart = bench
                .old
                .get(name)
                .is_some_and(|old| !is_same(name, old, new));
            if !is_told_apart || bench.new.len() != fit.outputs.len() + 1 {
                return Err(format!("{}: {name} cannot tell old from new", fit.name));
            }
        }
        Ok(bench)
    }

    fn command(&self) -> Command {
        let mut command = Command::new(self.program);
        command.current_dir(&self.folder);
        command.args(self.fit.arguments.split_whitespace());
        for (index, output) in self.fit.outputs.iter().enumerate() {
            command.args(["-o", &format!("out{index}.{output}")]);
        }
        command.args(["--report", RECORD, "--threads", "1", "--quiet"]);
        command
    }

    /// Kills the fit once, looks at what is left, and runs it to its end.
    fn trial(&self, trial: u32, random: &mut Pcg64Mcg, tally: &mut Tally) -> Result<(), String> {
        for name in self.new.keys() {
            let _ = std::fs::remove_file(self.folder.join(name));
        }
        // Moments alternate; folders with and without older files alternate half as often.
        let is_filled = trial % 4 < 2;
        if is_filled {
            self.put(&self.old)?;
        }
        let moment = self.times.moment(trial, random);
        let watched = [self.folder.clone()];
        let (ended, _) = killed(&mut self.command(), &watched, moment, Victim::Program)?;
        match ended {
            Ended::Killed => tally.kills += 1,
            Ended::Before => tally.ended_before += 1,
        }
        let found = files(&self.folder)?;
        for (name, new) in &self.new {
            let old = self.old.get(name).filter(|_| is_filled);
            let found = found.get(name).map(Vec::as_slice);
            tally.count(name, found, old.map(Vec::as_slice), new);
        }
        tally.leftovers += self.leftovers(&found, tally);
        undisturbed(&mut self.command(), &[])?;
        let found = files(&self.folder)?;
        tally.leftovers_after += self.leftovers(&found, tally);
        for (name, new) in &self.new {
            if !found
                .get(name)
                .is_some_and(|bytes| is_same(name, bytes, new))
            {
                tally.fault(format!("the next run gives another {name}"));
            }
        }
        Ok(())
    }

    /// Returns the number of temporary files; whatever else does not belong there is a fault.
    fn leftovers(&self, found: &Files, tally: &mut Tally) -> u32 {
        let is_other = |name: &&String| *name != "in.obj" && !self.new.contains_key(*name);
        let mut count = 0;
        for name in found.keys().filter(is_other) {
            if is_temporary(name) {
                count += 1;
            } else {
                tally.fault(format!("{name} was left and cannot be recognised"));
            }
        }
        count
    }

    fn outputs(&self) -> Result<Files, String> {
        let mut found = files(&self.folder)?;
        found.remove("in.obj");
        Ok(found)
    }

    fn put(&self, files: &Files) -> Result<(), String> {
        for (name, bytes) in files {
            let path = self.folder.join(name);
            std::fs::write(&path, bytes).map_err(|e| format!("{}: {e}", path.display()))?;
        }
        Ok(())
    }
}

/// Makes a folder.
pub(super) fn make(folder: &Path) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))
}

fn triangles(mesh: &TriangleMesh) -> String {
    let points = mesh.positions().iter().map(|p| [p.x, p.y, p.z]);
    obj(points, 'f', mesh.faces().iter().map(|face| face.to_vec()))
}

fn quads(mesh: &PolygonMesh) -> String {
    let points = mesh.positions().iter().map(|p| [p.x, p.y, p.z]);
    obj(
        points,
        'f',
        mesh.topology().faces().map(|face| face.to_vec()),
    )
}

fn curves(network: &CurveNetwork) -> String {
    let points = network.points().iter().map(|p| [p.x, p.y, p.z]);
    let curves = network.curves().iter();
    obj(points, 'l', curves.map(|curve| curve.points.clone()))
}

fn obj(
    points: impl Iterator<Item = [f64; 3]>,
    kind: char,
    cells: impl Iterator<Item = Vec<u32>>,
) -> String {
    let mut text = String::new();
    for [x, y, z] in points {
        let _ = writeln!(text, "v {x} {y} {z}");
    }
    for cell in cells {
        let corners: Vec<String> = cell.iter().map(|v| (v + 1).to_string()).collect();
        let _ = writeln!(text, "{kind} {}", corners.join(" "));
    }
    text
}

/// Returns the same mesh half as large again, exactly.
fn scaled(text: &str) -> String {
    let line = |line: &str| match line.strip_prefix("v ") {
        Some(point) => {
            let numbers = point.split(' ').flat_map(str::parse::<f64>);
            let grown: Vec<String> = numbers.map(|x| (1.5 * x).to_string()).collect();
            format!("v {}\n", grown.join(" "))
        }
        None => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::scaled;

    #[test]
    fn only_points_grow() {
        assert_eq!(scaled("v 1 -2 0.5\nf 1 2 3\n"), "v 1.5 -3 0.75\nf 1 2 3\n");
    }
}
