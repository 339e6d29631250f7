//! Moving control points of a spline.

use msplines_biharmonic::{BasisKind, BiharmonicSpline, ExplicitBasis};
use msplines_common::mesh::{TriangleMesh, VertexAttribute};
use msplines_common::progress::Observer;
use msplines_common::{Point3, Vector3};
use serde_json::json;

use super::{Produced, enter, fitted};
use crate::case::{Case, Edit, Move};
use crate::clock::PhaseClock;
use crate::error::RunError;
use crate::input::{FitData, LoadedInput};
use crate::spline_file::{StoredBiharmonic, StoredSpline};

/// Vertices that move by more than this share of the largest movement count as moved.
const MOVED: f64 = 0.01;

/// Control points around a place that are moved together, in the coordinates of the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shift {
    /// The place.
    pub at: Point3<f64>,
    /// By how much.
    pub by: Vector3<f64>,
    /// Distance within which control points move; the nearest one always does.
    pub within: f64,
}

impl Shift {
    fn of(step: &Move, mesh: &TriangleMesh) -> Self {
        let [low, high] = mesh.bounding_box();
        Self {
            at: low + (high - low).component_mul(&Vector3::from(step.at)),
            by: Vector3::from(step.by) * mesh.diagonal(),
            within: step.within * mesh.diagonal(),
        }
    }
}

/// Fits a spline and moves its control points.
///
/// # Errors
/// A spline that cannot be fitted, or data that have not three components.
pub(super) fn edit(
    case: &Case,
    input: &LoadedInput,
    data: &FitData,
    edit: &Edit,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<Produced, RunError> {
    let mut produced = fitted(case, input, data, clock, observer)?;
    let stored = &produced.fitted.stored;
    let spline = stored.biharmonic("edit")?.restore(&input.mesh)?;
    enter("domain", clock, observer);
    let shifts: Vec<Shift> = edit
        .moves
        .iter()
        .map(|m| Shift::of(m, &input.mesh))
        .collect();
    let (edited, control_points) = moved(&spline, &shifts, observer)?;
    enter("evaluate", clock, observer);
    let (mut values, before) = (edited.vertex_values()?, spline.vertex_values()?);
    let dimension = data.dimension;
    let shift = |v: usize| {
        let square = |i: usize| (values[i] - before[i]).powi(2);
        let range = v * dimension..(v + 1) * dimension;
        range.map(square).sum::<f64>().sqrt() / data.scale
    };
    let shifts: Vec<f64> = (0..input.mesh.vertex_count()).map(shift).collect();
    let largest = shifts.iter().copied().fold(0.0, f64::max);
    let count = shifts.iter().filter(|&&x| x > MOVED * largest).count();
    if edit.keep_detail {
        for (i, value) in values.iter_mut().enumerate() {
            *value += data.values[i] - before[i];
        }
    }
    for (name, value) in [
        ("moved_control_points", json!(control_points)),
        ("moved_share", json!(count as f64 / shifts.len() as f64)),
        ("largest_movement", json!(largest)),
    ] {
        produced.fitted.checks.insert(name.to_owned(), value);
    }
    produced.fitted.stored = StoredSpline::Biharmonic(StoredBiharmonic::of(&edited));
    produced.values = values;
    produced.mesh = input.mesh.clone();
    produced.fields = vec![VertexAttribute {
        name: "movement".to_owned(),
        values: shifts.iter().map(|x| 100.0 * x).collect(),
    }];
    Ok(produced)
}

/// Moves the control points of a stored spline.
///
/// # Errors
/// A spline of another method, or one whose values are no points of space.
pub(super) fn shifted(
    stored: &StoredSpline,
    shifts: &[Shift],
    mesh: &TriangleMesh,
    observer: &mut Observer<'_>,
) -> Result<StoredSpline, RunError> {
    let spline = stored.biharmonic("edit")?.restore(mesh)?;
    let (edited, _) = moved(&spline, shifts, observer)?;
    Ok(StoredSpline::Biharmonic(StoredBiharmonic::of(&edited)))
}

/// Moves the control points around some places, and returns how many were moved.
///
/// # Errors
/// A spline that has no basis.
pub(super) fn moved(
    spline: &BiharmonicSpline,
    steps: &[Shift],
    observer: &mut Observer<'_>,
) -> Result<(BiharmonicSpline, usize), RunError> {
    let mesh = spline.space().mesh();
    let (space, knots) = (spline.space(), spline.knots());
    let basis = ExplicitBasis::build(space, knots, BasisKind::JointQp, observer)?;
    let mut shifts = vec![Vector3::zeros(); knots.len()];
    for step in steps {
        for (knot, share) in around(mesh, knots, step) {
            shifts[knot] += step.by * share;
        }
    }
    let listed: Vec<(usize, Vec<f64>)> = shifts
        .iter()
        .enumerate()
        .filter(|(_, shift)| shift.norm() > 0.0)
        .map(|(knot, shift)| (knot, shift.iter().copied().collect()))
        .collect();
    Ok((basis.edit(spline, &listed)?, listed.len()))
}

/// Returns the knots that a move takes along, and how far: wholly in its middle, not at all at its
/// border. The nearest one goes wholly.
fn around(mesh: &TriangleMesh, knots: &[u32], step: &Shift) -> Vec<(usize, f64)> {
    let distance = |knot: usize| (mesh.positions()[knots[knot] as usize] - step.at).norm();
    let nearest = (0..knots.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
    let share = |knot: usize| {
        let relative = distance(knot) / step.within;
        if Some(knot) == nearest {
            1.0
        } else if relative < 1.0 {
            (1.0 - relative * relative).powi(2)
        } else {
            0.0
        }
    };
    let shares = (0..knots.len()).map(|knot| (knot, share(knot)));
    shares.filter(|(_, share)| *share > 0.0).collect()
}
