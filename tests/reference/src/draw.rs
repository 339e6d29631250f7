//! What OpenCASCADE reads in a STEP file, through its program DRAW.
//!
//! `cargo xtask test reference` installs it.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::io;
use std::path::Path;
use std::process::{Command, Stdio};

use nalgebra::Point3;

/// Debian's name of the program.
const PROGRAM: &str = "occt-draw";

/// A file as OpenCASCADE has it after reading.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Numbers of distinct parts: `VERTEX`, `EDGE`, `FACE`, `SHELL`, `SOLID` and others.
    pub counts: BTreeMap<String, usize>,
    /// Whether the shape is valid, by the program's own check of topology and geometry.
    pub is_valid: bool,
    /// Number of wires of edges that only one face has.
    pub free_bounds: usize,
    /// The largest distance that it allows between an edge and its faces or vertices.
    pub tolerance: f64,
    /// Area.
    pub area: f64,
    /// Volume inside, if the shape is closed.
    pub volume: f64,
    /// All that was said.
    pub said: String,
}

/// Why a file has no shape.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum DrawError {
    /// The program cannot be run.
    #[error("{PROGRAM} cannot be run: {0}; `cargo xtask test reference` installs it")]
    Process(#[from] io::Error),
    /// The program did not say what was asked.
    #[error("{PROGRAM} did not tell `{missing}`; it said:\n{said}")]
    Answer {
        /// What is missing.
        missing: String,
        /// What it said.
        said: String,
    },
}

// A test that ends with an error shows this form of it.
impl std::fmt::Debug for DrawError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

/// Returns the version of OpenCASCADE.
///
/// # Errors
/// The program cannot be run.
pub fn version() -> Result<String, DrawError> {
    let said = run("puts [dversion]")?;
    let line = said.lines().find_map(|l| l.split("Technology ").nth(1));
    line.map(|version| version.trim().to_owned())
        .ok_or_else(|| missing("version", &said))
}

/// Returns the shape in a STEP file, with area and volume to `accuracy` of themselves.
///
/// # Errors
/// The program cannot be run or does not read a shape.
pub fn read_step(path: &Path, accuracy: f64) -> Result<Shape, DrawError> {
    let path = path.display();
    let said = run(&format!(
        "stepread {{{path}}} s *
         puts {{== parts}}
         puts [nbshapes s_1]
         puts {{== validity}}
         puts [checkshape s_1]
         puts {{== tolerance}}
         puts [maxtolerance s_1]
         puts {{== area}}
         puts [sprops s_1 {accuracy:e} -full]
         puts {{== volume}}
         puts [vprops s_1 {accuracy:e} -full]
         puts {{== free}}
         freebounds s_1 0
         puts [nbshapes s_1_c]
         puts [nbshapes s_1_o]
         puts {{== end}}"
    ))?;
    let section = |name: &str| {
        let start = format!("== {name}\n");
        let rest = said.split(&start).nth(1);
        rest.and_then(|rest| rest.split("\n== ").next())
            .ok_or_else(|| missing(name, &said))
    };
    let number = |name: &str, key: &str| {
        let value = section(name)?.lines().find_map(|line| {
            let (found, value) = line.split_once([':', '='])?;
            (found.trim() == key).then(|| value.trim().parse().ok())?
        });
        value.ok_or_else(|| missing(key, &said))
    };
    section("end")?;
    Ok(Shape {
        counts: counts(section("parts")?),
        is_valid: section("validity")?.contains("This shape seems to be valid"),
        free_bounds: section("free")?.lines().filter_map(wires).sum(),
        tolerance: largest(section("tolerance")?).ok_or_else(|| missing("tolerance", &said))?,
        area: number("area", "Mass")?,
        volume: number("volume", "Mass")?,
        said,
    })
}

/// Returns points of the faces of a shape in a STEP file at parameters of their surfaces; faces are
/// counted in the order of the file.
///
/// # Errors
/// The program cannot be run or does not find the faces.
pub fn surface_points(
    path: &Path,
    places: &[(usize, [f64; 2])],
) -> Result<Vec<Point3<f64>>, DrawError> {
    let path = path.display();
    let mut script = format!("stepread {{{path}}} s *\nset faces [explode s_1 F]\n");
    let mut last = None;
    for &(face, [u, v]) in places {
        if last != Some(face) {
            writeln!(script, "mksurface f [lindex $faces {face}]").unwrap_or_default();
            last = Some(face);
        }
        writeln!(
            script,
            "svalue f {u:e} {v:e} x y z\nputs [format {{== %.17g %.17g %.17g}} [dval x] [dval y] [dval z]]"
        )
        .unwrap_or_default();
    }
    let said = run(&script)?;
    let lines = said.lines().filter_map(|line| line.strip_prefix("== "));
    let points = lines.map(|line| {
        let numbers = line.split_whitespace().map(str::parse);
        let numbers: Vec<f64> = numbers.collect::<Result<_, _>>().ok()?;
        (numbers.len() == 3).then(|| Point3::new(numbers[0], numbers[1], numbers[2]))
    });
    let points: Option<Vec<Point3<f64>>> = points.collect();
    let points = points.filter(|points| points.len() == places.len());
    points.ok_or_else(|| missing("points", &said))
}

/// Runs commands in a process of its own, without a display, and returns what it said.
fn run(script: &str) -> Result<String, DrawError> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("script.tcl");
    std::fs::write(&path, format!("pload MODELING XSDRAW\n{script}\nexit\n"))?;
    let output = Command::new(PROGRAM)
        .args(["-b", "-f"])
        .arg(&path)
        .stdin(Stdio::null())
        .env_remove("DISPLAY")
        .output()?;
    let said =
        [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    Ok(said.concat())
}

fn missing(missing: &str, said: &str) -> DrawError {
    DrawError::Answer {
        missing: missing.to_owned(),
        said: said.to_owned(),
    }
}

/// Reads lines such as ` VERTEX    : 8`.
fn counts(text: &str) -> BTreeMap<String, usize> {
    let pairs = text.lines().filter_map(|line| {
        let (name, count) = line.split_once(':')?;
        Some((name.trim().to_owned(), count.trim().parse().ok()?))
    });
    pairs.collect()
}

/// Number of wires, if the line tells it.
fn wires(line: &str) -> Option<usize> {
    let (name, count) = line.split_once(':')?;
    (name.trim() == "WIRE").then(|| count.trim().parse().ok())?
}

/// The largest tolerance among those of faces, edges and vertices.
fn largest(text: &str) -> Option<f64> {
    let values = text.lines().filter_map(|line| {
        let (_, value) = line.split_once("Max")?;
        value.trim().parse::<f64>().ok()
    });
    values.reduce(f64::max)
}
