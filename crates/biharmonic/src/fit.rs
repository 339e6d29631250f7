//! Fitting: knots chosen or given, then the least-squares spline with these knots.

use std::sync::Arc;

use msplines_common::evaluate::VertexData;
use msplines_common::linalg::Mat;
use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::{Observer, Outcome, Progress};
use serde::{Deserialize, Serialize};

use crate::knot_values::KnotValues;
use crate::select::{Selected, probe_scale, select};
use crate::{BiharmonicSpline, FitError, KnotChoice, Options, Space};

/// Share by which the squared error of the final fit may exceed its minimum. The mean error is exact
/// to five digits far earlier; this makes the spline itself the same to 1e-4 of that error.
const FIT_EXCESS: f64 = 1e-8;

/// Iterations allowed to the final fit. Well-spread knots take 15; clustered ones hundreds.
const FIT_ITERATIONS: u32 = 400;

/// A spline and how it came about.
#[derive(Debug)]
pub struct Fit {
    /// The spline.
    pub spline: BiharmonicSpline,
    /// How the fit went.
    pub report: Report,
}

/// How a fit went.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// How it ended.
    pub outcome: Outcome,
    /// Iterations of conjugate gradients of the final fit.
    pub iterations: u32,
    /// Relative residual of its normal equations.
    pub residual: f64,
    /// Rounds of elimination.
    pub eliminations: u32,
    /// Rounds of exchange, and how many of them were kept.
    pub exchanges: [u32; 2],
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Fits a spline to data at the vertices.
///
/// Any number of components is fitted at once with common knots. The cost is that of a few dozen
/// sparse factorisations and solves: about 10 CPU seconds for 100,000 vertices.
///
/// The observer sees the phases `domain`, `select` and `fit`. When it breaks, the knots found until
/// then are fitted, and the outcome is [`Outcome::Stopped`].
///
/// # Reference
/// [Hou2017] Alg. 2, Eq. (11). Deviation: knots by backward elimination and exchange.
///
/// # Errors
/// Knots or data that do not fit the mesh, or a mesh that is not connected or degenerate.
pub fn fit(
    mesh: &TriangleMesh,
    data: VertexData<'_>,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Fit, FitError> {
    let given = checked_knots(mesh.vertex_count(), &options.knots)?;
    let (centred, mean) = checked_data(mesh, data)?;
    let mut stopped = observer(&Progress::new("domain", 0, 1)).is_break();
    let space = Space::build(Arc::new(mesh.clone()), options.laplacian)?;
    if matches!(&given, Given::Knots(knots) if knots.len() == mesh.vertex_count()) {
        let knots = (0..mesh.vertex_count() as u32).collect();
        let coefficients = space.coefficients(&centred);
        let spline = finish(space, knots, &coefficients, &centred, &mean);
        return Ok(Fit {
            spline,
            report: Report::direct(),
        });
    }
    space.bilaplacian()?;
    stopped |= observer(&Progress::new("domain", 1, 1)).is_break();
    let selected = match given {
        Given::Knots(knots) => Selected::given(knots, stopped),
        Given::Count(count) => select(&space, &centred, count, options, stopped, observer)?,
    };
    let Selected {
        knots,
        fitted,
        outcome,
        eliminations,
        exchanges,
    } = selected;
    let system = KnotValues::factor(&space, knots)?;
    let _ = observer(&Progress::new("fit", 0, 1));
    let scale = probe_scale(&system, options.seed);
    let start = fitted.as_ref().unwrap_or(&centred);
    let (f, report) = system.least_squares(&centred, start, &scale, FIT_EXCESS, FIT_ITERATIONS);
    let coefficients = system.coefficients(&f);
    let _ = observer(&Progress::new("fit", 1, 1));
    let mut warnings = Vec::new();
    if !report.converged {
        warnings.push(format!(
            "the fit stopped at a relative residual of {:.1e} after {} iterations; the knots are badly clustered",
            report.residual, report.iterations
        ));
    }
    let outcome = match (outcome, report.converged) {
        (Outcome::Stopped, _) => Outcome::Stopped,
        (_, false) => Outcome::MaxIterations,
        (other, true) => other,
    };
    let knots = system.knots().to_vec();
    drop(system);
    Ok(Fit {
        spline: finish(space, knots, &coefficients, &f, &mean),
        report: Report {
            outcome,
            iterations: report.iterations,
            residual: report.residual,
            eliminations,
            exchanges,
            warnings,
        },
    })
}

impl Report {
    fn direct() -> Self {
        Self {
            outcome: Outcome::Converged,
            iterations: 0,
            residual: 0.0,
            eliminations: 0,
            exchanges: [0, 0],
            warnings: Vec::new(),
        }
    }
}

enum Given {
    Knots(Vec<u32>),
    Count(usize),
}

fn checked_knots(vertices: usize, choice: &KnotChoice) -> Result<Given, FitError> {
    let checked_count = |knots: usize| {
        if knots == 0 || knots > vertices {
            return Err(FitError::KnotCount { knots, vertices });
        }
        Ok(())
    };
    match choice {
        KnotChoice::All => Ok(Given::Knots((0..vertices as u32).collect())),
        KnotChoice::Optimised { count } => {
            checked_count(*count)?;
            if *count == vertices {
                return Ok(Given::Knots((0..vertices as u32).collect()));
            }
            Ok(Given::Count(*count))
        }
        KnotChoice::Given(knots) => {
            checked_count(knots.len())?;
            for (index, &vertex) in knots.iter().enumerate() {
                if vertex as usize >= vertices {
                    return Err(FitError::NoSuchKnot {
                        index,
                        vertex,
                        vertices,
                    });
                }
            }
            let mut sorted = knots.clone();
            sorted.sort_unstable();
            if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
                return Err(FitError::RepeatedKnot { vertex: pair[0] });
            }
            Ok(Given::Knots(sorted))
        }
    }
}

/// Returns the data less its mean, as a matrix, and the mean.
///
/// Constants belong to every spline space, so the mean is set aside: data far from the origin keeps
/// its digits.
pub(crate) fn checked_data(
    mesh: &TriangleMesh,
    data: VertexData<'_>,
) -> Result<(Mat<f64>, Vec<f64>), FitError> {
    let (vertices, dimension) = (mesh.vertex_count(), data.dimension);
    if dimension == 0 || data.values.len() != vertices * dimension {
        return Err(FitError::DataLength {
            values: data.values.len(),
            vertices,
            dimension,
        });
    }
    if let Some(at) = data.values.iter().position(|value| !value.is_finite()) {
        let (vertex, component) = (at / dimension, at % dimension);
        return Err(FitError::DataNotFinite {
            vertex,
            component,
            value: data.values[at],
        });
    }
    let mean: Vec<f64> = (0..dimension)
        .map(|c| {
            // Two passes: the first mean may have lost digits far from the origin.
            let values = || data.values.iter().skip(c).step_by(dimension);
            let rough = values().sum::<f64>() / vertices as f64;
            rough + values().map(|value| value - rough).sum::<f64>() / vertices as f64
        })
        .collect();
    let centred = Mat::from_fn(vertices, dimension, |v, c| {
        data.values[v * dimension + c] - mean[c]
    });
    Ok((centred, mean))
}

/// Returns the spline of these coefficients, corrected to zero sum, and the mean of `f` and data.
pub(crate) fn finish(
    space: Space,
    knots: Vec<u32>,
    coefficients: &Mat<f64>,
    f: &Mat<f64>,
    data_mean: &[f64],
) -> BiharmonicSpline {
    let dimension = f.ncols();
    let mut constant = Vec::with_capacity(dimension);
    let mut stored = vec![0.0; knots.len() * dimension];
    for (c, data_mean) in data_mean.iter().enumerate() {
        let sum: f64 = (0..knots.len()).map(|k| coefficients[(k, c)]).sum();
        let shift = sum / knots.len() as f64;
        for k in 0..knots.len() {
            stored[k * dimension + c] = coefficients[(k, c)] - shift;
        }
        let mean = (0..f.nrows()).map(|v| f[(v, c)]).sum::<f64>() / f.nrows() as f64;
        constant.push(data_mean + mean);
    }
    BiharmonicSpline::new(space, dimension, knots, stored, constant)
}
