//! Measuring the basis functions and the laws of a spline space.

use std::time::Instant;

use msplines_biharmonic::{
    BasisKind, BiharmonicSpline, ExplicitBasis, Form, KnotChoice, Options, combine, fit_in,
};
use msplines_common::evaluate::{Evaluator, Order, Samples, SurfaceSpline, VertexData};
use msplines_common::mesh::{SurfacePoint, VertexAttribute};
use msplines_common::progress::{Observer, unobserved};
use serde_json::json;

use super::{Produced, enter, fitted};
use crate::case::Case;
use crate::clock::PhaseClock;
use crate::error::RunError;
use crate::input::{FitData, LoadedInput};

/// Evaluations that are timed; the median counts.
const TIMINGS: usize = 9;

/// Fits a spline, builds its basis and measures what Table 2 of the paper says about it.
///
/// # Errors
/// A spline that cannot be fitted or has no basis.
pub(super) fn measure(
    case: &Case,
    input: &LoadedInput,
    data: &FitData,
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<Produced, RunError> {
    let mut produced = fitted(case, input, data, clock, observer)?;
    let stored = &produced.fitted.stored;
    let spline = stored.biharmonic("properties")?.restore(&input.mesh)?;
    enter("domain", clock, observer);
    let (space, knots) = (spline.space(), spline.knots());
    let basis = ExplicitBasis::build(space, knots, BasisKind::JointQp, observer)?;
    enter("measure", clock, observer);
    let locality = basis.locality()?;
    let control_points = basis.control_points(&spline)?;
    let back = basis.spline(&control_points, spline.dimension())?;
    let plain = spline.vertex_values()?;
    let numbers = [
        ("partition_of_unity", locality.unity_error),
        ("mass_outside_1", locality.outside[0]),
        ("mass_outside_2", locality.outside[1]),
        ("mass_outside_3", locality.outside[2]),
        ("worst_outside_2", locality.worst_outside),
        ("smallest_value", locality.smallest),
        ("negative_mass", locality.negative),
        ("condition", basis.condition()),
        (
            "round_trip_error",
            apart(&back.vertex_values()?, &plain) / data.scale,
        ),
        ("insertion_error", insertion(&spline, &plain)? / data.scale),
        (
            "combination_error",
            combination(&spline, data)? / data.scale,
        ),
    ];
    for (name, value) in numbers.into_iter().chain(costs(&spline)?) {
        produced.fitted.checks.insert(name.to_owned(), json!(value));
    }
    produced.fields = fields(&spline, &basis)?;
    Ok(produced)
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max)
}

/// Returns by how much a spline moves when knots are put in between its own.
fn insertion(spline: &BiharmonicSpline, plain: &[f64]) -> Result<f64, RunError> {
    let vertices = spline.space().mesh().vertex_count() as u32;
    let step = (vertices as usize / spline.knots().len()).max(2);
    let free = |v: &u32| spline.knots().binary_search(v).is_err();
    let new: Vec<u32> = (0..vertices).step_by(step).filter(free).collect();
    let more = spline.insert_knots(&new)?;
    Ok(apart(&more.vertex_values()?, plain))
}

/// Returns how far the sum of two splines with different knots is from the sum of their values.
fn combination(spline: &BiharmonicSpline, data: &FitData) -> Result<f64, RunError> {
    let space = spline.space();
    let vertices = space.domain().vertex_count() as u32;
    let step = (vertices as usize / spline.knots().len()).max(1);
    let options = Options {
        knots: KnotChoice::Given((step as u32 / 2..vertices).step_by(step).collect()),
        ..Options::default()
    };
    let values = VertexData {
        dimension: data.dimension,
        values: &data.values,
    };
    let other = fit_in(space, values, &options, &mut unobserved())?.spline;
    let sum = combine(&[(spline, 1.5), (&other, -0.5)])?.vertex_values()?;
    let (one, two) = (spline.vertex_values()?, other.vertex_values()?);
    let pairs = one.iter().zip(&two);
    let expected: Vec<f64> = pairs.map(|(a, b)| 1.5 * a - 0.5 * b).collect();
    Ok(apart(&sum, &expected))
}

/// Returns the seconds per point of preparing, and the median ones of evaluating values and values
/// with gradients, at a point inside each face.
fn costs(spline: &BiharmonicSpline) -> Result<[(&'static str, f64); 3], RunError> {
    let faces = spline.space().domain().face_count();
    let inside = |face: u32| SurfacePoint {
        face,
        at: [0.2, 0.3, 0.5],
    };
    let points: Vec<SurfacePoint> = (0..faces as u32).map(inside).collect();
    let started = Instant::now();
    let with_gradients = spline.prepare(&points, Order::First)?;
    let preparing = started.elapsed().as_secs_f64();
    let values_only = spline.prepare(&points, Order::Value)?;
    let mut samples = Samples::default();
    let mut median = |evaluator: &dyn Evaluator| {
        let mut seconds: Vec<f64> = (0..TIMINGS)
            .map(|_| {
                let started = Instant::now();
                evaluator.evaluate(&mut samples);
                started.elapsed().as_secs_f64()
            })
            .collect();
        seconds.sort_by(f64::total_cmp);
        seconds[TIMINGS / 2] / faces as f64
    };
    Ok([
        ("prepare_seconds_per_point", preparing / faces as f64),
        ("value_seconds_per_point", median(values_only.as_ref())),
        (
            "gradient_seconds_per_point",
            median(with_gradients.as_ref()),
        ),
    ])
}

/// Returns what Figure 1 of the paper shows: the cells of the knots, a Green's function, a basis
/// function, control points that are numbers, and their spline.
fn fields(
    spline: &BiharmonicSpline,
    basis: &ExplicitBasis,
) -> Result<Vec<VertexAttribute>, RunError> {
    let space = spline.space();
    let count = spline.knots().len();
    let shown = count / 3;
    // Coefficients sum to zero: the share of the shown knot goes evenly to all.
    let mut coefficients = vec![-1.0 / count as f64; count];
    coefficients[shown] += 1.0;
    let form = Form::Implicit {
        coefficients,
        constant: vec![0.0],
    };
    let green = BiharmonicSpline::from_parts(space, 1, spline.knots().to_vec(), form)?;
    // A sequence of low discrepancy: numbers in [0, 1] without a pattern.
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let control_points: Vec<f64> = (0..count).map(|j| (golden * j as f64).fract()).collect();
    let function = basis.spline(&control_points, 1)?;
    let cells = basis.cells();
    let control = cells.iter().map(|&cell| control_points[cell as usize]);
    let columns = [
        ("cell", cells.iter().map(|&cell| f64::from(cell)).collect()),
        ("green", green.vertex_values()?),
        ("basis", basis.function(shown)?),
        ("control", control.collect()),
        ("spline", function.vertex_values()?),
    ];
    let vertices = space.domain().vertex_count();
    let field = |(name, mut values): (&str, Vec<f64>)| {
        values.truncate(vertices);
        VertexAttribute {
            name: name.to_owned(),
            values,
        }
    };
    Ok(columns.map(field).to_vec())
}
