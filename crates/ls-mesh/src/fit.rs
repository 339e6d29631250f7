//! The fit: select controls, then solve for all of them.

use std::ops::ControlFlow;

use msplines_common::evaluate::VertexData;
use msplines_common::linalg::Mat;
use msplines_common::mesh::TriangleMesh;
use msplines_common::progress::{Observer, Outcome, Progress};

use crate::error::{FitError, check_data, check_options};
use crate::frame::{Frame, component_means};
use crate::options::{Constraints, ControlChoice, Options, Selection};
use crate::select::{component_maxima, local_maxima};
use crate::space::Space;
use crate::spline::LsMesh;
use crate::system::System;

/// By how much a solve during the selection reduces its error at the newer controls: the maxima of
/// the error are then where they would be to within the spread between near ties.
const SELECTION_TOLERANCE: f64 = 0.2;

/// Largest change by the last refinement step, relative to the extent of the data, that counts as
/// an exact solve.
const RESIDUAL_TOLERANCE: f64 = 1e-6;

/// A least-squares mesh and how it was found.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The surface.
    pub spline: LsMesh,
    /// How the fit went.
    pub report: Report,
}

/// How a fit went.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Report {
    /// `Converged`, or `Stopped` with the controls selected until then.
    pub outcome: Outcome,
    /// Number of solves, the final one included.
    pub iterations: u32,
    /// Largest change by the last refinement step, relative to the extent of the data.
    pub residual: f64,
    /// What the result should be read with.
    pub warnings: Vec<String>,
}

/// Returns the least-squares mesh of vertex data on the connectivity of `mesh`.
///
/// `data` has one row per vertex: positions, colours, anything. The positions of `mesh` are not
/// used. `observer` sees the phases `select`, in controls, with the mean distance from the data as
/// objective, and `fit`; a break ends the selection with the controls found so far.
///
/// # Reference
/// [Sorkine2004]; [Hou2017] Eq. (14), Eq. (15), §8.1. Deviation: between factorisations the solves
/// of the selection are iterative; the final one is not.
///
/// # Errors
/// Options or data that do not fit the mesh, or a system that is singular to rounding.
pub fn fit(
    mesh: &TriangleMesh,
    data: VertexData<'_>,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Fit, FitError> {
    check_data(mesh.vertex_count(), data)?;
    check_options(mesh.topology(), options)?;
    fit_checked(&Space::assemble(mesh)?, data, options, observer)
}

/// Returns the least-squares mesh of vertex data in a space that is there already.
///
/// As [`fit`], but what the connectivity alone decides is shared with all other fits in this space.
///
/// # Reference
/// [Sorkine2004]; [Hou2017] Eq. (14), Eq. (15), §8.1. Deviation: as for [`fit`].
///
/// # Errors
/// As [`fit`].
pub fn fit_in(
    space: &Space,
    data: VertexData<'_>,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Fit, FitError> {
    check_data(space.size(), data)?;
    check_options(space.mesh().topology(), options)?;
    fit_checked(space, data, options, observer)
}

fn fit_checked(
    space: &Space,
    data: VertexData<'_>,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<Fit, FitError> {
    let (controls, mut report) = match &options.controls {
        ControlChoice::Given(controls) => (controls.clone(), Report::of(Outcome::Converged, 0)),
        ControlChoice::Selected { count } => select(space, data, *count, options, observer)?,
    };
    if observer(&Progress::new("fit", 0, 1)).is_break() {
        report.outcome = Outcome::Stopped;
    }
    let dimension = data.dimension;
    let rows = controls.iter().map(|&v| v as usize * dimension);
    let control_values: Vec<f64> = rows
        .flat_map(|start| data.values[start..start + dimension].iter().copied())
        .collect();
    let (values, residual) = solve_controls(
        space,
        options.constraints,
        dimension,
        &controls,
        &control_values,
    )?;
    report.finish(residual);
    let spline = LsMesh::from_solved(
        space.mesh().clone(),
        options.constraints,
        dimension,
        controls,
        control_values,
        values,
    );
    // The surface is complete: a break has nothing left to interrupt.
    let _ = observer(&Progress::new("fit", 1, 1));
    Ok(Fit { spline, report })
}

impl Report {
    fn of(outcome: Outcome, iterations: u32) -> Self {
        Self {
            outcome,
            iterations,
            residual: 0.0,
            warnings: Vec::new(),
        }
    }

    fn finish(&mut self, residual: f64) {
        self.iterations += 1;
        self.residual = residual;
        if residual > RESIDUAL_TOLERANCE {
            self.warnings.push(format!(
                "the system is nearly singular: values are known to {residual:.0e} of the extent \
                 of the data only; use more controls or a larger weight"
            ));
        }
    }
}

/// Returns `count` controls, or as many as the observer waited for, and the solves made.
fn select(
    space: &Space,
    data: VertexData<'_>,
    count: usize,
    options: &Options,
    observer: &mut Observer<'_>,
) -> Result<(Vec<u32>, Report), FitError> {
    let frame = Frame::measure(data)?;
    let (labels, components) = space.mesh().topology().components();
    let values = frame.normalise(data);
    let start = component_means(values.as_ref(), &labels, components);
    let mut system = System::new(space, options.constraints, values, start);
    let solves = match options.selection {
        Selection::Greedy => count,
        Selection::Combined { solves } => solves,
    };
    let mut errors = system.squared_errors();
    system.add(&component_maxima(&labels, components, &errors));
    let mut made = 0;
    loop {
        let due = (count * (made as usize + 1)).div_ceil(solves).min(count);
        let missing = due.saturating_sub(system.controls().len());
        // The first controls of each component are there before the first solve.
        let room = count - system.controls().len();
        let batch = if made == 0 { missing } else { missing.max(1) }.min(room);
        let chosen = local_maxima(&system, &errors, batch);
        system.add(&chosen);
        if system.controls().len() == count {
            return Ok((
                system.controls().to_vec(),
                Report::of(Outcome::Converged, made),
            ));
        }
        system.improve(SELECTION_TOLERANCE)?;
        made += 1;
        errors = system.squared_errors();
        let mean_square = errors.iter().sum::<f64>() / errors.len() as f64;
        let progress = Progress::new("select", system.controls().len() as u64, count as u64)
            .with_objective(mean_square.sqrt() * frame.scale());
        if let ControlFlow::Break(()) = observer(&progress) {
            return Ok((
                system.controls().to_vec(),
                Report::of(Outcome::Stopped, made),
            ));
        }
    }
}

/// Returns the values at all vertices, and the largest change of the last refinement step.
pub(crate) fn solve_controls(
    space: &Space,
    constraints: Constraints,
    dimension: usize,
    controls: &[u32],
    control_values: &[f64],
) -> Result<(Vec<f64>, f64), FitError> {
    let data = VertexData {
        dimension,
        values: control_values,
    };
    let frame = Frame::measure(data)?;
    let rows = frame.normalise(data);
    let n = space.size();
    let mut scattered = Mat::zeros(n, dimension);
    for (row, &control) in controls.iter().enumerate() {
        for side in 0..dimension {
            scattered[(control as usize, side)] = rows[(row, side)];
        }
    }
    let start = Mat::zeros(n, dimension);
    let mut system = System::new(space, constraints, scattered, start);
    let mut sorted = controls.to_vec();
    sorted.sort_unstable();
    system.add(&sorted);
    let residual = system.solve()?;
    let mut values = frame.restore(system.solution());
    if constraints == Constraints::Hard {
        for (row, &control) in controls.iter().enumerate() {
            values[control as usize * dimension..][..dimension]
                .copy_from_slice(&control_values[row * dimension..][..dimension]);
        }
    }
    Ok((values, residual))
}
