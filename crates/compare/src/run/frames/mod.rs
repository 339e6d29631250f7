//! A run over time: one spline for every frame of an animation, in one space.
//!
//! The domain mesh stays; frames are functions on it. What depends on the mesh alone is assembled,
//! ordered and factored once. Each frame has its own knots.
//!
//! # Reference
//! [Hou2017] §8.1, Figure 9.

mod tally;
#[cfg(test)]
mod tests;

use std::path::Path;
use std::time::Instant;

use msplines_common::Point3;
use msplines_common::evaluate::VertexData;
use msplines_common::progress::{Observer, Outcome, Progress};
use msplines_io::{Surface, read_npy, write_surface};
use serde_json::{Value, json};

use super::shared_space::SharedSpace;
use super::{RunOutput, Summary, check_finite, domain, enter, options, record};
use crate::animation::{Animation, FrameError, Frames, Loaded};
use crate::case::{Case, Data, Task};
use crate::clock::PhaseClock;
use crate::error::RunError;
use crate::fit::{Fitted, following};
use crate::input::LoadedInput;
use crate::output::{is_array, write_array, write_outputs};
use crate::spline_file::SplineFile;
use tally::Tally;

/// Phases of a fit that the record tells apart; the domain is that of all frames.
const PHASES: [&str; 2] = ["select", "fit"];

/// An animation that was read, and what is asked of it.
pub(super) struct OverTime {
    frames: Frames,
    animation: Loaded,
}

/// A frame that pictures show.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownFrame {
    /// Its number in the animation, from 0.
    pub frame: usize,
    /// Positions that were fitted, `[vertex][x, y, z]`.
    pub data: Vec<f64>,
    /// Those of the spline, as evaluated from its stored form.
    pub values: Vec<f64>,
}

impl ShownFrame {
    /// Returns the names of the files of a row that hold the positions of a frame, and those of its
    /// spline.
    #[must_use]
    pub fn files(frame: usize) -> [String; 2] {
        [
            format!("frame-{frame}-data.ply"),
            format!("frame-{frame}.ply"),
        ]
    }

    /// Writes both as points.
    pub(crate) fn write(&self, folder: &Path) -> Result<(), RunError> {
        let files = Self::files(self.frame);
        for (name, values) in files.iter().zip([&self.data, &self.values]) {
            let positions: Vec<Point3<f64>> =
                values.chunks_exact(3).map(Point3::from_slice).collect();
            let points = Surface {
                positions: &positions,
                faces: &[],
                ..Surface::default()
            };
            let path = folder.join(name);
            write_surface(&path, &points).map_err(RunError::unwritten(&path))?;
        }
        Ok(())
    }
}

/// Reads the animation of a case that is about one: as its task says, or because its data are an
/// array of three dimensions.
pub(super) fn asked(case: &Case, input: &LoadedInput) -> Result<Option<OverTime>, RunError> {
    let over_time = |frames, animation| Some(OverTime { frames, animation });
    match (&case.task, &case.data) {
        (Task::Frames(frames), _) => {
            let animation = frames.animation.load(&input.mesh)?;
            Ok(over_time(frames.clone(), animation))
        }
        (Task::Fit, Data::Array(path)) if is_array(path) => match read_npy(path) {
            Ok(array) if array.shape.len() == 3 => {
                let animation = Loaded::of_array(&input.mesh, path, array)?;
                Ok(over_time(
                    Frames::all(Animation::Array(path.clone())),
                    animation,
                ))
            }
            // Data of a single surface; what is wrong with them is said where they are fitted.
            _ => Ok(None),
        },
        (Task::Fit | Task::Decompose { .. } | Task::Edit(_) | Task::Properties, _) => Ok(None),
    }
}

/// Fits every chosen frame, evaluates what is stored of it, and measures them all on one scale.
pub(super) fn run(
    case: &Case,
    over_time: &OverTime,
    input: &LoadedInput,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    refuse_single(case)?;
    let OverTime { frames, animation } = over_time;
    let chosen = frames.chosen.of(animation.frames)?;
    let shown = shown(frames, &chosen)?;
    enter("domain", clock, observer);
    let space = SharedSpace::build(case, input)?;
    enter("factor", clock, observer);
    let factored = Instant::now();
    let has_factor = space.factor()?;
    let factor_seconds = factored.elapsed().as_secs_f64();
    let keeps_all = case.outputs.iter().any(|path| is_array(path));
    let mut tally = Tally::start(animation, input, keeps_all);
    tally.factor_seconds = has_factor.then_some(factor_seconds);
    for (index, &frame) in chosen.iter().enumerate() {
        let _ = observer(&Progress::new("frames", index as u64, chosen.len() as u64));
        clock.enter("read");
        let data = animation.frame(frame);
        let started = Instant::now();
        let fitted = fit(&space, animation.dimension, &data, clock, observer)?;
        let constructed = Instant::now();
        clock.enter("evaluate");
        let values = space.evaluate(&fitted.stored)?;
        tally.seconds.push([
            constructed.duration_since(started).as_secs_f64(),
            constructed.elapsed().as_secs_f64(),
        ]);
        check_finite(&values, animation.dimension)?;
        clock.enter("measure");
        let stopped = fitted.outcome == Outcome::Stopped;
        // Something is shown even of a run that ends before its time.
        let is_shown = shown.contains(&frame) || stopped && tally.shown.is_empty();
        let frame = ShownFrame {
            frame,
            data,
            values,
        };
        tally.add(fitted, frame, is_shown);
        if stopped && index + 1 < chosen.len() {
            let (done, all) = (index + 1, chosen.len());
            tally
                .warnings
                .push(format!("stopped after {done} of {all} frames"));
            break;
        }
    }
    finish(case, over_time, input, tally, clock, observer)
}

/// Refuses what is asked of a single surface.
fn refuse_single(case: &Case) -> Result<(), RunError> {
    let asked = [
        ("--subdivide", case.subdivide > 0),
        ("--distance", case.measure_distance),
        ("--compared-with", case.reference.is_some()),
    ];
    match asked.into_iter().find(|(_, is_asked)| *is_asked) {
        Some((option, _)) => Err(RunError::NotOverTime { option }),
        None => Ok(()),
    }
}

fn shown(frames: &Frames, chosen: &[usize]) -> Result<Vec<usize>, FrameError> {
    match frames.shown.iter().find(|frame| !chosen.contains(frame)) {
        Some(&frame) => Err(FrameError::NotChosen { frame }),
        None if frames.shown.is_empty() => Ok(chosen.last().copied().into_iter().collect()),
        None => Ok(frames.shown.clone()),
    }
}

fn fit(
    space: &SharedSpace,
    dimension: usize,
    values: &[f64],
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<Fitted, RunError> {
    // A least-squares mesh reports a step of its selection only once it is made.
    clock.enter("select");
    let mut timed = following(&PHASES, clock, observer);
    space.fit(VertexData { dimension, values }, &mut timed)
}

fn finish(
    case: &Case,
    over_time: &OverTime,
    input: &LoadedInput,
    mut tally: Tally,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    let names = over_time.animation.names();
    let mut checks = tally.checks();
    let mesh = input.mesh.clone();
    checks.insert("evaluated_points".to_owned(), json!(mesh.vertex_count()));
    let last = tally.last_shown.take().ok_or(FrameError::None)?;
    let frames = std::mem::take(&mut tally.shown);
    let Some(ShownFrame { frame, values, .. }) = frames.last().cloned() else {
        return Err(FrameError::None.into());
    };
    let options = frame_options(case, over_time, &last.options, frame);
    let spline = SplineFile::new(domain(case, input), options, last.stored);
    enter("write", clock, observer);
    for path in &case.outputs {
        if is_array(path) {
            let shape = vec![tally.frames(), mesh.vertex_count(), names.len()];
            write_array(path, shape, tally.all.clone())?;
        } else {
            let output = std::slice::from_ref(path);
            write_outputs(output, &spline, &mesh, &values, &names, &[])?;
        }
    }
    let summary = Summary {
        checks,
        outcome: tally.outcome,
        measured: tally.measured(input),
        seed: case.seed,
    };
    let mut record = record(input, &spline, summary, clock);
    record.dofs = tally.coefficients();
    record.warnings.extend(tally.warnings);
    let are_positions = over_time.animation.are_positions();
    let knots = spline.spline.knot_places(&input.mesh);
    Ok(RunOutput {
        knots,
        frames: if are_positions { frames } else { Vec::new() },
        ..RunOutput::new(record, Some(spline), mesh, values, names)
    })
}

/// Returns the options of the method together with those of the run and of the frame that its
/// spline file holds.
fn frame_options(case: &Case, over_time: &OverTime, method: &Value, frame: usize) -> Value {
    let mut options = options(case, method);
    if over_time.animation.are_positions() {
        options["data"] = json!(Data::Positions);
    }
    options["frames"] = over_time.frames.described();
    options["frame"] = json!(frame);
    options
}
