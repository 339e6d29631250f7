//! Splitting data into layers of splines, and putting it together again.

use std::sync::Arc;

use msplines_biharmonic::{self as biharmonic, Layer, Options, Space, combine};
use msplines_common::evaluate::VertexData;
use msplines_common::progress::Observer;
use serde_json::json;

use super::{Produced, enter};
use crate::case::{Amount, Case};
use crate::clock::PhaseClock;
use crate::error::RunError;
use crate::fit::{Fitted, PHASES, biharmonic_method, biharmonic_options, count, following};
use crate::input::{FitData, LoadedInput};
use crate::record::Checks;
use crate::spline_file::{StoredBiharmonic, StoredSpline};

/// Decomposes data and sums up the parts with their factors. The stored spline is the sum of the
/// layers with theirs; what is compared with the data is the plain sum of all layers.
///
/// # Errors
/// A layer that cannot be fitted, or not one factor for each part.
pub(super) fn decompose(
    case: &Case,
    input: &LoadedInput,
    data: &FitData,
    (layers, factors): (&[Amount], &[f64]),
    clock: &mut PhaseClock,
    observer: &mut Observer<'_>,
) -> Result<Produced, RunError> {
    let method = biharmonic_method(case, "decompose")?;
    let (options, weights) = biharmonic_options(method, case.seed, &input.mesh)?;
    let layer = |&amount: &Amount| -> Result<Layer<'_>, RunError> {
        let count = count(amount, "--layers", &input.mesh)?;
        Ok(Layer {
            knots: biharmonic::KnotChoice::Optimised { count },
            weights: weights.as_deref(),
        })
    };
    let layers: Vec<Layer<'_>> = layers.iter().map(layer).collect::<Result<_, _>>()?;
    let mesh = Arc::new(input.mesh.clone());
    let creases = options.creases.on(&mesh)?;
    let space = Arc::new(Space::with_creases(mesh, options.laplacian, creases)?);
    let values = VertexData {
        dimension: data.dimension,
        values: &data.values,
    };
    let mut follow = following(&PHASES, clock, observer);
    let parts = biharmonic::decompose(&space, values, &layers, &options, &mut follow)?;
    drop(follow);
    enter("evaluate", clock, observer);
    let result = parts.recombine(factors)?;
    let mut ones = vec![1.0; factors.len()];
    ones[factors.len() - 1] = 0.0;
    let splines = parts.layers.iter().map(|fit| &fit.spline);
    let terms: Vec<_> = splines.zip(factors.iter().copied()).collect();
    let sum = combine(&terms)?;
    let warnings = parts
        .layers
        .iter()
        .flat_map(|fit| fit.report.warnings.clone());
    let count = sum.knots().len();
    let fitted = Fitted {
        stored: StoredSpline::Biharmonic(StoredBiharmonic::of(&sum)),
        space: Some(Arc::clone(sum.space())),
        options: json!(Options {
            knots: biharmonic::KnotChoice::Optimised { count },
            ..options
        }),
        outcome: parts.outcome(),
        checks: checks(&parts, data),
        warnings: warnings.collect(),
    };
    Ok(Produced {
        fitted,
        mesh: input.mesh.clone(),
        values: result,
        compared: parts.recombine(&ones)?,
        fields: Vec::new(),
    })
}

/// Returns the knots of each layer and the root mean square of what is left after it, over the scale
/// of the data, and how exactly all parts add up to the data.
fn checks(parts: &biharmonic::Decomposition, data: &FitData) -> Checks {
    let mut checks = Checks::new();
    let vertices = data.values.len() / data.dimension;
    let mut left = data.values.clone();
    let layers = parts.layers.iter().zip(&parts.layer_values).enumerate();
    for (index, (fit, values)) in layers {
        left.iter_mut().zip(values).for_each(|(r, f)| *r -= f);
        let squares: f64 = left.iter().map(|x| x * x).sum();
        let rms = (squares / vertices as f64).sqrt() / data.scale;
        let knots = fit.spline.knots().len();
        checks.insert(format!("layer_{}_knots", index + 1), json!(knots));
        checks.insert(format!("layer_{}_left_rms", index + 1), json!(rms));
    }
    let apart = left.iter().zip(&parts.residual).map(|(a, b)| (a - b).abs());
    let largest = apart.fold(0.0, f64::max) / data.scale;
    checks.insert("sum_error".to_owned(), json!(largest));
    checks
}
