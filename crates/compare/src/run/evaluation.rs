//! Spline files, evaluated again.

use std::path::PathBuf;
use std::time::Instant;

use msplines_common::progress::{Observer, Outcome};
use serde_json::{Value, json};

use super::{
    Change, RunOutput, Shift, Summary, TSplineChanges, check_finite, edits, enter, manifold,
    powell_sabin, record, solid, sums, t_spline,
};
use crate::case::Data;
use crate::clock::PhaseClock;
use crate::error::{PowellSabinError, RunError, TrivariateError};
use crate::input::{fit_data, load_domain};
use crate::measure::{self, Measured};
use crate::output::{check_outputs, write_outputs};
use crate::record::{Checks, named};
use crate::spline_file::{SplineFile, StoredSpline};

/// What an evaluation of a spline file is asked to do.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// The spline file.
    pub spline: PathBuf,
    /// The mesh that was fitted, where the file does not hold it.
    pub mesh: Option<PathBuf>,
    /// Control points that are moved before.
    pub shifts: Vec<Shift>,
    /// Changes of a Powell-Sabin spline before, in this order.
    pub changes: Vec<Change>,
    /// What is asked of a T-spline alone.
    pub t_spline: TSplineChanges,
    /// Factor of the spline, and other splines on the same mesh that are added with theirs.
    pub sum: Option<(f64, Vec<(PathBuf, f64)>)>,
    /// Rounds of midpoint subdivision.
    pub subdivide: u32,
    /// Cells along the side of a span of a solid; as in its fit where absent.
    pub cells: Option<usize>,
    /// Parameters of a solid at which its points and derivatives are written instead.
    pub at: Option<PathBuf>,
    /// Control points of a solid that are moved before, and where to.
    pub moved: Vec<([usize; 3], [f64; 3])>,
    /// Files to write.
    pub outputs: Vec<PathBuf>,
    /// Seed in the record; evaluation itself uses none.
    pub seed: u64,
}

impl Evaluation {
    /// Whether what is evaluated is no more the spline of the file.
    fn changes_spline(&self) -> bool {
        self.sum.is_some() || !self.shifts.is_empty()
    }

    /// Refuses what a spline that is tessellated by itself does not have.
    pub(super) fn check_tessellated(&self, spline: &'static str) -> Result<(), RunError> {
        if self.changes_spline() {
            return Err(Self::no_moves(spline));
        }
        if self.at.is_some() || !self.moved.is_empty() || self.subdivide > 0 {
            return Err(RunError::without(
                spline,
                "parameters and subdivision",
                "leave them out, or give --tessellate",
            ));
        }
        Ok(())
    }

    /// Refuses sums and moved knots.
    pub(super) fn no_moves(spline: &'static str) -> RunError {
        RunError::without(spline, "sums and moves of knots", "leave them out")
    }

    /// Refuses what only solids have, and outputs that could not be written later.
    fn check_surface(&self, spline: &StoredSpline) -> Result<(), RunError> {
        let what = match self {
            _ if self.at.is_some() => "points at parameters",
            _ if !self.moved.is_empty() => "lattice of control points",
            _ if self.cells.is_some() => "spans to cut into cells",
            _ => return check_outputs(&self.outputs),
        };
        let method = spline.method();
        Err(TrivariateError::SolidOnly { what, method }.into())
    }
}

/// Evaluates a spline file and writes the surface.
///
/// # Errors
/// A spline or mesh file that cannot be used, or an output that cannot be written.
pub fn evaluate(
    evaluation: &Evaluation,
    process_start: Instant,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    let ended = read_and_evaluate(evaluation, process_start, observer);
    ended.map_err(|error| error.in_spline_file(&evaluation.spline))
}

fn read_and_evaluate(
    evaluation: &Evaluation,
    process_start: Instant,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    let mut clock = PhaseClock::start(process_start);
    enter("read", &mut clock, observer);
    let spline = SplineFile::read(&evaluation.spline)?;
    evaluation.t_spline.check_method(&spline.spline)?;
    match &spline.spline {
        StoredSpline::PowellSabin(_) => {
            return powell_sabin::evaluate(evaluation, spline, &mut clock, observer);
        }
        StoredSpline::TSpline(_) => {
            return t_spline::evaluate(evaluation, spline, &mut clock, observer);
        }
        // All others refuse what only these have.
        other if !evaluation.changes.is_empty() => {
            let method = other.method();
            return Err(PowellSabinError::NotReshaped { method }.into());
        }
        StoredSpline::Trivariate(_) => {
            return solid::evaluate(evaluation, spline, &mut clock, observer);
        }
        StoredSpline::SparseManifold(_) => {
            evaluation.check_surface(&spline.spline)?;
            return manifold::evaluate(evaluation, spline, &mut clock, observer);
        }
        other => evaluation.check_surface(other)?,
    }
    over_triangles(evaluation, spline, clock, observer)
}

/// Evaluates a spline at the vertices of the triangles that it lives on.
fn over_triangles(
    evaluation: &Evaluation,
    mut spline: SplineFile,
    mut clock: PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<RunOutput, RunError> {
    let given = evaluation.mesh.as_deref();
    let input = load_domain(&spline, given, &evaluation.spline, &mut clock)?;
    enter("domain", &mut clock, observer);
    if let Some((factor, others)) = &evaluation.sum {
        spline.spline = sums::sum(&spline, *factor, others, &input, &mut clock)?;
    }
    if !evaluation.shifts.is_empty() {
        spline.spline = edits::shifted(&spline.spline, &evaluation.shifts, &input.mesh, observer)?;
    }
    enter("evaluate", &mut clock, observer);
    let (mesh, values) = spline.spline.evaluate(&input.mesh, evaluation.subdivide)?;
    let dimension = spline.spline.dimension();
    check_finite(&values, dimension)?;
    enter("measure", &mut clock, observer);
    let names = component_names(&spline.options, dimension);
    // Neither a frame of an animation nor a changed spline is a fit of its domain.
    let is_frame = spline.options.get("frame").is_some();
    let measured = if names[0] == "x" && !is_frame && !evaluation.changes_spline() {
        let data = fit_data(&Data::Positions, &input)?;
        measure::against_data(&input, &data, &values, &Data::Positions)
    } else {
        Measured::default()
    };
    enter("write", &mut clock, observer);
    write_outputs(&evaluation.outputs, &spline, &mesh, &values, &names, &[])?;
    let summary = Summary {
        checks: counts(&spline, mesh.vertex_count()),
        outcome: Outcome::Converged,
        measured,
        seed: evaluation.seed,
    };
    let record = record(&input, &spline, summary, &mut clock);
    let knots = spline.spline.knot_places(&input.mesh);
    Ok(RunOutput {
        knots,
        ..RunOutput::new(record, Some(spline), mesh, values, names)
    })
}

/// Returns the numbers of knots and of points.
fn counts(spline: &SplineFile, points: usize) -> Checks {
    named([
        ("knots", json!(spline.spline.knots().len())),
        ("evaluated_points", json!(points)),
    ])
}

fn component_names(options: &Value, dimension: usize) -> Vec<String> {
    let names = |names: [&str; 3]| names.map(str::to_owned).to_vec();
    match serde_json::from_value(options["data"].clone()) {
        Ok(Data::Positions) if dimension == 3 => names(["x", "y", "z"]),
        Ok(Data::ColourPattern | Data::ColourImage) if dimension == 3 => {
            names(["red", "green", "blue"])
        }
        Ok(Data::Attributes(names)) if names.len() == dimension => names,
        _ => (0..dimension)
            .map(|component| format!("value_{component}"))
            .collect(),
    }
}
