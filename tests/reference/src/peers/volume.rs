//! Trivariate B-splines of scattered samples: multilevel and least squares.

use std::path::{Path, PathBuf};
use std::process::Command;

use msplines_common::progress::unobserved;
use msplines_compare::peers::PeerRow;
use msplines_io::{read_npy, sha256_file};
use msplines_trivariate::fit::{least_squares, multilevel};
use msplines_trivariate::{TrivariateSpline, VolumeSamples};
use nalgebra::Point3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Deserialize;
use serde_json::json;

use super::adapter::Inputs;
use super::contest::{Rival, Timed};
use super::factor::{Lap, largest_difference};
use super::surface::{Peer, contest_all};
use super::{Contest, Failure, Settings};

/// Samples of a fit, and other points at which it is judged.
const SAMPLES: usize = 100_000;
const TESTS: usize = 100_000;
/// Spans of the finest level of multilevel splines, from 2 on.
const FINEST: [usize; 3] = [16, 32, 64];
/// Spans of the fits by least squares.
const SPANS: [usize; 2] = [8, 16];
/// So little that it changes no digit that is shown; the peers do not smooth.
const SMOOTHING: f64 = 1e-12;
/// The fit is converged to the digits that are shown.
const TOLERANCE: f64 = 1e-8;

const LEAST_SQUARES: [Peer; 2] = [
    (
        "scipy",
        "least_squares",
        "SciPy NdBSpline.design_matrix, splu",
        "the normal equations by SuperLU",
    ),
    ("pygismo", "least_squares", "G+Smo gsFitting", ""),
];
/// Where the header may lie below the folder that the user names.
const HEADERS: [&str; 2] = ["mba/mba.hpp", "mba.hpp"];
/// Source of the program that times it, seen from this package.
const PROGRAM: &str = "cpp/mba.cc";

/// Samples of a ball over the cube, and points and values at which fits are judged.
struct Ball {
    samples: VolumeSamples,
    tests: Vec<[f64; 3]>,
    values: Vec<f64>,
    inputs: Inputs,
}

/// The ball of radius 1, the cube's faces as six caps.
fn ball(at: [f64; 3]) -> Point3<f64> {
    let [x, y, z] = at.map(|t| 2.0 * t - 1.0);
    let stretch = |a: f64, b: f64, c: f64| {
        a * (1.0 - (b * b + c * c) / 2.0 + b * b * c * c / 3.0)
            .max(0.0)
            .sqrt()
    };
    Point3::new(stretch(x, y, z), stretch(y, z, x), stretch(z, x, y))
}

impl Ball {
    fn build() -> Result<Self, Failure> {
        let mut random = Pcg64Mcg::seed_from_u64(3);
        let mut draw = |count: usize| -> Vec<[f64; 3]> {
            let point = |_| std::array::from_fn(|_| random.random());
            (0..count).map(point).collect()
        };
        let (parameters, tests) = (draw(SAMPLES), draw(TESTS));
        let map = |at: &[[f64; 3]]| -> Vec<Point3<f64>> { at.iter().map(|&at| ball(at)).collect() };
        let flat = |points: &[Point3<f64>]| -> Vec<f64> {
            points.iter().flat_map(|p| [p.x, p.y, p.z]).collect()
        };
        let (points, values) = (map(&parameters), flat(&map(&tests)));
        let inputs = Inputs::new()?;
        inputs.put("parameters", 3, parameters.as_flattened().to_vec())?;
        inputs.put("points", 3, flat(&points))?;
        inputs.put("tests", 3, tests.as_flattened().to_vec())?;
        Ok(Self {
            samples: VolumeSamples::build(parameters, points)?,
            tests,
            values,
            inputs,
        })
    }

    fn rms(&self, found: &[f64]) -> f64 {
        let squares = found
            .iter()
            .zip(&self.values)
            .map(|(x, y)| (x - y) * (x - y));
        (squares.sum::<f64>() / TESTS as f64).sqrt()
    }

    fn contest<'a>(
        task: &'a str,
        input: &'a str,
        quality: &'a dyn Fn(&[f64]) -> Option<f64>,
    ) -> Contest<'a> {
        Contest {
            task,
            input,
            steps: &["fit", "evaluate at 100,000 points"],
            measure: "root mean square distance from a ball of radius 1 at 100,000 other points",
            quality,
            difference: &|x, y| Some(largest_difference(x, y)),
        }
    }

    /// Ends the fit, evaluates, and returns the times.
    fn judge(&self, spline: &TrivariateSpline, mut lap: Lap) -> Timed {
        lap.end();
        let positions = self.tests.iter().map(|&at| spline.position(at));
        let found = positions.flat_map(|p| [p.x, p.y, p.z]).collect();
        lap.end();
        lap.with(found)
    }
}

pub(super) fn run_least_squares(settings: &Settings) -> Result<Vec<PeerRow>, Failure> {
    let ball = Ball::build()?;
    let quality = |found: &[f64]| Some(ball.rms(found));
    let mut rows = Vec::new();
    for spans in SPANS {
        let input = format!("100,000 samples, {spans}³ spans, 3 components");
        let contest = Ball::contest("Trivariate least squares, cubic", &input, &quality);
        let options = least_squares::Options {
            coarsest: spans,
            finest: spans,
            smoothing: SMOOTHING,
            tolerance: TOLERANCE,
            ..Default::default()
        };
        let mut ours = || {
            let lap = Lap::start();
            let fit = least_squares::fit(&ball.samples, &options, &mut unobserved())?;
            Ok(ball.judge(&fit.spline, lap))
        };
        let question = |ask: &str| json!({"ask": ask, "spans": spans});
        let peers = &LEAST_SQUARES;
        let found = contest_all(
            settings,
            &contest,
            peers,
            &ball.inputs,
            &question,
            &mut ours,
        )?;
        rows.extend(found);
    }
    Ok(rows)
}

pub(super) fn run_multilevel(settings: &Settings) -> Result<Vec<PeerRow>, Failure> {
    let ball = Ball::build()?;
    let quality = |found: &[f64]| Some(ball.rms(found));
    let program = compile(settings, &ball.inputs);
    let mut rows = Vec::new();
    for (finest, levels) in FINEST.into_iter().zip(4..) {
        let input = format!("100,000 samples, 2³ to {finest}³ spans, 3 components");
        let contest = Ball::contest("Multilevel B-splines", &input, &quality);
        let options = multilevel::Options {
            finest,
            ..multilevel::Options::PAPER
        };
        let rival = Rival {
            name: "mba",
            version: program
                .as_ref()
                .map(|(_, version)| version.clone())
                .map_err(Clone::clone),
            remark: "compiled with -O3 -march=native, this project for any x86-64",
        };
        let mut ours = || {
            let lap = Lap::start();
            let fit = multilevel::fit(&ball.samples, &options, &mut unobserved())?;
            Ok(ball.judge(&fit.spline, lap))
        };
        let mut theirs = || match &program {
            Ok((program, _)) => ask(program, &ball.inputs, levels),
            Err(reason) => Err(reason.clone().into()),
        };
        rows.extend(contest.run(settings, &rival, &mut ours, &mut theirs)?);
    }
    Ok(rows)
}

/// Compiles the program that times mba, whose header the user names, and returns it with what tells this
/// header from others, as it has no version.
fn compile(settings: &Settings, inputs: &Inputs) -> Result<(PathBuf, String), String> {
    let folder = settings.mba.as_deref();
    let folder = folder.ok_or("its header was not named (--mba DIR)")?;
    let header = HEADERS.map(|name| folder.join(name));
    let header = header.iter().find(|path| path.exists());
    let header = header.ok_or("there is no mba.hpp in the folder of --mba")?;
    let program = inputs.path().join("mba");
    let compiled = Command::new("c++")
        .args(["-std=c++17", "-O3", "-march=native", "-DNDEBUG", "-include"])
        .arg(header)
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join(PROGRAM))
        .arg("-o")
        .arg(&program)
        .status();
    match compiled {
        Ok(status) if status.success() => {
            let digest = sha256_file(header).map_err(|error| error.to_string())?;
            Ok((program, format!("header of sha256 {}", &digest[..8])))
        }
        Ok(_) => Err("its header does not compile".to_owned()),
        Err(error) => Err(format!("there is no C++ compiler: {error}")),
    }
}

#[derive(Deserialize)]
struct Answer {
    seconds: Vec<f64>,
}

fn ask(program: &Path, inputs: &Inputs, levels: u32) -> Result<Timed, Failure> {
    let output = Command::new(program)
        .arg(inputs.path())
        .arg(levels.to_string())
        .output()?;
    if !output.status.success() {
        return Err("its program failed".into());
    }
    let Answer { seconds } = serde_json::from_slice(&output.stdout)?;
    let result = read_npy(&inputs.path().join("result.npy"))?.values;
    Ok(Timed { seconds, result })
}
